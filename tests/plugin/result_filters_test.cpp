// The filters that make another cloud of trees: voxel grid, subsample, merge, transform.
#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/system/text.h"
#include "pcm/tree/tree_reader.h"
#include "plugin/filter/proposed_output.h"
#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/placement.h"
#include "plugin/scene/free_path.h"
#include "plugin/scene/open_clouds.h"
#include "tests/memory_reader.h"
#include "tests/plugin/filter_call.h"
#include "tests/plugin/scenes.h"

#include <cmath>

namespace pcm::host {
namespace {

const char* const voxel_name = "Voxel Grid of Point Cloud Tree";
const char* const subsample_name = "Subsample Point Cloud Tree";
const char* const merge_name = "Merge Point Cloud Trees";
const char* const transform_name = "Transform Point Cloud Tree";

std::uint64_t points_in(const fs::path& tree) { return Tree::open(tree)->info().points; }

MeshModel* add_layer(MeshDocument& document, const fs::path& tree)
{
    MeshModel* layer = document.addNewMesh(QString::fromStdString(tree.string()), "tree");
    show_tree(*layer, open_cloud(tree));
    return layer;
}

Matrix44m turned(float degrees, float x, float y, float z)
{
    Matrix44m turn, shift;
    turn.SetRotateDeg(degrees, Point3m(0, 0, 1));
    shift.SetTranslate(x, y, z);
    return shift * turn;
}

// Where a layer shows its points, in MeshLab's coordinates.
std::vector<Point3m> shown(const MeshModel& layer)
{
    std::vector<Point3m> points;
    for (const auto& vertex : layer.cm.vert) points.push_back(layer.cm.Tr * vertex.cP());
    std::sort(points.begin(), points.end());
    return points;
}

class ResultFilters : public testing::Test {
protected:
    fs::path scene_tree(const std::string& name, std::uint64_t points = 5000)
    {
        return tree_of(scene(folder_, name, points, far_away));
    }
    const test::TemporaryFolder folder_;
};

TEST_F(ResultFilters, VoxelGridIntoANewTreeAndInPlace)
{
    const fs::path tree = scene_tree("a.las"), grid = folder_ / "grid.pct";
    FilterCall without(voxel_name);
    EXPECT_FALSE(without.set("Tree", tree).apply());
    EXPECT_NE(without.log().find("no output is given"), std::string::npos) << without.log();

    FilterCall call(voxel_name);
    call.set("Tree", tree).set("VoxelSize", FloatValue(0.7f)).set("Count", true).set("Output", folder_ / "grid");
    ASSERT_TRUE(call.apply()) << call.log();
    EXPECT_EQ(models_of(call.document).size(), 1u);
    EXPECT_LT(points_in(grid), 5000u);
    EXPECT_TRUE(Tree::open(grid)->info().schema.find("point_count"));
    for (const std::string& word : {"points of 5,000, one for each voxel of 0.7", "at most", "peak memory"})
        EXPECT_NE(call.log().find(word), std::string::npos) << word << " is not in\n" << call.log();

    FilterCall again(voxel_name);
    again.set("Tree", tree).set("VoxelSize", FloatValue(0.7f)).set("Output", grid);
    EXPECT_FALSE(again.apply());
    ASSERT_TRUE(again.set("Overwrite", true).set("Anchor", fs::path("0.3 0 0")).apply()) << again.log();

    FilterCall in_place(voxel_name);
    MeshModel* const layer = add_layer(in_place.document, tree);
    layer->cm.Tr = turned(30, 1, 2, 3);
    in_place.document.setCurrentMesh(layer->id());
    in_place.set("VoxelSize", FloatValue(0.7f)).set("InPlace", true).choose("Point", 1);
    ASSERT_TRUE(in_place.apply()) << in_place.log();
    EXPECT_EQ(points_in(tree), Registry::instance().find(*layer)->cloud->info().points);
    EXPECT_LT(points_in(tree), 5000u);
    EXPECT_EQ(layer->cm.Tr, turned(30, 1, 2, 3));

    FilterCall bad(voxel_name);
    EXPECT_FALSE(bad.set("Tree", tree).set("VoxelSize", FloatValue(0)).set("Output", folder_ / "b").apply());
    EXPECT_NE(bad.log().find("positive"), std::string::npos) << bad.log();
    FilterCall words(voxel_name);
    EXPECT_FALSE(words.set("Tree", tree).set("Anchor", fs::path("1 two 3")).set("Output", folder_ / "b").apply());
    EXPECT_NE(words.log().find("'two' is not a number"), std::string::npos) << words.log();
    FilterCall names(voxel_name);
    EXPECT_FALSE(names.set("Tree", tree).set("Majority", fs::path("colour")).set("Output", folder_ / "b").apply());
    EXPECT_NE(names.log().find("no attribute 'colour'"), std::string::npos) << names.log();
}

TEST_F(ResultFilters, SubsampleToALevelASpacingAndANumber)
{
    const fs::path tree = scene_tree("a.las");
    const auto levels = Tree::open(tree)->level_summaries();
    FilterCall level(subsample_name);
    level.set("Tree", tree)
        .set("Output", folder_ / "level.pct")
        .set("Spacing", FloatValue(float(levels[0].spacing)))
        .set("Exact", false);
    ASSERT_TRUE(level.apply()) << level.log();
    EXPECT_EQ(points_in(folder_ / "level.pct"), levels[0].points_to_here);
    EXPECT_NE(level.log().find("(level 0, spacing " + brief(levels[0].spacing)), std::string::npos) << level.log();
    EXPECT_EQ(models_of(level.document).size(), 1u);

    FilterCall spacing(subsample_name);
    spacing.set("Tree", tree)
        .set("Output", folder_ / "spacing.pct")
        .set("Spacing", FloatValue(0.9f));  // exactly, by default
    ASSERT_TRUE(spacing.apply()) << spacing.log();
    EXPECT_NE(spacing.log().find("spacing 0.9, exactly"), std::string::npos) << spacing.log();

    FilterCall number(subsample_name);
    number.set("Tree", tree).set("InPlace", true).choose("By", 1).set("Points", 1234).set("Exact", true);
    ASSERT_TRUE(number.apply()) << number.log();
    EXPECT_EQ(points_in(tree), 1234u);
}

// What a layer's matrix shows is what the new tree has, to the rounding of the matrix.
TEST_F(ResultFilters, TransformTakesTheLayersMatrix)
{
    const fs::path tree = scene_tree("a.las"), moved = folder_ / "moved.pct";
    FilterCall call(transform_name);
    MeshModel* const layer = add_layer(call.document, tree);
    layer->cm.Tr = turned(30, 7, -2, 0.5f);
    call.document.setCurrentMesh(layer->id());
    const auto placement = placement_of(*layer, *Registry::instance().find(*layer));
    ASSERT_TRUE(placement);
    ASSERT_TRUE(call.set("Output", moved).apply()) << call.log();
    EXPECT_EQ(points_in(moved), 5000u);
    ASSERT_EQ(models_of(call.document).size(), 2u);
    MeshModel* const made = models_of(call.document).back();
    EXPECT_EQ(made->cm.Tr, Matrix44m::Identity());
    EXPECT_FALSE(placement_of(*made, *Registry::instance().find(*made)));
    EXPECT_TRUE(is_shown(*made) && !is_shown(*layer));
    // Both layers are samples of all of these points.
    const auto before = shown(*layer), after = shown(*made);
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i) ASSERT_LT((before[i] - after[i]).Norm(), 1e-4) << i;

