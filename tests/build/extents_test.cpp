// Clouds of any magnitude, and points far from the others: a tree that opens and returns what it was given, or an error
// that leaves everything as it was.

#include "pcm/build/build_folder.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/tree/verify.h"
#include "pcm/update/tree_update.h"
#include "tests/build/build_support.h"
#include "tests/memory_reader.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <cmath>
#include <fstream>
#include <limits>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

constexpr std::size_t cloud_points = 3000;

enum class Kind { doubles, floats, grid, near_grid };

// Coordinates are multiples of 2^(k - 20), or of the least double, below 2^k: exact in floats and doubles of every
// magnitude.
MemoryCloud cloud_of(Kind kind, int k)
{
    std::mt19937_64 random(7);
    const double step = std::ldexp(1.0, std::max(k - 20, -1074));
    MemoryCloud cloud;
    cloud.info.points = cloud_points;
    cloud.info.schema.add({"tag", ScalarType::u32});
    if (kind == Kind::grid) cloud.info.grid = Grid{{step, step, step}, {0, 0, 0}};
    if (kind == Kind::near_grid) cloud.info.near_grid = Grid{{step, step, step}, {0, 0, 0}};
    cloud.info.position_type = kind == Kind::grid     ? ScalarType::i32
                               : kind == Kind::floats ? ScalarType::f32
                                                      : ScalarType::f64;
    cloud.points.reset(cloud.info.schema, kind == Kind::grid, cloud_points);
    for (std::size_t i = 0; i < cloud_points; ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
            const auto q = static_cast<std::int32_t>(random() % 0x1fffff) - 0xfffff;
            if (kind == Kind::grid)
                cloud.points.grid_xyz[a][i] = q;
            else
                cloud.points.xyz[a][i] = static_cast<double>(q) * step;
        }
        cloud.points.attributes[0].as<std::uint32_t>()[i] = static_cast<std::uint32_t>(i);
    }
    return cloud;
}

// Each point's coordinates, by its tag.
std::vector<Vec3d> positions_by_tag(const MemoryCloud& cloud, std::size_t count = cloud_points)
{
    std::vector<Vec3d> positions(count, Vec3d{-1e9, -1e9, -1e9});
    for (std::size_t i = 0; i < cloud.points.size; ++i)
        positions.at(cloud.points.attributes[0].as<std::uint32_t>()[i]) = position_of(cloud.points, cloud.info.grid, i);
    return positions;
}

class Extents : public testing::Test {
protected:
    void SetUp() override
    {
        make(cloud_of(Kind::grid, 10));
        old_ = contents(path_);
    }
    BuildReport make(const MemoryCloud& cloud)
    {
        MemoryReader reader(cloud);
        BuildOptions options = small_chunks();
        options.overwrite = true;
        return build_tree(reader, {}, path_, options);
    }
    MemoryCloud read() const
    {
        TreeReader reader(Tree::open(path_), std::nullopt, {});
        return read_all(reader);
    }
    // Empty when the tree was built; else what the error says.
    std::string refusal(const MemoryCloud& cloud)
    {
        try {
            make(cloud);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << error.what();
            EXPECT_EQ(contents(path_), old_) << error.what();
            EXPECT_EQ(names_in(folder_.path()), std::vector<std::string>{"tree.pct"}) << error.what();
            return error.what();
        }
        return {};
    }
    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct";
    Contents old_;
};

// Not under the thread sanitizer: all of it runs in one thread.
TEST_F(Extents, PCM_NOT_UNDER_THREAD(ATreeOfAnyMagnitudeReturnsItsPointsOrIsRefused))
{
    for (const Kind kind : {Kind::doubles, Kind::floats, Kind::grid, Kind::near_grid})
        for (int k = -1070; k <= 1020; k += 38) {
            if (kind == Kind::floats && (k < -120 || k > 127)) continue;
            SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)) + ", 2^" + std::to_string(k));
            const MemoryCloud cloud = cloud_of(kind, k);
            const std::string refused = refusal(cloud);
            if (!refused.empty()) {
                EXPECT_TRUE(k < -450 || k > 480) << refused;
                continue;
            }
            EXPECT_TRUE(k > -500 && k <= 500);
            EXPECT_TRUE(verify_tree(path_, {}).faults.empty());
            const double error = Tree::open(path_)->info().position_error;
            const std::vector<Vec3d> before = positions_by_tag(cloud), after = positions_by_tag(read());
            if (error == 0) EXPECT_EQ(after, before);
            for (std::size_t i = 0; i < before.size(); ++i)
                for (std::size_t a = 0; a < 3; ++a) ASSERT_LE(std::fabs(after[i][a] - before[i][a]), error);
            // Rounded only where the steps of trees end.
            if (k > -450) EXPECT_EQ(error, 0);
            make(cloud_of(Kind::grid, 10));
            old_ = contents(path_);
        }
}

