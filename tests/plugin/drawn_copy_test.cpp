// Ordinary layers that are drawn as point clouds.
#include "plugin/meshlab/drawn_copy.h"

#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/points_layer.h"
#include "plugin/scene/tree_cache.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

namespace pcm::host {
namespace {

class DrawnCopy : public testing::Test {
protected:
    void SetUp() override
    {
        layer_ = document_.addNewMesh("a", "a");
        const auto reader = open_reader(scene(folder_, "a.las", 20000, far_away));
        ASSERT_TRUE(load_points(*layer_, *reader, 1'000'000, {}));
        draw_as_cloud(*layer_, {});
    }

    bool outdated_at(bool glance) const { return is_outdated(*layer_, glance); }

    const test::TemporaryFolder folder_;
    MetDocument document_;
    MeshModel* layer_ = nullptr;
};

TEST_F(DrawnCopy, IsOfAllPointsAndLeavesTheLayerAnOrdinaryOne)
{
    const auto copy = Registry::instance().drawn(*layer_);
    ASSERT_TRUE(copy && copy->is_copy());
    EXPECT_EQ(copy->cloud->info().points, 20000u);
    EXPECT_EQ(copy->origin, *Registry::instance().origin_of(document_));
    EXPECT_FALSE(Registry::instance().find(*layer_));  // saving and filters take the vertices
    EXPECT_TRUE(Registry::instance().source_of(*layer_));
    const auto tag = vcg::tri::Allocator<CMeshO>::FindPerMeshAttribute<std::string>(layer_->cm, tree_tag);
    EXPECT_FALSE(vcg::tri::Allocator<CMeshO>::IsValidHandle(layer_->cm, tag));
    // The exact positions of the file.
    const Box3d bounds = copy->cloud->info().bounds();
    for (std::size_t a = 0; a < 3; ++a)
        EXPECT_EQ(layer_->cm.bbox.max[int(a)], static_cast<float>(bounds.max[a] - copy->origin[a]));
    EXPECT_FALSE(outdated_at(false));
    EXPECT_FALSE(outdated_at(true));
}

TEST_F(DrawnCopy, IsOutdatedByEveryChangeOfWhatItShows)
{
    auto& vertices = layer_->cm.vert;
    const auto changed = [&](const auto& change, const auto& undo) {
        change(vertices[777]);
        const bool noticed = outdated_at(false);
        undo(vertices[777]);
        EXPECT_FALSE(outdated_at(false));
        return noticed;
    };
    const auto position = vertices[777].P();
    EXPECT_TRUE(changed([](auto& v) { v.P()[2] += 0.25f; }, [&](auto& v) { v.P() = position; }));
    const auto colour = vertices[777].C();
    EXPECT_TRUE(changed([](auto& v) { v.C()[1] ^= 1; }, [&](auto& v) { v.C() = colour; }));
    const auto normal = vertices[777].N();
    EXPECT_TRUE(changed([](auto& v) { v.N()[0] += 1; }, [&](auto& v) { v.N() = normal; }));
    const auto quality = vertices[777].Q();
    EXPECT_TRUE(changed([](auto& v) { v.Q() += 1; }, [&](auto& v) { v.Q() = quality; }));
    EXPECT_TRUE(changed([](auto& v) { v.SetD(); }, [](auto& v) { v.ClearD(); }));
    // What it does not show.
    EXPECT_FALSE(changed([](auto& v) { v.SetS(); }, [](auto& v) { v.ClearS(); }));
    layer_->cm.Tr.SetTranslate(1, 2, 3);
    EXPECT_FALSE(outdated_at(false));
}

TEST_F(DrawnCopy, AGlanceNoticesWhatConcernsManyVertices)
{
    for (auto& vertex : layer_->cm.vert) vertex.C()[0] ^= 255;
    EXPECT_TRUE(outdated_at(true));
}

TEST_F(DrawnCopy, GoesWithItsLayer)
{
    const fs::path tree = Registry::instance().drawn(*layer_)->cloud->tree()->folder();
    ASSERT_TRUE(fs::exists(tree));
    std::vector<int> dropped;
    QObject::connect(&Registry::instance(), &Registry::copy_dropped, &document_,
                     [&](MeshDocument*, int mesh) { dropped.push_back(mesh); });
    Registry::instance().drop_copy(*layer_);
    EXPECT_EQ(dropped, std::vector<int>{layer_->id()});
    EXPECT_FALSE(Registry::instance().drawn(*layer_));
    EXPECT_FALSE(fs::exists(tree));

    draw_as_cloud(*layer_, {});
    const fs::path second = Registry::instance().drawn(*layer_)->cloud->tree()->folder();
    remove_model(document_, *layer_);
    EXPECT_FALSE(fs::exists(second));
}

TEST_F(DrawnCopy, FollowsTheVerticesWhenItIsMadeAgain)
{
    for (std::size_t i = 0; i < 5000; ++i) vcg::tri::Allocator<CMeshO>::DeleteVertex(layer_->cm, layer_->cm.vert[i]);
    EXPECT_TRUE(outdated_at(true));
    draw_as_cloud(*layer_, {});
    EXPECT_EQ(Registry::instance().drawn(*layer_)->cloud->info().points, 15000u);
    EXPECT_FALSE(outdated_at(false));
}

TEST_F(DrawnCopy, IsRefusedForMeshesAndEmptyLayersAndCanBeCancelled)
{
    MeshModel* empty = document_.addNewMesh("empty", "empty");
    EXPECT_THROW(draw_as_cloud(*empty, {}), Error);
    vcg::tri::Allocator<CMeshO>::AddVertices(empty->cm, 3);
    EXPECT_EQ(why_not_drawn(*empty), "");
    vcg::tri::Allocator<CMeshO>::AddFaces(empty->cm, 1);
    EXPECT_NE(why_not_drawn(*empty), "");
    try {
        draw_as_cloud(*layer_, [](const ProgressUpdate&) { return false; });
        FAIL() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
}

}  // namespace
}  // namespace pcm::host
