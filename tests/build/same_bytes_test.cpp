// The bytes of a tree are those of its cloud: neither the memory nor the number of threads changes one of them.

#include "tests/build/build_support.h"
#include "tests/build/schema_of.h"
#include "tests/clouds.h"
#include "tests/memory_reader.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <functional>

namespace pcm {
namespace {

using namespace test;
namespace fs = std::filesystem;

constexpr std::size_t many_points = 120'000;  // some forty bins of chunks of 1000

// Builds `out.pct` in `folder` with each memory and number of threads, sampled in both ways, and compares all files.
void expect_same_bytes(const fs::path& folder, const std::function<void(const fs::path&, const BuildOptions&)>& build)
{
    for (const Sampling sampling : {Sampling::poisson, Sampling::grid}) {
        Contents first;
        for (const auto& [megabytes, threads] :
             {std::pair<std::uint64_t, unsigned>{64, 1}, {64, 7}, {300, 2}, {4096, 3}}) {
            BuildOptions options = small_chunks();
            options.memory_bytes = megabytes << 20;
            options.threads = threads;
            options.sampling = sampling;
            options.overwrite = true;
            build(folder / "out.pct", options);
            const Contents files = contents(folder / "out.pct");
            if (first.empty()) first = files;
            EXPECT_TRUE(files == first) << megabytes << " MiB, " << threads << " threads, "
                                        << (sampling == Sampling::grid ? "by grid" : "by distance");
        }
    }
}

void expect_same_bytes_of_files(const fs::path& folder, const std::vector<fs::path>& inputs)
{
    expect_same_bytes(folder, [&](const fs::path& output, const BuildOptions& options) {
        BuildOptions all = options;
        all.read.threads = options.threads;
        build_tree(inputs, output, all);
    });
}

std::vector<LasRecord> cloud(Shape shape) { return records(shape, tries<std::size_t>(many_points, 30000), 6); }

// Half of the points in a ten-thousandth of the area.
std::vector<LasRecord> with_a_clump()
{
    auto points = cloud(Shape::surface);
    for (std::size_t i = 0; i < points.size(); i += 2)
        for (std::int32_t* c : {&points[i].x, &points[i].y, &points[i].z}) *c = *c / 100 + 5000;
    return points;
}

class SameBytes : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Build, SameBytes,
                         testing::Values(Shape::surface, Shape::volume, Shape::line, Shape::coincident,
                                         Shape::duplicates, Shape::clusters, Shape::full_range),
                         [](const auto& info) { return name(info.param); });

TEST_P(SameBytes, ForAnyMemoryAndNumberOfThreads)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", cloud(GetParam()), {});
    expect_same_bytes_of_files(folder.path(), {folder / "in.las"});
}

TEST(SameBytes, OfADenseClump)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", with_a_clump(), {});
    expect_same_bytes_of_files(folder.path(), {folder / "in.las"});
}

// Integers are kept, whether the offset is one for all or each tile has its own.
TEST(SameBytes, OfTiles)
{
    for (const double apart : {0.0, 0.5}) {
        SCOPED_TRACE(apart);
        const TemporaryFolder folder;
        const auto points = cloud(Shape::surface);
        std::vector<fs::path> tiles;
        for (std::size_t from = 0; from < points.size(); from += points.size() / 5) {
            tiles.push_back(folder / ("tile" + std::to_string(tiles.size()) + ".las"));
            const double offset = apart * static_cast<double>(tiles.size());
            const auto end =
                points.begin() + static_cast<std::ptrdiff_t>(std::min(points.size(), from + points.size() / 5));
            write_las(tiles.back(), {points.begin() + static_cast<std::ptrdiff_t>(from), end},
                      Grid{{0.01, 0.01, 0.01}, {offset, offset, 0}});
        }
        expect_same_bytes_of_files(folder.path(), tiles);
    }
}

TEST(SameBytes, OfDoubles)
{
    const TemporaryFolder folder;
    std::vector<std::array<double, 3>> points;
    for (const LasRecord& p : with_a_clump()) points.push_back({p.x / 7.0, p.y / 11.0, p.z / 13.0});
    write_ply(folder / "in.ply", points);
    expect_same_bytes_of_files(folder.path(), {folder / "in.ply"});
}

// Points too far from each other for integers of 32 bits on one grid, which headers do not show: all goes through
// doubles.
TEST(SameBytes, OfTilesWithWrongHeaders)
{
    const TemporaryFolder folder;
    const auto points = cloud(Shape::full_range);
    write_las(folder / "a.las", points, Grid{{0.01, 0.01, 0.01}, {0, 0, 0}});
    write_las(folder / "b.las", points, Grid{{0.01, 0.01, 0.01}, {5000, 0, 0}});
    expect_same_bytes_of_files(folder.path(), {folder / "a.las", folder / "b.las"});
    EXPECT_TRUE(Tree::open(folder / "out.pct")->info().wide);
    EXPECT_EQ(Tree::open(folder / "out.pct")->info().points, 2 * points.size());
}

// As LAZ is: on a grid, and read in order.
TEST(SameBytes, OfAReaderThatCannotSeek)
{
    const TemporaryFolder folder;
    const Schema schema = schema_of({{ScalarType::u16, 1}, {ScalarType::u8, 3}});
    const MemoryCloud points =
        random_cloud(schema, Grid{{0.001, 0.001, 0.001}, {0, 0, 0}}, tries<std::size_t>(many_points, 30000), 9);
    expect_same_bytes(folder.path(), [&](const fs::path& output, const BuildOptions& options) {
        MemoryReader reader(points, false);
        build_tree(reader, {"memory"}, output, options);
    });
}

}  // namespace
}  // namespace pcm
