// The neighbourhoods of all points against a comparison of each point with all others, in double on exact differences.
#include "pcm/knn/neighbourhoods.h"

#include "pcm/build/builder.h"
#include "pcm/knn/point_search.h"
#include "pcm/system/error.h"
#include "pcm/update/append.h"
#include "tests/memory_reader.h"
#include "tests/outcome.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <random>
#include <set>

namespace pcm::test {
namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
struct Found {
    std::vector<double> squares;
    std::vector<Vec3d> offsets;
};
using All = std::map<PointPlace, Found>;
// Grid positions, by node and index.
using Positions = std::vector<std::vector<Vec3i>>;

Positions positions_of(const Tree& tree)
{
    Positions all(tree.nodes().size());
    for (NodeId id = 0; id < all.size(); ++id) {
        const Chunk chunk = tree.read_chunk(id, ColumnSet::only_positions());
        for (std::uint32_t i = 0; i < chunk.points; ++i) all[id].push_back(chunk.positions->grid(i));
    }
    return all;
}

class Collector final : public NeighbourhoodVisitor {
public:
    Collector(All& all, std::mutex& mutex, const Grid& grid, const Positions& positions)
        : all_(all), mutex_(mutex), grid_(grid), positions_(positions)
    {
    }
    void begin(const NeighbourhoodUnit& unit) override
    {
        of_unit_.clear();
        for (std::uint32_t i = 0; i < unit.points; ++i) of_unit_.insert(unit.place_of(i));
        ASSERT_EQ(of_unit_.size(), unit.points);
    }
    void visit(const NeighbourhoodUnit& unit, const Neighbourhoods& some) override
    {
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < some.size(); ++i) {
            Found found;
            for (std::size_t j = 0; j < some.count(i); ++j) {
                found.squares.push_back(some.squared(i)[j]);
                found.offsets.push_back({some.dx(i)[j], some.dy(i)[j], some.dz(i)[j]});
            }
            expect_right_numbers(unit, some, i);
            const bool first = all_.emplace(unit.place_of(some.number(i)), found).second;
            EXPECT_TRUE(first) << "a point was visited twice";
        }
    }

private:
    // A number is that of another point where the neighbour is; one of the unit where it is below unit.points.
    void expect_right_numbers(const NeighbourhoodUnit& unit, const Neighbourhoods& some, std::size_t i) const
    {
        const auto at = [&](const PointPlace& place) { return positions_[place.node][place.index]; };
        const PointPlace own = unit.place_of(some.number(i));
        ASSERT_TRUE(of_unit_.count(own));
        for (std::size_t j = 0; j < some.count(i); ++j) {
            const std::array<double, 3> offset{some.dx(i)[j], some.dy(i)[j], some.dz(i)[j]};
            const std::uint32_t number = some.neighbours(i)[j];
            const PointPlace there = unit.place_of(number);
            ASSERT_EQ(of_unit_.count(there), number < unit.points);
            ASSERT_FALSE(there == own);
            for (std::size_t a = 0; a < 3; ++a)
                ASSERT_EQ(static_cast<double>(at(there)[a] - at(own)[a]) * grid_.scale[a], offset[a]);
        }
    }

    All& all_;
    std::mutex& mutex_;
    const Grid& grid_;
    const Positions& positions_;
    std::set<PointPlace> of_unit_;
};

All all_of(L2Cache& cache, NeighbourhoodOptions options, NeighbourhoodReport* report = nullptr)
{
    All all;
    options.numbers = true;
    const Grid& grid = cache.tree().info().grid;
    const Positions positions = positions_of(cache.tree());
    std::mutex mutex;
    const Stopwatch watch;
    const auto made = for_each_neighbourhood(cache, options,
                                             [&] { return std::make_unique<Collector>(all, mutex, grid, positions); });
    if (report) *report = made;
    expect_outcome(made.outcome, cache.tree().info().points, all.size(), watch);
    return all;
}

struct Point {
    PointPlace place;
    Vec3i grid;
    std::uint16_t level;
};

