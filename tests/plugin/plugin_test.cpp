// What the plugins do apart from MeshLab's window: documents and layers are MeshLab's own, without a view.
#include "tests/las_points.h"
#include "tests/support.h"

#include "pcm/build/builder.h"
#include "pcm/generate/scene.h"
#include "plugin/filter/tree_information.h"
#include "plugin/host/layer.h"
#include "plugin/host/layer_reader.h"
#include "plugin/host/operation.h"
#include "plugin/host/origin.h"
#include "plugin/host/points_layer.h"
#include "plugin/host/proxy.h"
#include "plugin/host/text.h"
#include "plugin/host/vertex_attributes.h"
#include "plugin/io/tree_beside.h"

#include <QApplication>
#include <QKeyEvent>

#include <cmath>
#include <cstring>
#include <fstream>

namespace pcm::host {
namespace {

namespace fs = std::filesystem;

const Vec3d far_away{500000.0, 4800000.0, 100.0};

fs::path scene(const test::TemporaryFolder& folder, const std::string& name, std::uint64_t points, const Vec3d& origin)
{
    SceneOptions options;
    options.points = points;
    options.origin = origin;
    const fs::path las = folder / name;
    generate_scene(las, options, false);
    return las;
}

fs::path tree_of(const fs::path& las, std::uint32_t chunk_points = 20000)
{
    BuildOptions options;
    options.memory_bytes = std::uint64_t(64) << 20;
    options.chunk_points = chunk_points;
    options.overwrite = true;
    const fs::path tree = tree_path(las);
    build_tree({las}, tree, options);
    return tree;
}

// A file of which every point has the given colour and intensity.
fs::path write_las(const fs::path& path, std::size_t points, std::uint16_t red, std::uint16_t intensity_step)
{
    Grid grid;
    grid.scale = {0.01, 0.01, 0.01};
    std::vector<test::LasPoint> cloud(points);
    for (std::size_t i = 0; i < points; ++i) {
        test::LasPoint& point = cloud[i];
        point.x = static_cast<std::int32_t>(i * 7919 % 10007);
        point.y = static_cast<std::int32_t>(i * 104729 % 10009);
        point.z = static_cast<std::int32_t>(i % 101);
        point.red = red;
        point.intensity = static_cast<std::uint16_t>(i * intensity_step);
    }
    test::write_las_points(path, grid, cloud);
    return path;
}

Box3d box_of(const MeshModel& layer)
{
    Box3d box;
    for (const auto& vertex : layer.cm.vert) box.extend(Vec3d{vertex.cP()[0], vertex.cP()[1], vertex.cP()[2]});
    return box;
}

TEST(Text, NumbersAreReadBackExactly)
{
    EXPECT_EQ(grouped(0), "0");
    EXPECT_EQ(grouped(999), "999");
    EXPECT_EQ(grouped(1234567), "1,234,567");
    for (const double value : {0.1, 4800000.123, -5e6 + 1e-9, 1e-9, 3e22, 0.0})
        EXPECT_EQ(std::stod(exact(value)), value);
    EXPECT_EQ(exact(4800000.123), "4800000.123");
}

TEST(Text, EveryErrorHasWords)
{
    const auto words = [](auto thrown) {
        try {
            throw thrown;
        } catch (...) {
            return current_error();
        }
    };
    EXPECT_EQ(words(Error(ErrorCode::io, "a/b", "went wrong")), "a/b: went wrong");
    EXPECT_EQ(words(std::bad_alloc()), "there is not enough memory");
    EXPECT_EQ(words(7), "an unknown error occurred");
}

TEST(Origin, IsZeroWhereFloatDoesNotMind)
{
    EXPECT_EQ(choose_origin({{-3, 2, 0}, {40, 50, 10}}), (Vec3d{0, 0, 0}));
    EXPECT_EQ(choose_origin({{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}}), (Vec3d{0, 0, 0}));
    const Box3d map{{500000.25, 4800000.5, 90}, {500101, 4800102, 121}};
    EXPECT_EQ(choose_origin(map), (Vec3d{500051, 4800051, 106}));
}

TEST(Origin, BoundsTheRoundingOfFloat)
{
    const Box3d boxes[] = {{{500000.1, 4800000.7, 90.3}, {500123.4, 4800099.9, 121.7}},
                           {{-3.1, 2.7, 0}, {40.3, 50.1, 10.9}},
                           {{1e6 + 1e-6, 1e6, 1e6}, {1e6 + 3e-6, 1e6 + 2e-6, 1e6 + 1e-6}},
                           {{7, 8, 9}, {7, 8, 9}}};
    for (const Box3d& box : boxes) {
        const Vec3d origin = choose_origin(box);
        double largest = 0;
        for (int i = 0; i <= 1000; ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                const double local = box.min[a] + box.extent(a) * i / 1000 - origin[a];
                largest = std::max(largest, std::fabs(static_cast<double>(static_cast<float>(local)) - local));
            }
        EXPECT_LE(largest, float_rounding(box, origin));
        // No more than eight times what the best origin would give.
        EXPECT_LE(float_rounding(box, origin), 8 * std::ldexp(box.diagonal(), -24));
    }
}

TEST(Proxy, IsBoundedAndSpansTheTrueBox)
{
    const test::TemporaryFolder folder;
    const auto cloud = PointCloud::open(tree_of(scene(folder, "a.las", 150000, far_away)));
    const Box3d bounds = cloud->info().bounds();
    const Vec3d origin = choose_origin(bounds);
    for (const std::uint64_t most : {100u, 5000u, 50000u}) {
        const Proxy proxy = make_proxy(*cloud, origin, most);
        EXPECT_LE(proxy.points.size(), most + 6);
        EXPECT_GE(proxy.points.size(), most / 4);
        EXPECT_TRUE(proxy.has_rgb);
        Box3d box;
        for (const ProxyPoint& point : proxy.points)
            box.extend(Vec3d{point.position[0], point.position[1], point.position[2]});
        for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_EQ(box.min[a], static_cast<float>(bounds.min[a] - origin[a]));
            EXPECT_EQ(box.max[a], static_cast<float>(bounds.max[a] - origin[a]));
        }
    }
}

TEST(Proxy, ColoursAreEightOrSixteenBitsOrIntensity)
{
    const test::TemporaryFolder folder;
    const auto first = [&](const std::string& name, std::uint16_t red, std::uint16_t step) {
        const auto cloud = PointCloud::open(tree_of(write_las(folder / name, 3000, red, step)));
        return make_proxy(*cloud, {0, 0, 0});
    };
    const Proxy eight = first("eight.las", 200, 1), sixteen = first("sixteen.las", 200 * 257, 1),
                none = first("none.las", 0, 7);
    EXPECT_EQ(eight.points[0].colour[0], 200);
    EXPECT_EQ(sixteen.points[0].colour[0], 200);
    EXPECT_TRUE(eight.has_rgb);
    // Black throughout is no colour: intensity shows.
    EXPECT_FALSE(none.has_rgb);
    int brightest = 0;
    for (const ProxyPoint& point : none.points) {
        EXPECT_EQ(point.colour[0], point.colour[1]);
        brightest = std::max<int>(brightest, point.colour[0]);
    }
    EXPECT_EQ(brightest, 255);
}

TEST(Layers, LiveAndDieWithTheirDocument)
{
    const test::TemporaryFolder folder;
    const fs::path tree = tree_of(scene(folder, "a.las", 60000, far_away));
    Registry& registry = Registry::instance();
    std::weak_ptr<PointCloud> watched;
    {
        MeshDocument document;
        MeshModel* one = document.addNewMesh("one", "one");
        MeshModel* two = document.addNewMesh("two", "two");
        show_tree(*one, registry.open(tree));
        show_tree(*two, registry.open(tree / index_file_name));
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
        document.delMesh(one);
        EXPECT_EQ(gone, std::vector<int>{id});
        EXPECT_TRUE(registry.find(*two));
        EXPECT_TRUE(registry.origin_of(document));
        document.delMesh(two);
        EXPECT_FALSE(registry.origin_of(document));  // an empty document may start anew

        MeshModel* three = document.addNewMesh("three", "three");
        show_tree(*three, registry.open(tree));
    }
    EXPECT_TRUE(watched.expired());
}

TEST(Layers, TreesOfOneDocumentShareItsOrigin)
{
    const test::TemporaryFolder folder;
    const fs::path here = tree_of(scene(folder, "here.las", 30000, far_away));
    const fs::path there = tree_of(scene(folder, "there.las", 30000, {far_away[0] + 1000, far_away[1], far_away[2]}));
    MeshDocument document;
    MeshModel* first = document.addNewMesh("here", "here");
    MeshModel* second = document.addNewMesh("there", "there");
    show_tree(*first, Registry::instance().open(here));
    show_tree(*second, Registry::instance().open(there));
    EXPECT_EQ(Registry::instance().find(*first)->origin, Registry::instance().find(*second)->origin);
    EXPECT_NEAR(box_of(*second).min[0] - box_of(*first).min[0], 1000, 5);
}

TEST(Layers, ATreeThatIsBuiltAnewIsOpenedAnew)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 30000, far_away);
    const fs::path tree = tree_of(las);
    const auto before = Registry::instance().open(tree);
    EXPECT_EQ(before, Registry::instance().open(tree));
    tree_of(las, 5000);
    const auto after = Registry::instance().open(tree);
    EXPECT_NE(before, after);
    EXPECT_GT(after->tree()->nodes().size(), before->tree()->nodes().size());
}

