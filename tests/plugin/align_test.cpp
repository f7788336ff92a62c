// Alignment by pairs in MeshLab: the filter, the matrices of layers with undo, and locked layers.
#include "pcm/align/pair_text.h"
#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/make_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/placement.h"
#include "plugin/scene/bookmarks.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/layer_visibility.h"
#include "plugin/scene/open_clouds.h"
#include "tests/plugin/filter_call.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

#include <cmath>

namespace pcm::host {
namespace {

const char* const align_name = "Align Point Clouds by Pairs";

MeshModel* add_layer(MeshDocument& document, const fs::path& tree)
{
    MeshModel* layer = document.addNewMesh(QString::fromStdString(tree.string()), "tree");
    show_tree(*layer, open_cloud(tree));
    document.setCurrentMesh(layer->id());
    return layer;
}

std::string log_of(MeshDocument& document)
{
    QStringList lines;
    document.Log.print(lines);
    return lines.join("\n").toStdString();
}

class AlignInMeshLab : public testing::Test {
protected:
    // A tree, and pairs that move it by `motion`.
    void SetUp() override
    {
        tree_ = tree_of(scene(folder_, "a.las", 5000, far_away));
        const auto cloud = PointCloud::open(tree_);
        const Box3d box = cloud->info().bounds();
        motion_ = Affine::rotation({0.3, -0.2, 1}, 0.4, box.centre());
        motion_.target = motion_.target + Vec3d{12, -7, 3};
        for (unsigned corner : {0u, 3u, 5u, 6u}) {
            Vec3d p;
            for (std::size_t a = 0; a < 3; ++a) p[a] = corner >> a & 1u ? box.max[a] : box.min[a];
            p = cloud->nearest(p, 1).points.front().position;
            pairs_.push_back({p, motion_(p), 1});
        }
    }
    const test::TemporaryFolder folder_;
    fs::path tree_;
    Affine motion_;
    std::vector<PointPair> pairs_;
};

TEST_F(AlignInMeshLab, TheFilterWritesAMovedTree)
{
    write_pairs({pairs_[0], pairs_[1]}, folder_ / "pairs.txt");
    QString typed;
    for (std::size_t i = 2; i < 4; ++i)
        typed += QString::fromStdString(exact(pairs_[i].moving) + " " + exact(pairs_[i].fixed) + "; ");
    FilterCall call(align_name);
    call.set("Tree", tree_).set("Pairs", StringValue(typed)).set("PairsFile", folder_ / "pairs.txt");
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("no output folder"), std::string::npos) << call.log();
    call.set("Output", folder_ / "moved.pct");
    ASSERT_TRUE(call.apply()) << call.log();
    EXPECT_NE(call.log().find("RMS of the residuals: "), std::string::npos) << call.log();
    EXPECT_NE(call.log().find("pair 4: residual "), std::string::npos) << call.log();
    ASSERT_EQ(models_of(call.document).size(), 1u);
    const auto moved = PointCloud::open(folder_ / "moved.pct");
    EXPECT_EQ(moved->info().points, 5000u);
    for (const PointPair& pair : pairs_) EXPECT_LT(moved->nearest(pair.fixed, 1).points.front().distance(), 1e-7);
}

TEST_F(AlignInMeshLab, TheFilterSetsTheLayersMatrix)
{
    write_pairs(pairs_, folder_ / "pairs.txt");
    FilterCall call(align_name);
    call.set("Tree", tree_).set("PairsFile", folder_ / "pairs.txt").set("SetMatrix", true);
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("the current layer does not show this tree"), std::string::npos) << call.log();
    MeshModel* const layer = add_layer(call.document, tree_);
    ASSERT_TRUE(call.apply()) << call.log();
    const TreeLayer tree = *Registry::instance().find(*layer);
    const auto placement = placement_of(*layer, tree);
    ASSERT_TRUE(placement);
    const double rounding = matrix_rounding(motion_, tree.origin, tree.cloud->info().bounds());
    EXPECT_GT(rounding, 0);
    EXPECT_LT(rounding, 1e-4);
    for (const PointPair& pair : pairs_) EXPECT_LT(length((*placement)(pair.moving) - pair.fixed), 2 * rounding + 1e-8);
    EXPECT_EQ(scene_of(call.document).part<LayerMatrices>().undo_words(layer_of(*layer)), "align by 4 pairs");
    scene_of(call.document).part<LayerMatrices>().undo(layer_of(*layer));
    EXPECT_EQ(layer_of(*layer).matrix(), identity_matrix);
}

