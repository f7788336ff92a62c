// Locked layers and layers shown alone, through the text that projects keep.
#include "plugin/scene/layer_marks.h"
#include "plugin/meshlab/document_scene.h"

#include "pcm/system/error.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/layer_visibility.h"
#include "tests/plugin/met_document.h"

#include <gtest/gtest.h>

#include <QCoreApplication>
#include <QElapsedTimer>
#include <QThread>

#include <functional>

using namespace pcm;
using namespace pcm::host;

namespace {

// Files of a project, two of them of the same name.
const char* const files[] = {"/a/one.pct", "/a/same.pct", "/b/same.pct", "/a/hidden.pct"};

struct Opened {
    MetDocument document;
    Opened()
    {
        for (const char* file : files) document.addNewMesh(file, file);
        set_shown(*models_of(document)[3], false);
    }
    MeshModel& layer(int number) { return *models_of(document)[std::size_t(number)]; }
};

bool wait_until(const std::function<bool()>& holds)
{
    QElapsedTimer taken;
    taken.start();
    while (!holds() && taken.elapsed() < 5000) {
        QCoreApplication::processEvents();
        QThread::msleep(5);
    }
    return holds();
}

TEST(LayerMarks, AreKeptThroughTheirText)
{
    Opened before;
    EXPECT_TRUE(layer_marks(scene_of(before.document)).isEmpty());
    scene_of(before.document).part<LayerMatrices>().lock(layer_of(before.layer(2)), true);
    scene_of(before.document).part<SoloLayers>().set(layer_of(before.layer(0)), true);
    scene_of(before.document).part<SoloLayers>().set(layer_of(before.layer(2)), true);
    const QString text = layer_marks(scene_of(before.document));

    Opened after;  // as MeshLab opens it: what was hidden then is hidden
    for (const int number : {1, 3}) set_shown(after.layer(number), false);
    after.document.setBusy(true);
    take_layer_marks(scene_of(after.document), text);
    QCoreApplication::processEvents();
    EXPECT_FALSE(scene_of(after.document).part<LayerMatrices>().is_locked(layer_of(after.layer(2))))
        << "its matrix may not be there yet";
    after.layer(2).cm.Tr[0][3] = 7;
    after.document.setBusy(false);
    ASSERT_TRUE(
        wait_until([&] { return scene_of(after.document).part<LayerMatrices>().is_locked(layer_of(after.layer(2))); }));
    EXPECT_FALSE(scene_of(after.document).part<LayerMatrices>().hold(layer_of(after.layer(2))))
        << "locked with the matrix of the project";
    for (const int number : {0, 1, 2, 3}) {
        EXPECT_EQ(scene_of(after.document).part<LayerMatrices>().is_locked(layer_of(after.layer(number))), number == 2)
            << number;
        EXPECT_EQ(scene_of(after.document).part<SoloLayers>().is_solo(layer_of(after.layer(number))), number % 2 == 0)
            << number;
        EXPECT_EQ(is_shown(after.layer(number)), number % 2 == 0) << number;
    }
    EXPECT_EQ(layer_marks(scene_of(after.document)), text);
    for (const int number : {0, 2})
        scene_of(after.document).part<SoloLayers>().set(layer_of(after.layer(number)), false);
    for (const int number : {0, 1, 2, 3}) EXPECT_EQ(is_shown(after.layer(number)), number != 3) << number;
}

TEST(LayerMarks, LayersThatAreGoneAreLeftOut)
{
    Opened before;
    scene_of(before.document).part<LayerMatrices>().lock(layer_of(before.layer(2)), true);
    const QString text = layer_marks(scene_of(before.document));
    MetDocument after;
    MeshModel* const only = after.addNewMesh("/c/same.pct", "same");
    MeshModel* const second = after.addNewMesh("/d/same.pct", "same");
    take_layer_marks(scene_of(after), text);
    EXPECT_TRUE(wait_until([&] { return scene_of(after).part<LayerMatrices>().is_locked(layer_of(*second)); }));
    EXPECT_FALSE(scene_of(after).part<LayerMatrices>().is_locked(layer_of(*only)));
}

TEST(LayerMarks, OtherTextIsRefused)
{
    Opened opened;
    for (const char* text :
         {"", "[]", "{\"version\":2,\"layers\":[]}", "{\"version\":1}", "{\"version\":1,\"layers\":[{}]}"})
        EXPECT_THROW(take_layer_marks(scene_of(opened.document), text), Error) << text;
}

}  // namespace