TEST(Layers, SmallFilesAreLoadedWhole)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 20000, far_away);
    MeshDocument document;
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

// All of a reader's points in one batch.
PointBatch all_of(PointReader& reader)
{
    PointBatch all;
    EXPECT_TRUE(reader.read(all, 1'000'000));
    PointBatch none;
    EXPECT_FALSE(reader.read(none, 1));
    return all;
}

TEST(LayerReader, GivesBackTheFileToTheLastBit)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 20000, far_away);
    MeshDocument document;
    MeshModel* layer = document.addNewMesh("a", "a");
    ASSERT_TRUE(load_points(*layer, *open_reader(las), 1'000'000, {}));
    LayerReader reader(*layer, {});
    const auto original = open_reader(las);
    EXPECT_TRUE(reader.info().schema == original->info().schema);
    EXPECT_TRUE(reader.info().grid == original->info().grid);
    EXPECT_TRUE(reader.info().metadata == original->info().metadata);
    EXPECT_EQ(reader.moved(), 0u);
    const PointBatch read = all_of(reader), expected = all_of(*original);
    ASSERT_EQ(read.size, expected.size);
    EXPECT_TRUE(read.grid_xyz == expected.grid_xyz);
    for (std::size_t a = 0; a < read.attributes.size(); ++a)
        EXPECT_EQ(std::memcmp(read.attributes[a].data(), expected.attributes[a].data(), expected.attributes[a].bytes()),
                  0)
            << reader.info().schema[a].name;
}