std::vector<Point> points_of(const Tree& tree)
{
    std::vector<Point> points;
    for (NodeId id = 0; id < tree.nodes().size(); ++id) {
        const Node& node = tree.node(id);
        const Chunk chunk = tree.read_chunk(id, ColumnSet::only_positions());
        for (std::uint32_t i = 0; i < chunk.points; ++i) {
            std::uint16_t level = node.first_level;
            while (node.points_to_level(level) <= i) ++level;
            points.push_back({{id, i}, chunk.positions->grid(i), level});
        }
    }
    return points;
}

// The square of the distance, and the offset: what neighbours are ordered by.
std::pair<double, Vec3d> seen_from(const Grid& grid, const Vec3i& a, const Vec3i& b)
{
    Vec3d d;
    for (std::size_t axis = 0; axis < 3; ++axis) d[axis] = double(b[axis] - a[axis]) * grid.scale[axis];
    return {(d[0] * d[0] + d[1] * d[1]) + d[2] * d[2], d};
}

// Holds all points against the search for single points, whose distances are between rounded source coordinates.
void expect_near(const std::shared_ptr<const Tree>& tree, const All& all, const NeighbourhoodOptions& options)
{
    L2Cache cache(tree);
    BlockCache blocks;
    PointSearch search(cache, blocks);
    const Grid& grid = tree->info().grid;
    const double rounding = 1e-15 * std::max(length(tree->info().bounds().min), length(tree->info().bounds().max));
    std::vector<Neighbour> near;
    for (const Point& point : points_of(*tree)) {
        const auto found = all.find(point.place);
        if (found == all.end()) continue;
        search.run(grid.to_source(point.grid), options.neighbours + 1, near);
        const auto self = std::find_if(near.begin(), near.end(), [&](const Neighbour& n) {
            return PointPlace{n.node, n.index} == point.place;
        });
        if (self != near.end()) near.erase(self);
        near.resize(std::min(near.size(), options.neighbours));
        ASSERT_LE(found->second.squares.size(), near.size());
        if (found->second.squares.size() < near.size()) {
            ASSERT_GE(near[found->second.squares.size()].distance(), options.max_distance - rounding);
        }
        for (std::size_t j = 0; j < found->second.squares.size(); ++j)
            ASSERT_NEAR(std::sqrt(found->second.squares[j]), near[j].distance(), rounding) << j;
    }
}

// Compares about `some` of the points with all others.
void expect_right(const Tree& tree, const All& all, const NeighbourhoodOptions& options, std::size_t some = 400)
{
    const std::vector<Point> points = points_of(tree);
    const double limit = options.max_distance * options.max_distance;
    std::size_t computed = 0, tried = 0;
    const std::size_t step = points.size() / (some + 1) + 1;
    for (std::size_t p = 0; p < points.size(); ++p) {
        const auto found = all.find(points[p].place);
        if (found == all.end()) continue;
        ++computed;
        if (p % step) continue;
        ++tried;
        std::vector<std::pair<double, Vec3d>> nearest;
        for (std::size_t q = 0; q < points.size(); ++q) {
            const auto seen = seen_from(tree.info().grid, points[p].grid, points[q].grid);
            if (q != p && seen.first <= limit) nearest.push_back(seen);
        }
        const std::size_t k = std::min(options.neighbours, nearest.size());
        std::partial_sort(nearest.begin(), nearest.begin() + std::ptrdiff_t(k), nearest.end());
        ASSERT_EQ(found->second.squares.size(), k) << "point " << p;
        for (std::size_t j = 0; j < k; ++j) {
            ASSERT_EQ(found->second.squares[j], nearest[j].first) << "point " << p;
            ASSERT_EQ(found->second.offsets[j], nearest[j].second) << "point " << p;
        }
    }
    EXPECT_EQ(computed, all.size());
    EXPECT_TRUE(points.empty() || tried > 0);
}

using Shape = std::function<Vec3d(std::mt19937_64&, std::size_t)>;

MemoryCloud cloud_of(std::size_t count, const std::optional<Grid>& grid, const Shape& shape, std::uint64_t seed = 1)
{
    MemoryCloud cloud = random_cloud(Schema(), grid, count, seed, 1);
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d p = shape(random, i);
        for (std::size_t a = 0; a < 3; ++a) {
            if (grid)
                cloud.points.grid_xyz[a][i] =
                    static_cast<std::int32_t>(std::llround((p[a] - grid->offset[a]) / grid->scale[a]));
            else
                cloud.points.xyz[a][i] = p[a];
        }
    }
    return cloud;
}

