// Clouds that do not fit the others of a document: another coordinate system, or too far away for floats.
#include "plugin/scene/misfit.h"
#include "plugin/meshlab/document_scene.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/system/error.h"
#include "plugin/meshlab/io/import.h"
#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/points_layer.h"
#include "tests/memory_reader.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

namespace pcm::host {
namespace {

using Kind = Misfit::Kind;

std::vector<Metadata> crs(const std::string& text)
{
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    return {{crs_comment, {bytes, bytes + text.size()}}};
}

std::vector<Kind> kinds(const MeshModel& layer, const std::vector<Metadata>& metadata, const std::optional<Box3d>& box)
{
    std::vector<Kind> found;
    for (const Misfit& misfit : misfits(layer_of(layer), metadata, box)) found.push_back(misfit.kind);
    return found;
}

Box3d around(const Vec3d& centre, double size)
{
    Box3d box;
    for (const double s : {-size / 2, size / 2}) box.extend(Vec3d{centre[0] + s, centre[1] + s, centre[2] + s});
    return box;
}

TEST(Misfits, RoundingIsMeasuredByTheCloud)
{
    EXPECT_FALSE(rounds_visibly(around(far_away, 100), far_away));
    EXPECT_FALSE(rounds_visibly(around({500200, 4800000, 100}, 100), far_away));
    EXPECT_FALSE(rounds_visibly(around({505000, 4800000, 100}, 10000), far_away)) << "the next tile";
    EXPECT_TRUE(rounds_visibly(around({0, 0, 0}, 100), far_away)) << "a quarter of a unit";
    EXPECT_TRUE(rounds_visibly(around({4500000, 5300000, 100}, 1000), far_away)) << "another zone";
    EXPECT_TRUE(rounds_visibly(around(far_away, 100), {0, 0, 0}));
    EXPECT_FALSE(rounds_visibly(around({0, 0, 0}, 1e7), far_away)) << "a continent has the same rounding anywhere";
}

TEST(Misfits, OfALayerBesideOthers)
{
    MetDocument document;
    MeshModel* first = document.addNewMesh("first.las", "first.las");
    MeshModel* second = document.addNewMesh("second.las", "second.las");
    const Box3d here = around(far_away, 100), there = around({4500000, 5300000, 100}, 100);
    EXPECT_TRUE(misfits(layer_of(*first), crs("EPSG:32632"), here).empty()) << "nothing else is shown";

    Schema none;
    test::MemoryCloud cloud = test::random_cloud(none, Grid{{0.001, 0.001, 0.001}, far_away}, 1000, 1, 50);
    cloud.info.metadata = crs("EPSG:32632");
    test::MemoryReader reader(cloud);
    ASSERT_TRUE(load_points(*first, reader, 10000, {}));

    EXPECT_TRUE(misfits(layer_of(*second), crs("EPSG:32632"), here).empty());
    EXPECT_TRUE(misfits(layer_of(*second), {}, here).empty()) << "without a system";
    EXPECT_EQ(kinds(*second, crs("EPSG:32633"), here), std::vector<Kind>{Kind::system});
    EXPECT_EQ(kinds(*second, crs("EPSG:32633"), std::nullopt), std::vector<Kind>{Kind::system});
    EXPECT_EQ(kinds(*second, crs("EPSG:32632"), there), std::vector<Kind>{Kind::distance});
    EXPECT_EQ(kinds(*second, crs("EPSG:32633"), there), (std::vector<Kind>{Kind::system, Kind::distance}));
    EXPECT_TRUE(misfits(layer_of(*first), crs("EPSG:32633"), there).empty()) << "loaded again, it is alone";
    const auto found = misfits(layer_of(*second), crs("EPSG:32633"), there);
    for (const char* word : {"EPSG:32633", "EPSG:32632", "first.las"})
        EXPECT_NE(found[0].text.find(word), std::string::npos) << found[0].text;
    EXPECT_NE(found[1].text.find("rounded to 0.12"), std::string::npos) << found[1].text;
}

// The import asks once for each reason, before the layer changes, and ends where the answer is no.
TEST(Misfits, TheImportReportsThemBeforeTheLayerChanges)
{
    const test::TemporaryFolder folder;
    const fs::path here = scene(folder, "here.las", 3000, far_away);
    const fs::path there = scene(folder, "there.las", 3000, {4500000, 5300000, 100});
    const fs::path tree = tree_of(there);
    MetDocument document;
    MeshModel* first = document.addNewMesh("here", "here");
    const auto never = [](const std::vector<std::string>& reasons) { FAIL() << reasons[0]; };
    import_cloud(here, *first, {}, {}, never);
    for (const fs::path& path : {there, tree}) {
        MeshModel* second = document.addNewMesh("there", "there");
        EXPECT_THROW(import_cloud(path, *second, {}, {},
                                  [&](const std::vector<std::string>&) {
                                      EXPECT_EQ(second->cm.vert.size(), 0u);
                                      throw Error(ErrorCode::cancelled, {}, "no");
                                  }),
                     Error);
        EXPECT_EQ(second->cm.vert.size(), 0u);
        std::size_t asked = 0;
        import_cloud(path, *second, {}, {}, [&](const std::vector<std::string>& reasons) { asked += reasons.size(); });
        EXPECT_EQ(asked, 1u);
        EXPECT_GT(second->cm.vert.size(), 0u);
        remove_model(document, *second);
    }
}

}  // namespace
}  // namespace pcm::host