TEST_F(AlignInMeshLab, IllPosedPairsAreRefusedInWords)
{
    FilterCall call(align_name);
    call.set("Tree", tree_).set("Output", folder_ / "moved.pct").set("Pairs", StringValue("1 2 3 4 5 6; 2 3 4 5 6 7"));
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("a motion needs three pairs of points, and there are 2"), std::string::npos)
        << call.log();
    call.set("Pairs", StringValue("1 2 3 4 5 6; 2 3 4 5 6"));
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("line 2: 6 or 7 numbers were expected"), std::string::npos) << call.log();
    write_pairs(pairs_, folder_ / "pairs.txt");
    call.set("Pairs", StringValue("")).set("PairsFile", folder_ / "pairs.txt").set("PickError", StringValue("1000"));
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("not more than they can be picked to"), std::string::npos) << call.log();
    EXPECT_FALSE(fs::exists(folder_ / "moved.pct"));
}

TEST_F(AlignInMeshLab, MatricesAreChangedWithUndoAndRedo)
{
    MetDocument document;
    MeshModel* const layer = add_layer(document, tree_);
    auto& matrices = scene_of(document).part<LayerMatrices>();
    int changes = 0;
    QObject::connect(&matrices, &LayerMatrices::changed, [&](int id) { changes += id == layer->id(); });
    LayerMatrix one = identity_matrix, two = one;
    one[0][3] = 1;
    two[1][3] = 2;
    EXPECT_EQ(matrices.undo_words(layer_of(*layer)), "");
    matrices.undo(layer_of(*layer));
    matrices.set(layer_of(*layer), one, "one");
    matrices.set(layer_of(*layer), two, "two");
    EXPECT_EQ(matrices.undo_words(layer_of(*layer)), "two");
    matrices.undo(layer_of(*layer));
    EXPECT_EQ(layer_of(*layer).matrix(), one);
    EXPECT_EQ(matrices.redo_words(layer_of(*layer)), "two");
    matrices.undo(layer_of(*layer));
    EXPECT_EQ(layer_of(*layer).matrix(), identity_matrix);
    matrices.redo(layer_of(*layer));
    matrices.redo(layer_of(*layer));
    matrices.redo(layer_of(*layer));
    EXPECT_EQ(layer_of(*layer).matrix(), two);
    matrices.undo(layer_of(*layer));
    matrices.set(layer_of(*layer), two, "again");  // the step that was taken back is gone
    EXPECT_EQ(matrices.redo_words(layer_of(*layer)), "");
    EXPECT_EQ(changes, 8);
    LayerMatrix bad = one;
    bad[2][2] = NAN;
    EXPECT_THROW(matrices.set(layer_of(*layer), bad, "bad"), Error);
    EXPECT_EQ(layer_of(*layer).matrix(), two);
}

TEST_F(AlignInMeshLab, AMatrixIsTheMapOfSourceCoordinates)
{
    const Vec3d origin{500000, 4800000, 100};
    const LayerMatrix matrix = matrix_of(motion_, origin);
    const Affine again = map_of(matrix, origin);
    for (const PointPair& pair : pairs_)
        EXPECT_LT(length(again(pair.moving) - pair.fixed),
                  matrix_rounding(motion_, origin, PointCloud::open(tree_)->info().bounds()) + 1e-8);
    EXPECT_EQ(matrix_rounding(Affine::translation({1, 2, 3}), origin, PointCloud::open(tree_)->info().bounds()), 0);
    EXPECT_EQ(matrix_rounding(motion_, origin, Box3d{}), 0);
}

