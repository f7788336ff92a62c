// What is kept about a scene: one object of each class, and all of them follow the layers.
#include "tests/scene/fake_scene.h"

#include "pcm/select/select_points.h"
#include "pcm/system/error.h"
#include "plugin/scene/annotations.h"
#include "plugin/scene/clip_history.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/layer_visibility.h"
#include "plugin/scene/look_at.h"
#include "plugin/scene/measure_book.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/result_layer.h"
#include "plugin/scene/scene_bounds.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/shown_points.h"

#include <gtest/gtest.h>

namespace pcm::host {
namespace {

class SceneWithClouds : public testing::Test {
protected:
    const test::TemporaryFolder folder_;
    FakeScene scene_;
    FakeView view_{scene_};
    FakeLayer& city_ = scene_.add("city", make_tree(folder_, "city", 3000));
    FakeLayer& mesh_ = scene_.add("mesh");
};

TEST_F(SceneWithClouds, HasOneObjectOfEachClass)
{
    FakeScene other;
    EXPECT_EQ(&scene_.part<SceneState>(), &scene_.part<SceneState>());
    EXPECT_NE(&scene_.part<SceneState>(), &other.part<SceneState>());
    EXPECT_NE(static_cast<QObject*>(&scene_.part<Annotations>()), &scene_.part<LayerMatrices>());
    EXPECT_EQ(scene_.part<MeasureBook>().parent(), &scene_) << "they end with the scene";
}

TEST_F(SceneWithClouds, SelectionsAreStepsOfTheirLayerAndEndWithIt)
{
    auto& state = scene_.part<SceneState>();
    const auto some = std::make_shared<const PointSet>(select_points(city_.cloud->cloud->tree(), {}, {}));
    ASSERT_GT(some->size(), 0u);
    const int before = view_.updates;
    state.select(city_, some, "all");
    EXPECT_EQ(state.selection(city_), some);
    EXPECT_EQ(state.selection(mesh_), nullptr);
    EXPECT_GT(view_.updates, before) << "views are to show it";
    state.undo(city_);
    EXPECT_EQ(state.selection(city_), nullptr);
    EXPECT_EQ(state.redo_words(city_), "all");
    state.redo(city_);
    EXPECT_EQ(state.selection(city_), some);
    const std::filesystem::path another = make_tree(folder_, "another", 2000);
    city_.cloud->cloud = PointCloud::open(another);
    EXPECT_EQ(state.selection(city_), nullptr) << "the layer shows another tree";
    scene_.remove(city_.id());
    EXPECT_TRUE(state.undo_words(mesh_).isNull());
}

TEST_F(SceneWithClouds, ALockedLayerKeepsItsMatrix)
{
    auto& matrices = scene_.part<LayerMatrices>();
    LayerMatrix moved = identity_matrix;
    moved[0][3] = 5;
    matrices.set(city_, moved, "move");
    EXPECT_TRUE(city_.modified);
    EXPECT_EQ((*city_.placement())(far_away), (far_away + Vec3d{5, 0, 0}));
    matrices.lock(city_, true);
    EXPECT_THROW(matrices.set(city_, identity_matrix, "no"), Error);
    city_.set_matrix(identity_matrix);  // as other tools do
    EXPECT_TRUE(matrices.hold(city_));
    EXPECT_EQ(city_.matrix(), moved);
    EXPECT_NE(scene_.lines.join('\n').indexOf("'city' is locked"), -1);
    EXPECT_THROW(refuse_locked(scene_, city_.cloud->cloud->tree()->folder()), Error);
    matrices.lock(city_, false);
    EXPECT_NO_THROW(refuse_locked(scene_, city_.cloud->cloud->tree()->folder()));
    matrices.undo(city_);
    EXPECT_EQ(city_.matrix(), identity_matrix);
}

TEST_F(SceneWithClouds, TheClipBoxLimitsWhatAViewShows)
{
    view_.paint({city_.id()});
    EXPECT_TRUE(shown_points(view_, city_).clips.empty());
    ClipBox box;
    box.centre = far_away;
    scene_.part<ClipHistory>().keep(box);
    EXPECT_EQ(shown_points(view_, city_).clips.size(), 1u);
    box.enabled = false;
    scene_.part<SceneState>().set_clip(box);  // as a filter does: a step too
    EXPECT_TRUE(shown_points(view_, city_).clips.empty());
    scene_.part<ClipHistory>().undo();
    EXPECT_TRUE(scene_.part<SceneState>().clip()->enabled);
    EXPECT_EQ(shown_layers(view_), std::vector<SceneLayer*>{&city_});
}

TEST_F(SceneWithClouds, LayersShownAloneGiveTheOthersBack)
{
    auto& solo = scene_.part<SoloLayers>();
    mesh_.visible = false;
    solo.set(city_, true);
    EXPECT_TRUE(city_.visible && !mesh_.visible);
    FakeLayer& third = scene_.add("third");
    solo.set(third, true);
    solo.set(city_, false);
    EXPECT_TRUE(third.visible && !city_.visible);
    scene_.remove(third.id());
    EXPECT_TRUE(city_.visible && !mesh_.visible);
}

TEST_F(SceneWithClouds, BoundsAreThoseOfShownCloudsAsTheyAreMoved)
{
    const Box3d box = city_.cloud->cloud->info().bounds();
    EXPECT_EQ(bounds_of_shown(view_).min, box.min);
    LayerMatrix moved = identity_matrix;
    moved[1][3] = 8;
    city_.set_matrix(moved);
    EXPECT_NEAR(bounds_of(city_).min[1], box.min[1] + 8, 1e-9);
    look_at(view_, bounds_of(city_), 0.5);
    EXPECT_NEAR(view_.looked_at.first[1], bounds_of(city_).centre()[1] - far_away[1], 1e-9);
    city_.visible = false;
    EXPECT_TRUE(bounds_of_shown(view_).empty());
}

TEST_F(SceneWithClouds, AResultTakesThePlaceOfWhatItWasMadeOf)
{
    LayerMatrix moved = identity_matrix;
    moved[2][3] = 3;
    city_.set_matrix(moved);
    const std::filesystem::path tree = city_.cloud->cloud->tree()->folder();
    const std::filesystem::path result = make_tree(folder_, "result", 1000);
    show_result(scene_, result, tree);
    SceneLayer* const added = scene_.current();
    EXPECT_EQ(added->label(), "result");
    EXPECT_EQ(added->matrix(), moved);
    EXPECT_FALSE(city_.visible);
    EXPECT_EQ(show_result(scene_, tree, tree), std::vector<std::string>{"reloaded"});
    EXPECT_EQ(scene_.reloaded, std::vector<std::filesystem::path>{tree});
}

TEST_F(SceneWithClouds, PrimitivesAreDrawnWhereTheirLayerIs)
{
    auto& book = scene_.part<PrimitiveBook>();
    Primitive pipe;
    pipe.fit.shape.kind = ShapeKind::sphere;
    pipe.fit.shape.point = far_away;
    pipe.fit.shape.radius = 2;
    pipe.cloud = cloud_name(city_);
    EXPECT_EQ(book.layer_of(pipe), &city_);
    EXPECT_FALSE(book.placement_of(pipe));
    LayerMatrix moved = identity_matrix;
    moved[0][3] = 4;
    scene_.part<LayerMatrices>().set(city_, moved, "move");
    EXPECT_TRUE(book.placement_of(pipe));
    scene_.remove(city_.id());
    EXPECT_EQ(book.layer_of(pipe), nullptr);
}

}  // namespace
}  // namespace pcm::host
