#include "plugin/meshlab/layer_reader.h"

#include "plugin/meshlab/points_layer.h"
#include "plugin/meshlab/vertex_attributes.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

#include <cmath>
#include <cstring>
#include <fstream>

namespace pcm::host {
namespace {

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
    MetDocument document;
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
    MetDocument document;
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
    MetDocument document;
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
    remove_model(document, *layer);  // and its attributes, once
}

// The double nearest to it is one that float has too, and another number.
TEST(LayerReader, KeepsWhatDoubleWouldRound)
{
    const test::TemporaryFolder folder;
    const fs::path file = folder / "a.pcd";
    std::ofstream(file)
        << "VERSION 0.7\nFIELDS x y z serial\nSIZE 4 4 4 8\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
           "POINTS 2\nDATA ascii\n0 0 0 1152921504606846977\n1 2 3 1152921504606846977\n";
    MetDocument document;
    MeshModel* layer = document.addNewMesh("a", "a");
    ASSERT_TRUE(load_points(*layer, *open_reader(file), 100, {}));
    LayerReader reader(*layer, {});
    const std::size_t serial = *reader.info().schema.find("serial");
    EXPECT_EQ(reader.info().schema[serial].type, ScalarType::u64);
    EXPECT_EQ(all_of(reader).attributes[serial].as<std::uint64_t>()[1], 1152921504606846977u);
}

TEST(LayerReader, ReadsLayersFromElsewhere)
{
    MetDocument document;
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

}  // namespace
}  // namespace pcm::host
