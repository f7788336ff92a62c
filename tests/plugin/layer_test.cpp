// Layers and the registry that ties them to trees.
#include "plugin/meshlab/layer.h"

#include "plugin/meshlab/points_layer.h"
#include "plugin/scene/open_clouds.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

namespace pcm::host {
namespace {

Box3d box_of(const MeshModel& layer)
{
    Box3d box;
    for (const auto& vertex : layer.cm.vert) box.extend(Vec3d{vertex.cP()[0], vertex.cP()[1], vertex.cP()[2]});
    return box;
}

TEST(Layers, LiveAndDieWithTheirDocument)
{
    const test::TemporaryFolder folder;
    const fs::path tree = tree_of(scene(folder, "a.las", 60000, far_away));
    Registry& registry = Registry::instance();
    std::weak_ptr<PointCloud> watched;
    {
        MetDocument document;
        MeshModel* one = document.addNewMesh("one", "one");
        MeshModel* two = document.addNewMesh("two", "two");
        show_tree(*one, open_cloud(tree));
        show_tree(*two, open_cloud(tree / index_file_name));
        const auto first = registry.find(*one), second = registry.find(*two);
        ASSERT_TRUE(first && second);
        EXPECT_EQ(first->cloud, second->cloud);  // one L2 a tree
        EXPECT_EQ(first->origin, second->origin);
        watched = first->cloud;

        auto tag = vcg::tri::Allocator<CMeshO>::FindPerMeshAttribute<std::string>(one->cm, tree_tag);
        ASSERT_TRUE(vcg::tri::Allocator<CMeshO>::IsValidHandle(one->cm, tag));
        EXPECT_EQ(fs::path(tag()), first->cloud->tree()->folder());

        const Box3d bounds = first->cloud->info().bounds();
        const Box3d box = box_of(*one);
        for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(box.max[a], static_cast<float>(bounds.max[a] - first->origin[a]));

        const int id = one->id();
        std::vector<int> gone;
        QObject::connect(&registry, &Registry::detached, &document,
                         [&](MeshDocument*, int mesh) { gone.push_back(mesh); });
        remove_model(document, *one);
        EXPECT_EQ(gone, std::vector<int>{id});
        EXPECT_TRUE(registry.find(*two));
        EXPECT_TRUE(registry.origin_of(document));
        remove_model(document, *two);
        EXPECT_FALSE(registry.origin_of(document));  // an empty document may start anew

        MeshModel* three = document.addNewMesh("three", "three");
        show_tree(*three, open_cloud(tree));
    }
    EXPECT_TRUE(watched.expired());
}

TEST(Layers, TreesOfOneDocumentShareItsOrigin)
{
    const test::TemporaryFolder folder;
    const fs::path here = tree_of(scene(folder, "here.las", 30000, far_away));
    const fs::path there = tree_of(scene(folder, "there.las", 30000, {far_away[0] + 1000, far_away[1], far_away[2]}));
    MetDocument document;
    MeshModel* first = document.addNewMesh("here", "here");
    MeshModel* second = document.addNewMesh("there", "there");
    show_tree(*first, open_cloud(here));
    show_tree(*second, open_cloud(there));
    EXPECT_EQ(Registry::instance().find(*first)->origin, Registry::instance().find(*second)->origin);
    EXPECT_NEAR(box_of(*second).min[0] - box_of(*first).min[0], 1000, 5);
}

TEST(Layers, ATreeThatIsBuiltAnewIsOpenedAnew)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 30000, far_away);
    const fs::path tree = tree_of(las);
    const auto before = open_cloud(tree);
    EXPECT_EQ(before, open_cloud(tree));
    tree_of(las, 5000);
    const auto after = open_cloud(tree);
    EXPECT_NE(before, after);
    EXPECT_GT(after->tree()->nodes().size(), before->tree()->nodes().size());
}

TEST(Layers, SmallFilesAreLoadedWhole)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 20000, far_away);
    MetDocument document;
    MeshModel* layer = document.addNewMesh("a", "a");
    const auto reader = open_reader(las);
    ASSERT_TRUE(load_points(*layer, *reader, 1'000'000, {}));
    ASSERT_EQ(layer->cm.vn, 20000);
    EXPECT_TRUE(layer->hasDataMask(MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTQUALITY));
    const Vec3d origin = *Registry::instance().origin_of(document);

    const auto again = open_reader(las);
    const FileInfo& info = again->info();
    const std::size_t slot = *info.schema.find(attribute_name::intensity);
    PointBatch batch;
    std::size_t n = 0;
    while (again->read(batch, 4096))
        for (std::size_t i = 0; i < batch.size; ++i, ++n) {
            const auto& vertex = layer->cm.vert[n];
            for (std::size_t a = 0; a < 3; ++a)
                ASSERT_EQ(vertex.cP()[int(a)],
                          static_cast<float>(info.grid->to_source(batch.grid_xyz[a][i], a) - origin[a]));
            ASSERT_EQ(vertex.cQ(), static_cast<float>(batch.attributes[slot].value(i)));
        }
    EXPECT_EQ(n, 20000u);
}

TEST(Layers, LoadingCanBeCancelled)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 20000, far_away);
    MetDocument document;
    MeshModel* layer = document.addNewMesh("a", "a");
    const auto reader = open_reader(las);
    EXPECT_THROW(load_points(*layer, *reader, 1'000'000, [](const ProgressUpdate&) { return false; }), Error);
    EXPECT_EQ(layer->cm.vn, 0);
}

}  // namespace
}  // namespace pcm::host
