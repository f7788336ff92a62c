// Conversions whose output depends on the cloud's values: they are looked at first, and no longer than needed.

#include "pcm/convert/convert.h"

#include "pcm/build/builder.h"
#include "pcm/io/formats.h"
#include "tests/clouds.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <fstream>
#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// Counts what is read of a cloud.
class CountedReader final : public PointReader {
public:
    CountedReader(const MemoryCloud& cloud, std::vector<std::size_t>& counts) : reader_(cloud), counts_(counts)
    {
        counts_.push_back(0);
    }
    const FileInfo& info() const override { return reader_.info(); }
    bool read(PointBatch& batch, std::size_t max_points) override
    {
        const bool more = reader_.read(batch, max_points);
        counts_.back() += batch.size;
        return more;
    }
    double fraction_read() const override { return reader_.fraction_read(); }

private:
    MemoryReader reader_;
    std::vector<std::size_t>& counts_;
};

MemoryCloud colours(std::uint16_t step, std::size_t points = 200000)
{
    Schema schema;
    schema.add({"rgb", ScalarType::u16, 3, 1, 0, ""});
    MemoryCloud cloud = random_cloud(schema, Grid{{0.001, 0.001, 0.001}, {5e5, 4.8e6, 0}}, points, 1, 900);
    auto* const values = cloud.points.attributes[0].as<std::uint16_t>();
    for (std::size_t i = 0; i < 3 * points; ++i) values[i] = static_cast<std::uint16_t>(i % 256 * step);
    return cloud;
}

// Points read by each pass.
std::vector<std::size_t> passes(const MemoryCloud& cloud, const fs::path& output)
{
    std::vector<std::size_t> counts;
    const auto report =
        write_cloud([&] { return std::make_unique<CountedReader>(cloud, counts); }, output, ConvertOptions());
    EXPECT_EQ(report.outcome.points_out, cloud.points.size);
    return counts;
}

TEST(Exports, TheCloudIsReadTwiceOnlyWhereItsValuesDecide)
{
    const TemporaryFolder folder;
    const std::size_t all = 200000;
    using Counts = std::vector<std::size_t>;
    // The last colour could be one that 8 bits do not hold.
    EXPECT_EQ(passes(colours(257), folder / "a.ply"), (Counts{all, all}));
    // The first colours are such: the rest need not be read for that. (And floats do not hold map coordinates.)
    MemoryCloud full = colours(257);
    full.points.attributes[0].as<std::uint16_t>()[7] = 258;
    for (const char* output : {"b.ply", "b.pcd"}) {
        const Counts counts = passes(full, folder / output);
        ASSERT_EQ(counts.size(), 2u);
        EXPECT_LE(counts[0], default_batch_points);
        EXPECT_EQ(counts[1], all);
    }
    // LAS has 16 bits, and the grid is there.
    EXPECT_EQ(passes(full, folder / "c.las"), Counts{all});
    EXPECT_EQ(passes(full, folder / "c.xyz"), Counts{all});
}

TEST(Exports, ATreesColoursOf8BitsStayThatInPly)
{
    const TemporaryFolder folder;
    const MemoryCloud cloud = colours(256, 3000);
    MemoryReader reader(cloud);
    build_tree(reader, {"memory"}, folder / "in.pct");
    const ConvertReport report = convert({folder / "in.pct"}, folder / "out.ply");
    EXPECT_TRUE(report.notes.empty()) << report.notes[0];
    const auto back = open_cloud({folder / "out.ply"});
    EXPECT_EQ(back->info().schema[0].type, ScalarType::u16) << "restored";
    EXPECT_EQ(open_reader(folder / "out.ply")->info().schema.size(), 1u);
    std::string header(600, ' ');
    std::ifstream(folder / "out.ply").read(header.data(), 600);
    EXPECT_NE(header.find("property uchar red"), std::string::npos) << header;
}

TEST(Exports, FloatIntensitiesOfATreeFillTheFieldOfLas)
{
    const TemporaryFolder folder;
    Schema schema;
    schema.add({"intensity", ScalarType::f32, 1, 1, 0, ""});
    MemoryCloud cloud = random_cloud(schema, Grid{{0.001, 0.001, 0.001}, {5e5, 4.8e6, 0}}, 3000, 1, 900);
    for (std::size_t i = 0; i < 3000; ++i) cloud.points.attributes[0].as<float>()[i] = static_cast<float>(i) / 2999;
    MemoryReader reader(cloud);
    build_tree(reader, {"memory"}, folder / "in.pct");
    const ConvertReport report = convert({folder / "in.pct"}, folder / "out.las");
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("times 65535"), std::string::npos) << report.notes[0];
    const auto back = open_reader(folder / "out.las");
    EXPECT_EQ(back->info().format, "LAS 1.2, point format 0");
    EXPECT_EQ(back->info().schema[0], schema[0]);
}

TEST(Exports, OptionsOfOneFormatAreRefusedByOthers)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::volume, 100, 1), Grid{});
    const auto refused = [&](const char* output, const std::function<void(WriteOptions&)>& set) {
        ConvertOptions options;
        set(options.write);
        options.overwrite = true;
        try {
            convert({folder / "in.las"}, folder / output, options);
            return std::string();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            return std::string(error.what());
        }
    };
    const auto version = [](WriteOptions& options) { options.las_version = 2; };
    const auto bits = [](WriteOptions& options) { options.colour_bits = 8; };
    const auto floats = [](WriteOptions& options) { options.float_positions = true; };
    EXPECT_EQ(refused("a.las", version), "");
    EXPECT_NE(refused("a.ply", version).find("a LAS version goes to .las and .laz"), std::string::npos);
    EXPECT_EQ(refused("a.ply", bits), "");
    EXPECT_EQ(refused("a.pcd", bits), "");
    EXPECT_NE(refused("a.las", bits).find(".pcd and .ply"), std::string::npos);
    EXPECT_EQ(refused("a.pcd", floats), "");
    EXPECT_NE(refused("a.pct", floats).find("float positions go to .pcd"), std::string::npos);
}

}  // namespace
