// The numbers that a conversion writes: decimals as people write them, grids that say what precision there is, and no
// grid that puts points on each other.

#include "pcm/build/builder.h"
#include "pcm/convert/convert.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class Numbers : public testing::Test {
protected:
    fs::path write(const std::string& name, const std::string& text) const
    {
        std::ofstream(folder_ / name) << text;
        return folder_ / name;
    }
    ConvertReport convert_to(const fs::path& from, const std::string& to, const ConvertOptions& given = {}) const
    {
        ConvertOptions options = given;
        options.memory_bytes = 64 << 20;
        options.overwrite = true;
        return convert({from}, folder_ / to, options);
    }
    // The first three columns of each line but the header, sorted.
    std::vector<std::string> lines(const std::string& name) const
    {
        std::ifstream file(folder_ / name);
        std::vector<std::string> all;
        for (std::string line; std::getline(file, line);) {
            if (line[0] == '#') continue;
            std::istringstream words(line);
            std::string x, y, z;
            words >> x >> y >> z;
            all.push_back(x + " " + y + " " + z);
        }
        std::sort(all.begin(), all.end());
        return all;
    }
    Grid grid_of(const std::string& name) const { return *open_reader(folder_ / name)->info().grid; }
    static bool notes_rounding(const ConvertReport& report)
    {
        return std::any_of(report.notes.begin(), report.notes.end(),
                           [](const std::string& note) { return note.find("round") != std::string::npos; });
    }
    const TemporaryFolder folder_;
};

const std::string decimals = "0.7 0.1 -0.007\n0.3 1.1 5000000.123\n-0.001 2.3 0.6\n100.5 0.9 12.125\n";
const std::vector<std::string> decimal_lines = {"-0.001 2.3 0.6", "0.3 1.1 5000000.123", "0.7 0.1 -0.007",
                                                "100.5 0.9 12.125"};

TEST_F(Numbers, ATreeOfDecimalsGivesThemBack)
{
    const fs::path in = write("in.xyz", decimals);
    EXPECT_EQ(convert_to(in, "t.pct").outcome.error, 0);
    EXPECT_EQ(convert_to(folder_ / "t.pct", "out.xyz").outcome.error, 0);
    EXPECT_EQ(lines("out.xyz"), decimal_lines);
    // From there on, too: through another tree, and in doubles.
    convert_to(folder_ / "t.pct", "again.pct");
    convert_to(folder_ / "again.pct", "again.ply");
    convert_to(folder_ / "again.ply", "again.xyz");
    EXPECT_EQ(lines("again.xyz"), decimal_lines);
}

TEST_F(Numbers, LasIsPrintedAsTheDecimalsThatItsIntegersAre)
{
    write_las(folder_ / "in.las", {{7, 1, -7, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {3, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}},
              Grid{{0.1, 0.1, 0.001}, {0, 500000, 0}});
    EXPECT_EQ(convert_to(folder_ / "in.las", "out.xyz").outcome.error, 0);
    EXPECT_EQ(lines("out.xyz"), (std::vector<std::string>{"0.3 500001.1 0", "0.7 500000.1 -0.007"}));
    convert_to(folder_ / "in.las", "t.pct");
    convert_to(folder_ / "t.pct", "out.pts");
    EXPECT_EQ(lines("out.pts").at(0), "0.3 500001.1 0");
}

// Files whose offsets differ are read as doubles near the first one's grid.
TEST_F(Numbers, SoAreFilesOfSeveralGrids)
{
    fs::create_directory(folder_ / "tiles");
    write_las(folder_ / "tiles/a.las", {{7, 1, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0}}, Grid{{0.1, 0.1, 0.1}, {0, 0, 0}});
    write_las(folder_ / "tiles/b.las", {{7, 1, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0}}, Grid{{0.1, 0.1, 0.1}, {1000, 0, 0}});
    convert_to(folder_ / "tiles", "out.xyz");
    EXPECT_EQ(lines("out.xyz"), (std::vector<std::string>{"0.7 0.1 0.3", "1000.7 0.1 0.3"}));
}

TEST_F(Numbers, ScaledAttributesAreDecimalsToo)
{
    Schema schema;
    schema.add({"angle", ScalarType::i16, 1, 0.006, 0, ""});
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 2, 1);
    cloud.points.attributes[0].as<std::int16_t>()[0] = 3;  // 3 * 0.006 is 0.018000000000000002 in double
    cloud.points.attributes[0].as<std::int16_t>()[1] = 17;
    write_cloud([&] { return std::make_unique<MemoryReader>(cloud); }, folder_ / "out.xyz", {});
    std::ifstream file(folder_ / "out.xyz");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NE(text.find(" 0.018\n"), std::string::npos) << text;
    EXPECT_NE(text.find(" 0.102\n"), std::string::npos) << text;
}