double uniform(std::mt19937_64& random) { return double(random() >> 11) * 0x1p-53; }

class NeighbourhoodsOf : public testing::Test {
protected:
    std::shared_ptr<const Tree> tree(const MemoryCloud& cloud, std::uint32_t chunk_points = 1000)
    {
        MemoryReader reader(cloud);
        BuildOptions build;
        build.chunk_points = chunk_points;
        build.overwrite = true;
        build_tree(reader, {"memory"}, folder_.path() / "cloud.pct", build);
        return Tree::open(folder_.path() / "cloud.pct");
    }
    void expect_right_for(const MemoryCloud& cloud, std::size_t k, double max_distance = infinity)
    {
        const auto opened = tree(cloud);
        L2Cache cache(opened);
        NeighbourhoodOptions options;
        options.neighbours = k;
        options.max_distance = max_distance;
        options.unit_points = unit_points_;
        const All all = all_of(cache, options, &report_);
        EXPECT_EQ(all.size(), opened->info().points);
        expect_right(*opened, all, options, some_);
        expect_near(opened, all, options);
    }

    TemporaryFolder folder_;
    NeighbourhoodReport report_;
    std::uint64_t unit_points_ = 10000;  // many units
    std::size_t some_ = 400;             // points to compare with all others
};

const Grid millimetres{{0.001, 0.001, 0.001}, {500000, 4800000, 100}};

// Not under the thread sanitizer: its threads are those that other tests of the room watch; so below.
TEST_F(NeighbourhoodsOf, PCM_NOT_UNDER_THREAD(ASurfaceInManyUnits))
{
    const auto surface = [](std::mt19937_64& random, std::size_t) {
        const double x = 30 * uniform(random), y = 30 * uniform(random);
        return Vec3d{500000 + x, 4800000 + y, 100 + std::sin(x) + 0.01 * uniform(random)};
    };
    expect_right_for(cloud_of(45000, millimetres, surface), 16);
    EXPECT_GT(report_.units, 3u);
    EXPECT_LT(report_.alone, 1000u);
    expect_right_for(cloud_of(45000, millimetres, surface), 5, 0.15);
    expect_right_for(cloud_of(45000, std::nullopt, surface), 9);
}

TEST_F(NeighbourhoodsOf, PCM_NOT_UNDER_THREAD(AVolumeOfDoubles))
{
    expect_right_for(cloud_of(25000, std::nullopt,
                              [](std::mt19937_64& random, std::size_t) {
                                  return Vec3d{1e-6 * uniform(random), 1e-6 * uniform(random), 1e-6 * uniform(random)};
                              }),
                     8);
    EXPECT_GT(report_.units, 1u);
}

TEST_F(NeighbourhoodsOf, PCM_NOT_UNDER_THREAD(ClustersFarApartAndStrays))
{
    expect_right_for(cloud_of(25000, std::nullopt,
                              [](std::mt19937_64& random, std::size_t i) {
                                  const double far = i % 2500 == 7 ? 1e9 * uniform(random) : i % 2 ? 0 : 3e5;
                                  return Vec3d{far + uniform(random), uniform(random), uniform(random)};
                              }),
                     16);
    EXPECT_GT(report_.units, 1u);
}

TEST_F(NeighbourhoodsOf, PCM_NOT_UNDER_THREAD(DenseBesideSparse))
{
    expect_right_for(cloud_of(30000, millimetres,
                              [](std::mt19937_64& random, std::size_t i) {
                                  const double size = i % 30 ? 1 : 300;
                                  return Vec3d{500000 + size * uniform(random), 4800000 + size * uniform(random), 100};
                              }),
                     16);
}