TEST_F(AlignInMeshLab, ALockedLayerKeepsItsMatrixAndItsPoints)
{
    FilterCall call("Delete Points of Point Cloud Tree");
    MeshModel* const layer = add_layer(call.document, tree_);
    auto& matrices = scene_of(call.document).part<LayerMatrices>();
    LayerMatrix moved = identity_matrix;
    moved[0][3] = 5;
    matrices.set(layer_of(*layer), moved, "move");
    matrices.lock(layer_of(*layer), true);
    EXPECT_TRUE(matrices.is_locked(layer_of(*layer)));
    EXPECT_THROW(matrices.set(layer_of(*layer), identity_matrix, "no"), Error);
    EXPECT_THROW(matrices.undo(layer_of(*layer)), Error);
    EXPECT_FALSE(matrices.hold(layer_of(*layer)));
    layer->cm.Tr = Matrix44m::Identity();  // as MeshLab's tools do it
    EXPECT_TRUE(matrices.hold(layer_of(*layer)));
    EXPECT_EQ(layer_of(*layer).matrix(), moved);
    EXPECT_NE(log_of(call.document).find("is locked: its matrix is what it was"), std::string::npos);

    call.set("Tree", tree_).set("Where", StringValue("x > 0")).set("InPlace", true);
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("shows this tree and is locked"), std::string::npos) << call.log();
    EXPECT_EQ(PointCloud::open(tree_)->info().points, 5000u);
    FilterCall current("Delete Points of Point Cloud Tree");  // in another document: nothing is locked there
    EXPECT_NO_THROW(refuse_locked(scene_of(current.document), tree_));
    matrices.lock(layer_of(*layer), false);
    EXPECT_NO_THROW(matrices.undo(layer_of(*layer)));
    EXPECT_TRUE(call.apply()) << call.log();
}

TEST_F(AlignInMeshLab, OneMapAfterAnother)
{
    const Affine second = Affine::rotation({1, 0, 0}, 0.3, {10, 20, 30}, 2);
    const Affine both = after(second, motion_);
    for (const PointPair& pair : pairs_) EXPECT_LT(length(both(pair.moving) - second(pair.fixed)), 1e-7);
}

TEST_F(AlignInMeshLab, LayersShownAloneGiveTheOthersBack)
{
    MetDocument document;
    MeshModel* const one = document.addNewMesh("", "one");
    MeshModel* const two = document.addNewMesh("", "two");
    MeshModel* const three = document.addNewMesh("", "three");
    set_shown(*two, false);
    auto& solo = scene_of(document).part<SoloLayers>();
    solo.set(layer_of(*two), true);
    EXPECT_TRUE(is_shown(*two) && !is_shown(*one) && !is_shown(*three));
    solo.set(layer_of(*three), true);
    EXPECT_TRUE(is_shown(*two) && !is_shown(*one) && is_shown(*three));
    solo.set(layer_of(*two), false);
    EXPECT_TRUE(!is_shown(*two) && is_shown(*three) && solo.is_solo(layer_of(*three)));
    remove_model(document, *three);  // the last one: all others are as they were
    EXPECT_TRUE(is_shown(*one) && !is_shown(*two));
}

TEST_F(AlignInMeshLab, BookmarksHaveNamesOfTheirOwnAndAreReadBack)
{
    MetDocument document, other;
    auto& bookmarks = scene_of(document).part<Bookmarks>();
    CameraFrame frame;
    frame.eye = {500000.123456789, 4800000, 200};
    frame.target = {500000, 4800010, 100};
    frame.angle = 60;
    EXPECT_EQ(bookmarks.text(), "");
    EXPECT_EQ(bookmarks.add(frame, "gate"), "gate");
    EXPECT_EQ(bookmarks.add(frame, " gate "), "gate 2");
    EXPECT_EQ(bookmarks.add(frame, ""), "View");
    bookmarks.rename(1, "gate");
    EXPECT_EQ(bookmarks.all()[1].name, "gate 2");
    bookmarks.rename(1, "tower <&>");
    bookmarks.rename(7, "nothing");
    bookmarks.remove(2);
    bookmarks.remove(7);
    scene_of(other).part<Bookmarks>().add_text(bookmarks.text(), "text");
    ASSERT_EQ(scene_of(other).part<Bookmarks>().all().size(), 2u);
    EXPECT_EQ(scene_of(other).part<Bookmarks>().all()[0].eye, frame.eye);
    EXPECT_EQ(scene_of(other).part<Bookmarks>().all()[1].name, "tower <&>");
    EXPECT_THROW(scene_of(other).part<Bookmarks>().add_text("{}", "text"), Error);
    EXPECT_THROW(scene_of(other).part<Bookmarks>().add_text(
                     R"({"format": "pcm camera path", "version": 1, "coordinates": "box", "frames": [
                        {"eye": [0, 0, 1], "target": [0, 0, 0], "up": [0, 1, 0], "angle": 60}]})",
                     "text"),
                 Error);
    EXPECT_EQ(scene_of(other).part<Bookmarks>().all().size(), 2u);
    frame.up = frame.eye - frame.target;
    EXPECT_THROW(bookmarks.add(frame, "up"), Error);
}

}  // namespace
}  // namespace pcm::host