TEST(LayerReader, GivesWhatWasChanged)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 1000, far_away);
    MeshDocument document;
    MeshModel* layer = document.addNewMesh("a", "a");
    ASSERT_TRUE(load_points(*layer, *open_reader(las), 1'000'000, {}));
    const Vec3d origin = *Registry::instance().origin_of(document);
    auto& vertices = layer->cm.vert;
    vertices[5].P()[0] += 1.25f;
    vertices[6].C() = vcg::Color4b(255, 0, 51, 255);
    auto& weight = add_vertex_attribute<float>(*layer, "weight");
    for (std::size_t i = 0; i < vertices.size(); ++i) weight[i] = static_cast<float>(i) + 0.5f;
    vcg::tri::Allocator<CMeshO>::DeleteVertex(layer->cm, vertices[3]);
    vcg::tri::Allocator<CMeshO>::CompactVertexVector(layer->cm);  // now 5 is 4, and 6 is 5

    LayerReader reader(*layer, {});
    EXPECT_EQ(reader.moved(), 1u);
    const FileInfo info = reader.info();
    EXPECT_EQ(info.points, 999u);
    const PointBatch read = all_of(reader);
    const auto position = [&](std::size_t i, std::size_t a) {
        return read.gridded ? info.grid->to_source(read.grid_xyz[a][i], a) : read.xyz[a][i];
    };
    EXPECT_EQ(position(4, 0), static_cast<double>(layer->cm.vert[4].cP()[0]) + origin[0]);
    const Column& rgb = read.attributes[*info.schema.find(attribute_name::rgb)];
    ASSERT_EQ(rgb.type(), ScalarType::u16);
    const double full = ColourScale::of(rgb, ColourSource::rgb).high;
    EXPECT_EQ(rgb.value(5, 0), full);
    EXPECT_EQ(rgb.value(5, 1), 0);
    EXPECT_EQ(rgb.value(5, 2), std::round(full / 5));
    const auto original = open_reader(las);
    const PointBatch expected = all_of(*original);
    for (std::size_t i = 0; i < read.size; ++i) {
        const std::size_t before = i < 3 ? i : i + 1;
        EXPECT_EQ(read.attributes[*info.schema.find("weight")].value(i), static_cast<double>(before) + 0.5);
        if (i == 4) continue;
        for (std::size_t a = 0; a < 3; ++a)
            EXPECT_EQ(position(i, a), original->info().grid->to_source(expected.grid_xyz[a][before], a));
    }

    layer->cm.vert[7].SetS();
    layer->cm.vert[9].SetS();
    LayerSelection selected;
    selected.selected_only = true;
    selected.colour = false;
    LayerReader two(*layer, selected);
    EXPECT_EQ(two.info().points, 2u);
    EXPECT_FALSE(two.info().schema.find(attribute_name::rgb));
    for (auto& vertex : layer->cm.vert) vertex.ClearS();
    EXPECT_THROW(LayerReader(*layer, selected), Error);
}

