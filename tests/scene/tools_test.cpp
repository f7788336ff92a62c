// Tools on a scene and a view that are no MeshLab's: from their start to their end, by the events of the view.
#include "tests/scene/fake_scene.h"

#include "plugin/scene/annotations.h"
#include "plugin/scene/clip_history.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/proxy.h"
#include "plugin/tools/align/align_session.h"
#include "plugin/tools/all/tools.h"
#include "plugin/tools/clip/clip_tool.h"
#include "plugin/tools/pick/pick_tool.h"

#include <gtest/gtest.h>

#include <QCoreApplication>
#include <QElapsedTimer>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QVariantMap>

#include <algorithm>
#include <functional>

namespace pcm::host {
namespace {

class ToolInScene : public testing::Test {
protected:
    static void press(Tool& tool, int key, Qt::KeyboardModifiers modifiers = Qt::NoModifier)
    {
        QKeyEvent event(QEvent::KeyPress, key, modifiers);
        tool.keyPressEvent(&event);
    }
    static void click(Tool& tool, const QPointF& place)
    {
        QMouseEvent down(QEvent::MouseButtonPress, place, Qt::LeftButton, Qt::LeftButton, Qt::NoModifier);
        tool.mousePressEvent(&down);
        QMouseEvent up(QEvent::MouseButtonRelease, place, Qt::LeftButton, Qt::NoButton, Qt::NoModifier);
        tool.mouseReleaseEvent(&up);
    }
    static bool wait_until(const std::function<bool()>& done)
    {
        QElapsedTimer timer;
        for (timer.start(); !done() && timer.elapsed() < 20000;)
            QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
        return done();
    }
    std::optional<ClipBox> box() { return scene_.part<SceneState>().clip(); }

    const test::TemporaryFolder folder_;
    FakeScene scene_;
    FakeView view_{scene_};
};

TEST_F(ToolInScene, ToolsWithAPanelNeedACloud)
{
    ClipTool clip;
    EXPECT_FALSE(clip.start(view_));
    scene_.add("mesh");
    PickTool pick;
    EXPECT_FALSE(pick.start(view_));
    EXPECT_EQ(scene_.lines,
              (QStringList{"Clip Box: no layer shows a point cloud", "Pick Point: no layer shows a point cloud"}));
}

TEST_F(ToolInScene, EveryToolStartsAndEndsTwiceInAView)
{
    FakeLayer& city = scene_.add("city", make_tree(folder_, "city", 2000));
    view_.paint({city.id()});
    for (const ToolRow& row : tools()) {
        const auto tool = row.make();
        for (int time = 0; time < 2; ++time) {
            EXPECT_TRUE(tool->start(view_)) << row.name;
            tool->draw(nullptr);
            tool->end();
        }
    }
    EXPECT_TRUE(scene_.part<Annotations>().all().empty()) << "a tool that has ended draws nothing";
}

TEST_F(ToolInScene, TheClipToolTakesItsBoxFromTheViewAndTurnsIt)
{
    FakeLayer& city = scene_.add("city", make_tree(folder_, "city", 2000));
    view_.paint({city.id()});
    ClipTool tool;
    ASSERT_TRUE(tool.start(view_));
    ASSERT_TRUE(box());
    const Box3d bounds = city.cloud->cloud->info().bounds();
    for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_LE(box()->centre[a] - box()->half[a], bounds.min[a]);
        EXPECT_GE(box()->centre[a] + box()->half[a], bounds.max[a]);
    }
    EXPECT_EQ(scene_.part<Annotations>().all().count("clip"), 1u);
    const ClipBox upright = *box();
    press(tool, Qt::Key_R);
    EXPECT_FALSE(same(box(), upright));
    press(tool, Qt::Key_Z, Qt::ControlModifier);
    EXPECT_TRUE(same(box(), upright));
    press(tool, Qt::Key_Space);
    EXPECT_FALSE(box()->enabled);
    tool.end();
    EXPECT_EQ(scene_.part<Annotations>().all().count("clip"), 0u);
    EXPECT_TRUE(box()) << "the box stays";
}

TEST_F(ToolInScene, DragsAwayFromTheHandlesAreTheCameras)
{
    FakeLayer& city = scene_.add("city", make_tree(folder_, "city", 2000));
    view_.paint({city.id()});
    ClipTool tool;
    ASSERT_TRUE(tool.start(view_));
    const ClipBox before = *box();
    click(tool, {2, 2});
    EXPECT_EQ(view_.camera_events, 2);
    EXPECT_TRUE(same(box(), before));
    tool.end();
}

TEST_F(ToolInScene, AClickPicksTheVisiblePoint)
{
    FakeLayer& city = scene_.add("city", make_tree(folder_, "city", 20000));
    const Proxy sample = make_proxy(*city.cloud->cloud, far_away);
    const auto highest = std::max_element(sample.points.begin(), sample.points.end(),
                                          [](const auto& p, const auto& q) { return p.position[2] < q.position[2]; });
    const Vec3d top = far_away + Vec3d{highest->position[0], highest->position[1], highest->position[2]};
    view_.paint({city.id()}, top);
    PickTool tool;
    ASSERT_TRUE(tool.start(view_));
    const auto answer = [this] { return view_.widget().property("pcm_pick").toMap(); };
    const QPointF middle(400, 300);
    click(tool, middle);
    ASSERT_TRUE(wait_until([&] { return answer()["final"].toBool(); }));
    EXPECT_EQ(answer()["message"].toString(), QString());
    const QVariantMap point = answer()["point"].toMap();
    EXPECT_EQ(point["layer"].toString(), "city");
    EXPECT_NEAR(point["x"].toDouble(), top[0], 0.6);
    EXPECT_NEAR(point["y"].toDouble(), top[1], 0.6);
    // A face of another layer that is nearer hides it.
    view_.occluder = {1e-3, "roof"};
    click(tool, middle);
    EXPECT_TRUE(wait_until([&] { return answer()["message"].toString().contains("in front of the layer roof"); }));
    tool.end();
}

TEST_F(ToolInScene, TheAlignmentForgetsPairsOfALayerThatIsRemoved)
{
    FakeLayer& fixed = scene_.add("fixed", make_tree(folder_, "fixed", 2000));
    FakeLayer& moving = scene_.add("moving", make_tree(folder_, "moving", 2000));
    auto& session = scene_.part<AlignSession>();
    session.choose_first();
    EXPECT_EQ(session.moving(), &moving) << "the current layer";
    EXPECT_EQ(session.fixed(), &fixed);
    const Vec3d shift{3, 0, 0};
    for (const Vec3d& at : {Vec3d{0, 0, 0}, Vec3d{40, 0, 0}, Vec3d{0, 40, 0}}) {
        Picked picked;
        picked.layer_id = moving.id();
        picked.position = far_away + at;
        session.take(picked);
        picked.layer_id = fixed.id();
        picked.position = far_away + at + shift;
        session.take(picked);
    }
    ASSERT_TRUE(session.fit());
    session.apply();
    EXPECT_NEAR(moving.matrix()[0][3], 3, 1e-4);
    scene_.part<LayerMatrices>().undo(moving);
    EXPECT_EQ(moving.matrix(), identity_matrix);
    scene_.remove(moving.id());
    EXPECT_EQ(session.moving(), nullptr);
    EXPECT_FALSE(session.fit());
}

}  // namespace
}  // namespace pcm::host
