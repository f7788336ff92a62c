#include "plugin/panels/sample_deletion.h"

#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/sample_change.h"
#include "plugin/scene/open_clouds.h"
#include "plugin/scene/sample_region.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

namespace pcm::host {
namespace {

TEST(SampleDeletion, DeletesThePointsThatTheVerticesStoodFor)
{
    const test::TemporaryFolder folder;
    MetDocument document;
    MeshModel* layer = document.addNewMesh("a", "a");
    show_tree(*layer, open_cloud(tree_of(scene(folder, "a.las", 80000, far_away))));
    layer->cm.Tr.SetTranslate(1, 2, 3);
    const auto tree = *Registry::instance().find(*layer);
    const double middle = tree.cloud->info().bounds().centre()[0];
    for (auto& vertex : layer->cm.vert)
        if (vertex.cP()[0] + tree.origin[0] > middle) vcg::tri::Allocator<CMeshO>::DeleteVertex(layer->cm, vertex);

    const SampleChange change = find_change(*layer, *tree.sample);
    ASSERT_EQ(change.kind, SampleChange::Kind::deleted);
    const auto region = region_of(*tree.sample, change.deleted, tree.origin, std::nullopt, 1);
    ASSERT_TRUE(region);
    const std::string counted = points_in(tree, region->region);
    Operation operation(nullptr);
    const auto lines = delete_points_in(scene_of(document), tree, region->region, operation);
    EXPECT_NE(lines.front().find("Deleted " + counted + " of the 80,000 points"), std::string::npos) << lines.front();

    const auto now = Registry::instance().find(*layer);
    ASSERT_TRUE(now);
    // The face of the box lies between vertices on both sides of the middle.
    EXPECT_NEAR(now->cloud->info().bounds().max[0], middle, tree.sample->spacing);
    EXPECT_LT(now->cloud->info().points, 60000u);
    EXPECT_EQ(state_of(*layer, Watched::sample), now->state);
    EXPECT_EQ(layer->cm.Tr[0][3], 1) << "the layer was moved, and still is";
}

}  // namespace
}  // namespace pcm::host