TEST(LayerReader, KeepsWhatFloatWouldRound)
{
    const test::TemporaryFolder folder;
    const fs::path file = folder / "a.ply";
    std::ofstream(file)
        << "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double "
           "z\nproperty double gps_time\nproperty int id\nproperty uchar class\nend_header\n"
           "5000000.123456789 4800000.1 1 123456789.123456 2147483647 7\n"
           "5000001.2 4800000.3 2 123456789.123457 -5 9\n";
    MeshDocument document;
    MeshModel* layer = document.addNewMesh("a", "a");
    ASSERT_TRUE(load_points(*layer, *open_reader(file), 100, {}));
    EXPECT_TRUE(find_vertex_attribute<float>(*layer, "class"));
    EXPECT_TRUE(find_vertex_attribute<double>(*layer, "gps_time"));
    EXPECT_TRUE(find_vertex_attribute<double>(*layer, "id"));
    LayerReader reader(*layer, {});
    const FileInfo info = reader.info();
    EXPECT_TRUE(info.schema == open_reader(file)->info().schema);
    const PointBatch read = all_of(reader);
    EXPECT_EQ(read.xyz[0][0], 5000000.123456789);
    EXPECT_EQ(read.attributes[*info.schema.find("gps_time")].value(1), 123456789.123457);
    EXPECT_EQ(read.attributes[*info.schema.find("id")].value(0), 2147483647);
    document.delMesh(layer);  // and its attributes, once
}

TEST(LayerReader, ReadsLayersFromElsewhere)
{
    MeshDocument document;
    MeshModel* layer = document.addNewMesh("b", "b");
    vcg::tri::Allocator<CMeshO>::AddVertices(layer->cm, 3);
    layer->updateDataMask(MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTQUALITY);
    for (auto& vertex : layer->cm.vert) {
        vertex.P() = Point3m(0.1f, 2, 3);
        vertex.Q() = 0.25f;
    }
    LayerReader reader(*layer, {});
    EXPECT_EQ(reader.info().position_type, ScalarType::f32);
    EXPECT_TRUE(reader.info().schema.find(attribute_name::rgb));
    EXPECT_FALSE(reader.info().schema.find(attribute_name::normal));
    const FileInfo info = reader.info();
    const PointBatch read = all_of(reader);
    EXPECT_EQ(read.xyz[0][2], static_cast<double>(0.1f));
    EXPECT_EQ(read.attributes[*info.schema.find(attribute_name::intensity)].value(0), 0.25);
}

TEST(TreeBeside, InAFolderNamesTellFilesOfOneNameApart)
{
    const fs::path one = tree_path("/a/scan.las", "/trees"), two = tree_path("/b/scan.las", "/trees");
    EXPECT_EQ(one.parent_path(), "/trees");
    EXPECT_EQ(one.extension(), ".pct");
    EXPECT_NE(one, two);
    EXPECT_EQ(one, tree_path("/a/../a/scan.las", "/trees"));
    EXPECT_NE(one, tree_path("/a/scan.laz", "/trees"));
}