TEST_F(Extents, PointsAtOnePlaceOfAnyMagnitude)
{
    for (const double value : {0.0, 1.0, -1e-300, 5e-324, 1e-148, 1e-20, 1e150})
        for (const std::size_t count : {1u, 5u}) {
            MemoryCloud cloud = cloud_of(Kind::doubles, 0);
            cloud.info.points = count;
            cloud.points.resize(count);
            for (std::size_t a = 0; a < 3; ++a)
                std::fill(cloud.points.xyz[a].begin(), cloud.points.xyz[a].end(), value);
            EXPECT_EQ(refusal(cloud), "") << value;
            EXPECT_TRUE(verify_tree(path_, {}).faults.empty()) << value;
            EXPECT_EQ(read().points.size, count);
        }
}

// No-data values in a cloud of doubles or floats.
class NoData : public Extents {
protected:
    static MemoryCloud with(Kind kind, double value, std::size_t odd)
    {
        MemoryCloud cloud = cloud_of(kind, 7);
        for (std::size_t i = 0; i < odd; ++i) cloud.points.xyz[2][i * (cloud_points / odd)] = value;
        return cloud;
    }
};

TEST_F(NoData, NeverPutTheOtherPointsOnOnePlace)
{
    for (const Kind kind : {Kind::doubles, Kind::floats})
        for (const double value :
             {static_cast<double>(3.4e38f), static_cast<double>(1e30f), -static_cast<double>(1e20f), 1e300})
            for (const std::size_t odd : {1u, 150u, 1500u}) {
                if (kind == Kind::floats && value > 3.5e38) continue;
                const MemoryCloud cloud = with(kind, value, odd);
                const std::string refused = refusal(cloud);
                EXPECT_NE(refused.find((odd == 1     ? "1"
                                        : odd == 150 ? "150"
                                                     : "1,500") +
                                       std::string(" of 3,000 points")),
                          std::string::npos)
                    << refused;
                EXPECT_NE(refused.find("--largest-coordinate"), std::string::npos) << refused;
            }
}

TEST_F(NoData, OrdinaryNumbersStay)
{
    for (const double value : {-9999.0, 1e6, 1e9}) {
        const MemoryCloud cloud = with(Kind::doubles, value, 100);
        ASSERT_EQ(refusal(cloud), "") << value;
        EXPECT_EQ(positions_by_tag(read()), positions_by_tag(cloud)) << value;
    }
}

TEST_F(NoData, AreLeftOutByNameAndTheOthersKeepAllBits)
{
    std::ofstream text(folder_ / "in.xyz");
    text << "50 50 3.4e38\n";
    for (int i = 1; i < 3000; ++i)
        text << i % 100 << "." << i % 7 << " " << i / 100 << ".25 " << (i % 13) / 10.0 << "\n";
    text << "1 1 nan\n";
    text.close();
    BuildOptions options = small_chunks();
    const fs::path tree = folder_ / "of text.pct";
    try {
        build_tree({folder_ / "in.xyz"}, tree, options);
        FAIL() << "built";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("50 50 3.4e+38"), std::string::npos) << error.what();
    }
    options.read.largest_coordinate = 1000;
    const BuildReport report = build_tree({folder_ / "in.xyz"}, tree, options);
    EXPECT_EQ(report.outcome.points_in, 3001u);
    EXPECT_EQ(report.outcome.points_out, 2999u);
    EXPECT_EQ(report.points_skipped, 2u);
    EXPECT_EQ(report.outcome.error, 0);
    EXPECT_TRUE(std::any_of(report.notes.begin(), report.notes.end(), [](const std::string& note) {
        return note.find("1 point with a coordinate beyond 1000 was left out, the first at 50 50 3.4e+38") == 0;
    }));
    EXPECT_EQ(Tree::open(tree)->info().points_skipped, 2u);
    EXPECT_TRUE(verify_tree(tree, {}).faults.empty());
}