TEST_F(NeighbourhoodsOf, PCM_NOT_UNDER_THREAD(AGridALineAndManyAtOnePlace))
{
    expect_right_for(cloud_of(22500, millimetres,
                              [](std::mt19937_64&, std::size_t i) {
                                  return Vec3d{500000 + 0.1 * double(i % 150), 4800000 + 0.1 * double(i / 150), 100};
                              }),
                     12);
    expect_right_for(cloud_of(20000, millimetres,
                              [](std::mt19937_64&, std::size_t i) {
                                  return Vec3d{500000 + 0.01 * double(i), 4800000, 100};
                              }),
                     7);
    expect_right_for(cloud_of(12000, millimetres,
                              [](std::mt19937_64&, std::size_t i) {
                                  return Vec3d{500000 + (i < 9000 ? 1 : 0.001 * double(i % 1000)), 4800000, 100};
                              }),
                     16);
}

TEST_F(NeighbourhoodsOf, FewPoints)
{
    const auto anywhere = [](std::mt19937_64& random, std::size_t) {
        return Vec3d{uniform(random), uniform(random), uniform(random)};
    };
    for (const std::size_t count : {0u, 1u, 2u, 5u, 17u}) {
        expect_right_for(cloud_of(count, std::nullopt, anywhere), 16);
        expect_right_for(cloud_of(count, std::nullopt, anywhere), most_neighbours);
    }
}

TEST_F(NeighbourhoodsOf, PCM_NOT_UNDER_THREAD(ATreeOfSeveralParts))
{
    const auto part = [](double x) {
        return [x](std::mt19937_64& random, std::size_t) {
            return Vec3d{500000 + x + 4 * uniform(random), 4800000 + 4 * uniform(random), 100};
        };
    };
    const auto first = cloud_of(9000, millimetres, part(0)), second = cloud_of(9000, millimetres, part(2), 2);
    tree(first);
    MemoryReader reader(second);
    append_points(folder_.path() / "cloud.pct", reader, {"second"});
    const auto opened = Tree::open(folder_.path() / "cloud.pct");
    ASSERT_EQ(opened->part_roots().size(), 2u);
    L2Cache cache(opened);
    NeighbourhoodOptions options;
    options.unit_points = unit_points_;
    const All all = all_of(cache, options);
    EXPECT_EQ(all.size(), 18000u);
    expect_right(*opened, all, options);
    expect_near(opened, all, options);
}

// All points against all others: in small units most lie near a border, where what counts is how far the points around
// were loaded.
// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(NeighbourhoodsOf, PCM_NOT_UNDER_SANITIZERS(AtTheBordersOfSmallUnits))
{
    const Grid coarse{{0.25, 0.25, 0.25}, {500000, 4800000, 100}};
    const auto ball = [](std::mt19937_64& random, std::size_t) {
        return Vec3d{500000 + 9 * uniform(random), 4800000 + 9 * uniform(random), 100 + 9 * uniform(random)};
    };
    const auto sheet = [](std::mt19937_64& random, std::size_t) {
        const double x = 30 * uniform(random) * uniform(random);  // denser to one side
        return Vec3d{500000 + x, 4800000 + 30 * uniform(random), 100 + 0.1 * x * x};
    };
    some_ = 1 << 20;
    for (const std::uint64_t points : {60, 400}) {
        unit_points_ = points;
        for (const std::size_t k : {1, 6, 16}) {
            SCOPED_TRACE(std::to_string(points) + " " + std::to_string(k));
            expect_right_for(cloud_of(3000, millimetres, ball), k);
            EXPECT_GT(report_.units, 3000 / points / 2);
            expect_right_for(cloud_of(3000, millimetres, sheet), k);
            expect_right_for(cloud_of(3000, coarse, ball), k);  // a step is not nothing here
            expect_right_for(cloud_of(3000, std::nullopt, ball), k, 0.7);
        }
    }
}