    FilterCall nothing(transform_name);
    EXPECT_FALSE(nothing.set("Tree", tree).set("Output", folder_ / "b.pct").apply());
    EXPECT_NE(nothing.log().find("no transformation was given"), std::string::npos) << nothing.log();
    EXPECT_FALSE(fs::exists(folder_ / "b.pct"));
}

// A result with the cloud's own coordinates is shown where the cloud was, and alone; one without points hides nothing.
TEST_F(ResultFilters, AResultTakesThePlaceOfItsCloud)
{
    const fs::path tree = scene_tree("a.las"), other = scene_tree("b.las");
    FilterCall call("Delete Points of Point Cloud Tree");
    MeshModel* const first = add_layer(call.document, tree);
    MeshModel* const layer = add_layer(call.document, tree);  // the same cloud, elsewhere
    MeshModel* const unrelated = add_layer(call.document, other);
    layer->cm.Tr = turned(30, 7, -2, 0.5f);
    call.document.setCurrentMesh(layer->id());
    ASSERT_TRUE(call.set("Where", fs::path("intensity < 0")).set("Output", folder_ / "same.pct").apply()) << call.log();
    MeshModel* const made = call.document.mm();
    ASSERT_EQ(made, models_of(call.document).back());
    EXPECT_EQ(made->cm.Tr, layer->cm.Tr);
    EXPECT_TRUE(is_shown(*made) && !is_shown(*layer));
    EXPECT_TRUE(is_shown(*first) && is_shown(*unrelated)) << "which were not replaced";
    EXPECT_NE(call.log().find("is shown in its place"), std::string::npos) << call.log();

    ASSERT_TRUE(call.set("Where", fs::path("intensity >= 0")).set("Output", folder_ / "none.pct").apply())
        << call.log();
    EXPECT_EQ(call.document.mm(), made);
    EXPECT_TRUE(is_shown(*made));
    EXPECT_NE(call.log().find("has no points, so no layer shows it"), std::string::npos) << call.log();

    // A tree that is named, and not the current layer's.
    call.set("Tree", other).set("Where", fs::path("intensity < 0")).set("Output", folder_ / "other.pct");
    ASSERT_TRUE(call.apply()) << call.log();
    EXPECT_FALSE(is_shown(*unrelated));
    EXPECT_TRUE(is_shown(*made));
}

TEST_F(ResultFilters, NamesOfResultsAreFree)
{
    const fs::path tree = scene_tree("a.las");
    EXPECT_EQ(free_path(tree, "-clean.pct"), folder_ / "a-clean.pct");
    fs::create_directory(folder_ / "a-clean.pct");
    fs::create_symlink("nowhere", folder_ / "a-clean-2.pct");  // such a name is taken too
    EXPECT_EQ(free_path(tree, "-clean.pct"), folder_ / "a-clean-3.pct");
    EXPECT_EQ(free_path(folder_ / "a-clean.pct", "-clean.pct"), folder_ / "a-clean-3.pct");
    EXPECT_EQ(free_path(folder_ / "a-clean-2.pct", "-clean.pct"), folder_ / "a-clean-3.pct");
    EXPECT_EQ(free_path(folder_ / "a-clean.pct", "-normals.pct"), folder_ / "a-clean-normals.pct");
    EXPECT_EQ(free_path(folder_ / "v1.2.pct", "-list.dxf"), folder_ / "v1.2-list.dxf");
    // Without a window nothing is proposed: an empty output of a script is an error.
    FilterCall call("Delete Points of Point Cloud Tree");
    add_layer(call.document, tree);
    EXPECT_FALSE(call.set("Where", fs::path("intensity < 0")).apply());
    EXPECT_NE(call.log().find("no output is given"), std::string::npos) << call.log();
}

TEST_F(ResultFilters, TransformByNumbersAndByAFrozenMatrix)
{
    const fs::path tree = scene_tree("a.las");
    const Box3d box = Tree::open(tree)->info().bounds();
    FilterCall shift(transform_name);
    shift.set("Tree", tree).set("Translate", fs::path("10, 20 -1.5")).set("Output", folder_ / "shift.pct");
    ASSERT_TRUE(shift.apply()) << shift.log();
    const Box3d shifted = Tree::open(folder_ / "shift.pct")->info().bounds();
    EXPECT_NEAR(shifted.min[0], box.min[0] + 10, 1e-9);
    EXPECT_NEAR(shifted.max[2], box.max[2] - 1.5, 1e-9);
    EXPECT_EQ(Tree::open(folder_ / "shift.pct")->info().position_type, ScalarType::i32);  // still on a grid

    FilterCall turn(transform_name);
    turn.set("Tree", tree).set("Rotate", fs::path("0 0 1 90")).set("Scale", FloatValue(2)).set("Output", folder_ / "t");
    ASSERT_TRUE(turn.apply()) << turn.log();
    const Box3d turned_box = Tree::open(folder_ / "t.pct")->info().bounds();
    EXPECT_NEAR(turned_box.extent(0), 2 * box.extent(1), 1e-6);
    EXPECT_NEAR(turned_box.centre()[1], box.centre()[1], 1e-6);

    // MeshLab's Freeze Current Matrix moves the sample's vertices.
    FilterCall frozen(transform_name);
    MeshModel* const layer = add_layer(frozen.document, tree);
    frozen.document.setCurrentMesh(layer->id());
    for (auto& vertex : layer->cm.vert) vertex.P() = turned(0, 5, 0, 0) * vertex.P();
    ASSERT_TRUE(frozen.set("Output", folder_ / "frozen.pct").apply()) << frozen.log();
    EXPECT_NEAR(Tree::open(folder_ / "frozen.pct")->info().bounds().min[0], box.min[0] + 5, 1e-3);

    FilterCall axis(transform_name);
    EXPECT_FALSE(axis.set("Tree", tree).set("Rotate", fs::path("0 0 0 90")).set("Output", folder_ / "b").apply());
    FilterCall same(transform_name);
    same.set("Tree", tree).set("Translate", fs::path("1 0 0")).set("Output", tree).set("Overwrite", true);
    EXPECT_FALSE(same.apply());
    EXPECT_EQ(points_in(tree), 5000u);
}

TEST_F(ResultFilters, MergeOfVisibleLayersWhereTheirMatricesPutThem)
{
    const fs::path one = scene_tree("a.las"), two = scene_tree("b.las", 4000), hidden = scene_tree("c.las", 3000);
    FilterCall call(merge_name);
    EXPECT_FALSE(call.set("Output", folder_ / "merged.pct").apply());
    EXPECT_NE(call.log().find("no trees to merge"), std::string::npos) << call.log();
    add_layer(call.document, one);
    add_layer(call.document, two)->cm.Tr = turned(0, 1000, 0, 0);
    set_shown(*add_layer(call.document, hidden), false);
    ASSERT_TRUE(call.set("SourceId", true).apply()) << call.log();
    const auto merged = Tree::open(folder_ / "merged.pct");
    EXPECT_EQ(merged->info().points, 9000u);
    const double end = Tree::open(two)->info().bounds().max[0] + 1000;
    EXPECT_NEAR(merged->info().bounds().max[0], end, 1e-3);
    ASSERT_EQ(models_of(call.document).size(), 4u);
    EXPECT_EQ(models_of(call.document).back()->cm.Tr, Matrix44m::Identity());
    // It is shown in place of those that were merged.
    for (const MeshModel* layer : models_of(call.document))
        EXPECT_EQ(is_shown(*layer), layer == models_of(call.document).back());
    EXPECT_EQ(call.document.mm(), models_of(call.document).back());
    for (const std::string& word : {"points of 2 trees", "has a matrix: it is applied", "source_id 2: b.pct",
                                    "coordinate system:", "grid: steps 0.001 0.001 0.001"})
        EXPECT_NE(call.log().find(word), std::string::npos) << word << " is not in\n" << call.log();

    call.set("VisibleLayers", false).set("Overwrite", true);
    call.set("Trees", fs::path(one.string() + "; " + hidden.string()));
    ASSERT_TRUE(call.apply()) << call.log();
    EXPECT_EQ(points_in(folder_ / "merged.pct"), 8000u);

    FilterCall unmoved(merge_name);
    add_layer(unmoved.document, two)->cm.Tr = turned(0, 1000, 0, 0);
    ASSERT_TRUE(unmoved.set("Output", folder_ / "u.pct").set("ApplyMatrices", false).apply()) << unmoved.log();
    EXPECT_NEAR(Tree::open(folder_ / "u.pct")->info().bounds().max[0], end - 1000, 1e-9);
}

}  // namespace
}  // namespace pcm::host