// Decimals smaller than the largest coordinate by many powers of ten come back bit for bit.
TEST_F(Extents, DecimalsComeBackBitForBit)
{
    MemoryCloud cloud = cloud_of(Kind::doubles, 0);
    std::mt19937_64 random(3);
    for (std::size_t i = 0; i < cloud_points; ++i) {
        cloud.points.xyz[0][i] = static_cast<double>(random() % 100000000) / 1000;
        cloud.points.xyz[1][i] = static_cast<double>(static_cast<std::int64_t>(random() % 2000) - 1000) / 1e6;
        cloud.points.xyz[2][i] =
            i == 0 ? -9999.0 : static_cast<double>(static_cast<std::int64_t>(random() % 200) - 100) / 1e4;
    }
    cloud.points.xyz[2][1] = -0.007;
    EXPECT_EQ(make(cloud).outcome.error, 0);
    EXPECT_EQ(positions_by_tag(read()), positions_by_tag(cloud));
    EXPECT_TRUE(TreeReader(Tree::open(path_), std::nullopt, {}).info().metadata.empty());

    // Numbers that are not decimals are rounded, and the outcome has the error.
    cloud.points.xyz[2][1] = -0.007000000000000117;
    const double error = make(cloud).outcome.error;
    EXPECT_GT(error, 0);
    EXPECT_LT(error, 1e-14);
    const std::vector<Vec3d> before = positions_by_tag(cloud), after = positions_by_tag(read());
    for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(after[i][0], before[i][0]);
        EXPECT_EQ(after[i][1], before[i][1]);
        EXPECT_LE(std::fabs(after[i][2] - before[i][2]), error);
    }
}

// A block of that name in a file means nothing.
TEST_F(Extents, ForeignBlocksDoNotRound)
{
    MemoryCloud cloud = cloud_of(Kind::doubles, 0);
    const std::string text = "0 0 0";
    Metadata block{"pcm.decimals", {}};
    for (const char c : text) block.value.push_back(static_cast<std::byte>(c));
    cloud.info.metadata.push_back(block);
    make(cloud);
    EXPECT_EQ(positions_by_tag(read()), positions_by_tag(cloud));
}

// Whatever makes a tree, it does not take the name of a good one before it can be opened.
TEST_F(Extents, ATreeThatCannotBeOpenedIsNotPublished)
{
    {
        BuildFolder folder(path_, true);
        for (const auto& [name, bytes] : old_)
            std::ofstream(folder.tree() / name, std::ios::binary)
                << (name == index_file_name ? bytes.substr(0, bytes.size() - 9) + "damaged.." : bytes);
        EXPECT_THROW(folder.publish(), Error);
    }
    EXPECT_EQ(contents(path_), old_);
    {
        BuildFolder folder(path_, true);
        for (const auto& [name, bytes] : old_)
            if (name.find("chunks") == std::string::npos)
                std::ofstream(folder.tree() / name, std::ios::binary) << bytes;  // and no chunks
        EXPECT_THROW(folder.publish(), Error);
    }
    EXPECT_EQ(contents(path_), old_);
    {
        TreeUpdate update(path_);
        TreeInfo info = update.tree()->info();
        NodeVector joined = join_parts(part_nodes(*update.tree()), info.spacings, info.grid.scale);
        info.spacings[0] = std::numeric_limits<double>::quiet_NaN();
        EXPECT_THROW(update.commit(info, joined), Error);
    }
    Contents now = contents(path_);
    now.erase("lock");
    old_.erase("lock");
    EXPECT_EQ(now, old_);
    EXPECT_EQ(read().points.size, cloud_points);
}

}  // namespace