// Distances along an axis of 2^30 steps and more, in a unit: from a cluster that has too few points for its own.
TEST_F(NeighbourhoodsOf, MoreStepsThan32BitsHold)
{
    some_ = 1 << 20;
    for (const double far : {0x1p29, 0x1p30, 1.5 * 0x1p30, 0x1p31, 1.5 * 0x1p31, 0x1p32}) {
        SCOPED_TRACE(far);
        const Grid steps{{1, 1, 1}, {0, 0, 0}};
        for (std::size_t axis = 0; axis < 3; ++axis)
            expect_right_for(cloud_of(60, steps,
                                      [&](std::mt19937_64& random, std::size_t i) {
                                          Vec3d p{9 * uniform(random), 9 * uniform(random), 9 * uniform(random)};
                                          if (i == 1) p[axis] = 0;
                                          p[axis] = std::min(p[axis] + (i % 6 == 0 ? far : 0) - 0x1p31, 0x1p31 - 1);
                                          return p;
                                      }),
                             16);
    }
    for (const double far : {0x1p33, 0x1p34, 0x1p40, 0x1p50}) {
        SCOPED_TRACE(far);
        expect_right_for(cloud_of(60, std::nullopt,
                                  [&](std::mt19937_64& random, std::size_t i) {
                                      return Vec3d{std::floor(9 * uniform(random)) + (i % 6 == 0 ? far : 0),
                                                   std::floor(9 * uniform(random)), std::floor(9 * uniform(random))};
                                  }),
                         16);
    }
}

TEST_F(NeighbourhoodsOf, TiesAreOrderedByPlaceWhateverTheUnitsAndThreads)
{
    const auto lattice = [](double step, std::size_t copies) {
        return [=](std::mt19937_64&, std::size_t i) {
            i /= copies;
            return Vec3d{500000 + step * double(i % 15), 4800000 + step * double(i / 15 % 15),
                         100 + step * double(i / 225)};
        };
    };
    // Steps whose squares single precision holds, and others.
    const std::vector<MemoryCloud> clouds{
        cloud_of(3375, millimetres, lattice(0.1, 1)), cloud_of(3375, millimetres, lattice(30.001, 1)),
        cloud_of(3375, Grid{{0.001, 0.002, 0.0005}, {500000, 4800000, 100}}, lattice(0.1, 1)),
        cloud_of(3375, millimetres, lattice(0.1, 5)), cloud_of(3375, std::nullopt, lattice(0.1, 1)),
        // A place with more points than any search asks for at first.
        cloud_of(3000, millimetres, [](std::mt19937_64& random, std::size_t i) {
            return i % 2 ? Vec3d{500005, 4800005, 100}
                         : Vec3d{500000 + std::floor(10 * uniform(random)), 4800000 + std::floor(10 * uniform(random)),
                                 100 + std::floor(3 * uniform(random))};
        })};
    for (const MemoryCloud& cloud : clouds) {
        const auto opened = tree(cloud);
        for (const double max_distance : {infinity, 0.2}) {
            L2Cache cache(opened);
            NeighbourhoodOptions options;
            options.max_distance = max_distance;
            All first;
            for (const unsigned threads : {1u, 2u, 5u})
                for (const std::uint64_t points : {100, 1000, 100000}) {
                    options.threads = threads;
                    options.unit_points = points;
                    const All all = all_of(cache, options, &report_);
                    if (first.empty()) {
                        some_ = 1 << 20;
                        expect_right(*opened, all, options);
                        first = all;
                    }
                    ASSERT_EQ(all.size(), first.size());
                    for (const auto& [place, found] : all) {
                        ASSERT_EQ(found.squares, first.at(place).squares);
                        ASSERT_EQ(found.offsets, first.at(place).offsets);
                    }
                }
        }
    }
}

TEST_F(NeighbourhoodsOf, CancelsAndRefuses)
{
    const auto opened = tree(cloud_of(25000, millimetres, [](std::mt19937_64& random, std::size_t) {
        return Vec3d{500000 + 9 * uniform(random), 4800000 + 9 * uniform(random), 100};
    }));
    L2Cache cache(opened);
    NeighbourhoodOptions options;
    options.unit_points = unit_points_;
    options.neighbours = most_neighbours;  // takes longer than a tenth of a second
    int calls = 0;
    options.progress = [&](const ProgressUpdate&) { return ++calls < 2; };
    EXPECT_EQ(error_of([&] { all_of(cache, options); }).code(), ErrorCode::cancelled);
    options.progress = {};
    for (const std::size_t k : {std::size_t(0), most_neighbours + 1})
        EXPECT_THROW(all_of(cache, (options.neighbours = k, options)), Error);
    options.neighbours = 4;
    for (const double distance : {-1.0, std::nan("")})
        EXPECT_THROW(all_of(cache, (options.max_distance = distance, options)), Error);
}

}  // namespace
}  // namespace pcm::test