TEST_F(Numbers, RoundedToNothingIsZeroWithoutASign)
{
    const fs::path in = write("in.xyz", "-0.0004 0.0004 -0\n1 2 3\n");
    ConvertOptions options;
    options.write.decimals = 2;
    convert_to(in, "out.xyz", options);
    EXPECT_EQ(lines("out.xyz").at(0), "0.00 0.00 -0.00");  // the sign of the source's own zero stays
}

TEST_F(Numbers, StepsOfLasDoNotLookLikeAPrecision)
{
    std::string text;
    for (int i = 0; i < 50; ++i)
        text += std::to_string(10 * i) + " " + std::to_string(1000 * (i % 7)) + " " + std::to_string(i) + ".5\n";
    const ConvertReport report = convert_to(write("in.xyz", text), "out.las");
    EXPECT_EQ(grid_of("out.las").scale, (Vec3d{0.01, 0.01, 0.01}));
    EXPECT_EQ(report.outcome.error, 0);
    convert_to(folder_ / "out.las", "out.xyz");
    EXPECT_EQ(lines("out.xyz").at(1), "10 1000 1.5");
}

TEST_F(Numbers, OrdinaryMillimetresAreWorthNoNote)
{
    std::mt19937_64 random(1);
    std::string text;
    for (int i = 0; i < 2000; ++i)
        text += "500" + std::to_string(100 + random() % 900) + "." + std::to_string(100 + random() % 900) + " 4800" +
                std::to_string(100 + random() % 900) + ".057 " + std::to_string(random() % 90) + ".001\n";
    EXPECT_FALSE(notes_rounding(convert_to(write("in.xyz", text), "out.las")));
    EXPECT_EQ(grid_of("out.las").scale, (Vec3d{0.001, 0.001, 0.001}));
}

// Floats of some hundred units have a precision of 1e-5; steps of 1e-7 lose none of it.
TEST_F(Numbers, OnlyRoundingBeyondTheSourcesOwnPrecisionIsNoted)
{
    MemoryCloud cloud = random_cloud({}, std::nullopt, 5000, 2, 500);
    EXPECT_TRUE(
        notes_rounding(write_cloud([&] { return std::make_unique<MemoryReader>(cloud); }, folder_ / "d.las", {})));
    for (std::size_t a = 0; a < 3; ++a)
        for (double& v : cloud.points.xyz[a]) v = static_cast<double>(static_cast<float>(v));
    cloud.info.position_type = ScalarType::f32;
    const ConvertReport report =
        write_cloud([&] { return std::make_unique<MemoryReader>(cloud); }, folder_ / "f.las", {});
    EXPECT_FALSE(notes_rounding(report));
    EXPECT_GT(report.outcome.error, 0);
    EXPECT_LT(report.outcome.error, 1.6e-5);
}

TEST_F(Numbers, LasIsRefusedWhereFarPointsLeaveNoPrecision)
{
    std::string text;
    for (int i = 0; i < 900; ++i) text += std::to_string(i % 30) + ".123 " + std::to_string(i / 30) + ".456 7.891\n";
    for (const std::string value : {"3.4e38", "1e30", "1e300", "1e10"}) {
        const fs::path in = write("in.xyz", text + "1 2 " + value + "\n");
        try {
            convert_to(in, "out.las");
            ADD_FAILURE() << value << " was written";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            EXPECT_NE(std::string(error.what()).find("1 of 901 points"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("--largest-coordinate"), std::string::npos) << error.what();
        }
        EXPECT_FALSE(fs::exists(folder_ / "out.las"));
        ConvertOptions options;
        options.cloud.read.largest_coordinate = 1e6;
        const ConvertReport report = convert_to(in, "limited.las", options);
        EXPECT_EQ(report.outcome.points_in, 901u);
        EXPECT_EQ(report.outcome.points_out, 900u);
        EXPECT_EQ(report.points_skipped, 1u);
        EXPECT_EQ(grid_of("limited.las").scale, (Vec3d{0.001, 0.001, 0.001}));
        // Formats of doubles hold them all.
        EXPECT_EQ(convert_to(in, "out.ply").outcome.points_out, 901u);
    }
    // Rounding that leaves neighbours apart is only noted.
    std::string irregular;
    for (int i = 0; i < 900; ++i) irregular += std::to_string(std::sqrt(i)) + "1234567 " + std::to_string(i) + " 0\n";
    EXPECT_TRUE(notes_rounding(convert_to(write("in.xyz", irregular + "1000000 0 0\n"), "noted.las")));
}

TEST_F(Numbers, TheLimitHoldsForTreesToo)
{
    convert_to(write("in.xyz", "1 2 3\n4 5 6\n7 8 1e7\n"), "t.pct");
    ConvertOptions options;
    options.cloud.read.largest_coordinate = 1000;
    const ConvertReport report = convert_to(folder_ / "t.pct", "out.xyz", options);
    EXPECT_EQ(report.points_skipped, 1u);
    EXPECT_EQ(lines("out.xyz"), (std::vector<std::string>{"1 2 3", "4 5 6"}));
}

}  // namespace