TEST(Layers, LoadingCanBeCancelled)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 20000, far_away);
    MeshDocument document;
    MeshModel* layer = document.addNewMesh("a", "a");
    const auto reader = open_reader(las);
    EXPECT_THROW(load_points(*layer, *reader, 1'000'000, [](const ProgressUpdate&) { return false; }), Error);
    EXPECT_EQ(layer->cm.vn, 0);
}

TEST(TreeBeside, IsBuiltOnceAndAgainWhenTheFileChanges)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 20000, far_away);
    const fs::path tree = folder / "a.pct";
    EXPECT_EQ(tree_path(las), tree);
    const auto ensure = [&] { return ensure_tree({las, tree_path(las), {}, false}, open_reader(las)->info(), {}); };
    EXPECT_EQ(ensure().at(0).rfind("Built", 0), 0u);
    EXPECT_NE(ensure().at(0).find("up to date"), std::string::npos);
    scene(folder, "a.las", 21000, far_away);
    EXPECT_FALSE(tree_is_current(tree, las, 21000));
    EXPECT_EQ(ensure().at(0).rfind("Built", 0), 0u);
    EXPECT_EQ(Tree::open(tree)->info().points, 21000u);
    // As many points, but newer than the tree.
    fs::last_write_time(las, fs::last_write_time(tree / index_file_name) + std::chrono::seconds(5));
    EXPECT_FALSE(tree_is_current(tree, las, 21000));
}

TEST(TreeBeside, NeverReplacesWhatIsNotItsOwn)
{
    const test::TemporaryFolder folder;
    const fs::path las = scene(folder, "a.las", 20000, far_away);
    const auto ensure = [&] { ensure_tree({las, tree_path(las), {}, false}, open_reader(las)->info(), {}); };

    const fs::path other = tree_of(scene(folder, "b.las", 20000, far_away));
    fs::rename(other, folder / "a.pct");
    EXPECT_THROW(ensure(), Error);
    EXPECT_EQ(Tree::open(folder / "a.pct")->info().sources.at(0), "b.las");
    fs::remove_all(folder / "a.pct");

    std::ofstream(folder / "a.pct") << "a letter";
    EXPECT_THROW(ensure(), Error);
    EXPECT_EQ(fs::file_size(folder / "a.pct"), 8u);
}

TEST(TreeInformation, SaysEverythingWithAllDigits)
{
    const test::TemporaryFolder folder;
    const auto tree = Tree::open(tree_of(scene(folder, "a.las", 60000, far_away)));
    std::string all;
    for (const std::string& line : tree_information(*tree)) all += line + "\n";
    const Box3d bounds = tree->info().bounds();
    for (const std::string& expected :
         {std::string("a.las"), std::string("60,000"), exact(bounds.min), exact(bounds.max),
          std::string("rgb, u16 x 3"), std::string("Level 0:"), std::string("Largest position error: 0 ")})
        EXPECT_NE(all.find(expected), std::string::npos) << expected << " is not in\n" << all;
}

TEST(Operation, IsAloneAndEscCancels)
{
    QObject receiver;
    {
        Operation operation(nullptr);
        EXPECT_THROW(Operation second(nullptr), Error);
        EXPECT_THROW(Operation::refuse_second(), Error);
        const ProgressFunction progress = operation.progress();
        EXPECT_TRUE(progress({"Reading", 0.5, 10}));
        QKeyEvent other(QEvent::KeyPress, Qt::Key_A, Qt::NoModifier);
        QCoreApplication::sendEvent(&receiver, &other);
        EXPECT_TRUE(progress({"Reading", 0.5, 10}));
        QKeyEvent escape(QEvent::KeyPress, Qt::Key_Escape, Qt::NoModifier);
        QCoreApplication::sendEvent(&receiver, &escape);
        EXPECT_FALSE(progress({"Reading", 0.5, 10}));

        QEvent close(QEvent::Close);
        close.accept();
        QCoreApplication::sendEvent(&receiver, &close);
        EXPECT_FALSE(close.isAccepted());
    }
    EXPECT_NO_THROW(Operation next(nullptr));
}

}  // namespace
}  // namespace pcm::host

int main(int argc, char** argv)
{
    qputenv("QT_QPA_PLATFORM", "offscreen");
    QApplication application(argc, argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
