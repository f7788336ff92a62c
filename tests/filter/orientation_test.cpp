#include "pcm/filter/orientation_pieces.h"

#include "pcm/filter/neighbour_attributes.h"
#include "tests/filter/oracle.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// Those of all points, by the search.
JoinedNeighbours neighbours_of(const SearchPositions& positions)
{
    JoinedNeighbours neighbours;
    neighbours.resize(positions.size());
    UnitSearchOptions options;
    options.neighbours = JoinedNeighbours::most;
    make_unit_search(positions)->search(nullptr, options, [&](const FoundNeighbours& found) {
        for (std::size_t i = 0; i < found.size; ++i)
            neighbours.set(found.points[i], found.neighbours + i * found.stride, found.squared + i * found.stride,
                           found.counts[i]);
    });
    return neighbours;
}

TEST(JoinedNeighbours, AreTheNearestOfTheUnitAndTheFirstAtAPlaceStandsForAll)
{
    JoinedNeighbours neighbours;
    neighbours.resize(20);
    const auto set = [&](std::uint32_t point, const std::vector<std::uint32_t>& numbers,
                         const std::vector<double>& squared) {
        neighbours.set(point, numbers.data(), squared.data(), numbers.size());
    };
    const auto of = [&](std::size_t point) {
        std::vector<std::uint32_t> found;
        for (std::size_t j = 0; j < JoinedNeighbours::most; ++j)
            found.push_back(neighbours[point * JoinedNeighbours::most + j]);
        return found;
    };
    for (std::uint32_t i = 0; i < 20; ++i) set(i, {}, {});
    constexpr std::uint32_t none = JoinedNeighbours::none;
    set(0, {20, 7, 5, 30, 9}, {0, 1, 1, 2, 3});
    EXPECT_EQ(of(0), (std::vector<std::uint32_t>{7, 5, 9, none, none, none}));
    EXPECT_TRUE(neighbours.surely_lists(0, 9));
    EXPECT_FALSE(neighbours.surely_lists(0, 3));
    // 10 to 18 lie at one place, and each lists the others in an order of its own.
    set(18, {13, 17, 12, 16, 11, 15, 14, 10}, {0, 0, 0, 0, 0, 0, 0, 0});
    set(12, {18, 17, 16, 15, 14, 13, 11, 10, 3}, {0, 0, 0, 0, 0, 0, 0, 0, 4});
    set(3, {4, 18, 12, 1, 2, 5, 6, 7}, {1, 4, 4, 5, 6, 7, 8, 9});
    EXPECT_EQ(of(3), (std::vector<std::uint32_t>{4, 10, 10, 1, 2, 5}));
    EXPECT_FALSE(neighbours.surely_lists(3, 18)) << "another point stands for it";
    neighbours.resize(2);
    EXPECT_EQ(of(0), std::vector<std::uint32_t>(JoinedNeighbours::most, none));
}

// Two level sheets, 100 apart, whose normals point up or down at random; some points have none.
TEST(UnitPieces, AreTheSheetsAndHaveTheSumsOfTheirPoints)
{
    std::mt19937_64 random(7);
    SearchPositions positions;
    positions.scale = {0.01, 0.01, 0.01};
    std::vector<std::array<float, 3>> normals;
    const Vec3d origin{10, 20, 30};
    for (int sheet = 0; sheet < 2; ++sheet)
        for (int k = 0; k < 600; ++k) {
            positions.narrow[0].push_back(static_cast<std::int32_t>(random() % 2000));
            positions.narrow[1].push_back(static_cast<std::int32_t>(random() % 2000));
            positions.narrow[2].push_back(sheet * 10000 + static_cast<std::int32_t>(random() % 3));
            const float up = random() % 2 ? 1.0f : -1.0f;
            normals.push_back(random() % 20 == 0 ? std::array<float, 3>{} : std::array<float, 3>{0, 0, up});
        }
    std::vector<std::uint8_t> two_surfaces(normals.size(), 0);
    const std::vector<std::array<float, 3>> before = normals;
    const UnitPieces pieces = join_pieces(positions, neighbours_of(positions), origin, normals, two_surfaces);
    ASSERT_EQ(pieces.piece.size(), normals.size());
    std::vector<PieceSums> expected(pieces.sums.size());
    std::set<std::uint32_t> of_sheet[2];
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const bool defined = before[i][2] != 0;
        ASSERT_EQ(pieces.piece[i] == no_piece, !defined);
        EXPECT_EQ(std::fabs(normals[i][2]), defined ? 1 : 0);
        if (!defined) continue;
        ASSERT_LT(pieces.piece[i], pieces.sums.size());
        of_sheet[i / 600].insert(pieces.piece[i]);
        EXPECT_EQ(normals[i][2], 1) << "a level sheet points up";
        const Vec3d p{0.01 * positions.narrow[0][i], 0.01 * positions.narrow[1][i], 0.01 * positions.narrow[2][i]};
        expected[pieces.piece[i]].add(p + origin, {normals[i][0], normals[i][1], normals[i][2]});
    }
    for (const std::uint32_t piece : of_sheet[0]) EXPECT_EQ(of_sheet[1].count(piece), 0u);
    EXPECT_EQ(of_sheet[0].size() + of_sheet[1].size(), pieces.sums.size()) << "no piece without points";
    EXPECT_LT(pieces.sums.size(), 20u);
    for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_EQ(pieces.sums[k].count, expected[k].count);
        EXPECT_NEAR(pieces.sums[k].squares / expected[k].squares, 1, 1e-12);
        EXPECT_NEAR(pieces.sums[k].flux / expected[k].flux, 1, 1e-12);
        EXPECT_NEAR(length(pieces.sums[k].positions - expected[k].positions), 0, 1e-6);
        EXPECT_NEAR(length(pieces.sums[k].normals - expected[k].normals), 0, 1e-9);
        EXPECT_GT(pieces.sums[k].outward_or_up(), 0);
    }
}

TEST(SidedSets, KeepTheSidesOfASimpleModel)
{
    std::mt19937_64 random(1);
    const std::uint32_t count = 300;
    std::vector<std::uint32_t> set(count);
    std::vector<int> side(count, 1);
    for (std::uint32_t i = 0; i < count; ++i) set[i] = i;
    SidedSets sets(count);
    for (int turn = 0; turn < 500; ++turn) {
        const auto a = static_cast<std::uint32_t>(random() % count), b = static_cast<std::uint32_t>(random() % count);
        const int relative = random() % 2 ? 1 : -1;
        ASSERT_EQ(sets.join(a, b, relative), set[a] != set[b]);
        if (set[a] != set[b]) {
            const std::uint32_t from = set[b];
            const int turned = side[a] * side[b] * relative;
            for (std::uint32_t i = 0; i < count; ++i)
                if (set[i] == from) set[i] = set[a], side[i] *= turned;
        }
        for (int look = 0; look < 20; ++look) {
            const auto i = static_cast<std::uint32_t>(random() % count),
                       j = static_cast<std::uint32_t>(random() % count);
            const auto x = sets.find(i), y = sets.find(j);
            ASSERT_EQ(x.set == y.set, set[i] == set[j]);
            if (set[i] == set[j]) ASSERT_EQ(x.side * y.side, side[i] * side[j]);
        }
    }
}

// Against a search that takes the clearest vote left between two sets, again and again.
TEST(SidedSets, AreJoinedByTheClearestVotesOfEitherSign)
{
    std::mt19937_64 random(3);
    for (int round = 0; round < 200; ++round) {
        const auto count = static_cast<std::uint32_t>(2 + random() % 8);
        std::vector<SideVote> votes;
        for (std::uint32_t a = 0; a < count; ++a)
            for (std::uint32_t b = a + 1; b < count; ++b)
                if (random() % 3) votes.push_back({a, b, static_cast<std::int64_t>(random() % 21) - 10});
        std::shuffle(votes.begin(), votes.end(), random);
        std::vector<std::uint32_t> set(count);
        std::vector<int> side(count, 1);
        for (std::uint32_t i = 0; i < count; ++i) set[i] = i;
        for (;;) {
            const SideVote* best = nullptr;
            for (const SideVote& vote : votes) {
                if (set[vote.a] == set[vote.b]) continue;
                const auto key = [](const SideVote& v) { return std::tuple(-std::llabs(v.sum), v.a, v.b); };
                if (!best || key(vote) < key(*best)) best = &vote;
            }
            if (!best) break;
            const int turned = side[best->a] * side[best->b] * (best->sum < 0 ? -1 : 1);
            const std::uint32_t from = set[best->b], to = set[best->a];
            for (std::uint32_t i = 0; i < count; ++i)
                if (set[i] == from) set[i] = to, side[i] *= turned;
        }
        SidedSets sets(count);
        join_by_votes(sets, votes);
        for (std::uint32_t i = 0; i < count; ++i)
            for (std::uint32_t j = 0; j < i; ++j) {
                const auto x = sets.find(i), y = sets.find(j);
                ASSERT_EQ(x.set == y.set, set[i] == set[j]);
                if (set[i] == set[j]) ASSERT_EQ(x.side * y.side, side[i] * side[j]);
            }
    }
}

TEST(PieceSums, PreferTheClearerOfOutwardAndUp)
{
    PieceSums ball, ground, wall;
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 1000; ++i) {
        const Vec3d n = normalised({normal(random), normal(random), normal(random)});
        ball.add(Vec3d{1000, 2000, 30} + 5.0 * n, n);
        ground.add({double(i % 40), double(i / 40), 0}, {0, 0, -1});
        wall.add({double(i % 40), 0, double(i / 40)}, {0, -1, 0});
    }
    EXPECT_NEAR(ball.outward_or_up(), 1, 0.01);
    EXPECT_EQ(ground.outward_or_up(), -1);
    EXPECT_LT(wall.outward_or_up(), 0);
    PieceSums turned;
    turned.join(ball, -1);
    EXPECT_NEAR(turned.outward_or_up(), -1, 0.01);
}

// So little memory, and units so small, that there are many and one at a time.
constexpr std::uint64_t little = 1 << 20;

class Orientation : public testing::Test {
protected:
    // Estimates normals and returns those of all points, with their positions.
    std::vector<std::pair<Vec3d, Vec3d>> normals(const MemoryCloud& cloud, std::uint64_t memory = 64 << 20,
                                                 unsigned threads = 2)
    {
        fs::remove_all(tree_);
        build_small(cloud, tree_);
        NeighbourAttributeOptions options;
        options.wanted.normal = options.wanted.confidence = true;
        options.neighbours = neighbours_;
        options.threads = threads;
        options.memory_bytes = memory;
        if (memory == little) options.unit_points = 3000;
        report_ = compute_neighbour_attributes(tree_, options);
        const Oracle oracle(tree_);
        std::vector<std::pair<Vec3d, Vec3d>> all;
        for (const OraclePoint& p : oracle.points) all.emplace_back(oracle.position(p), oracle.normal(p));
        return all;
    }

    const TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "cloud.pct";
    std::size_t neighbours_ = 10;
    NeighbourAttributeReport report_;
};

Vec3d on_sphere(double u, double v)
{
    const double z = 2 * u - 1, r = std::sqrt(1 - z * z), a = 2 * pi * v;
    return {r * std::cos(a), r * std::sin(a), z};
}

TEST_F(Orientation, ClosedSurfacesPointOutwardAcrossUnits)
{
    const Vec3d one{500000, 4800000, 100}, other{500003, 4800000, 100};
    const auto spheres =
        cloud_of(20000, 51, [&](double u, double v, double w) { return (w < 0.5 ? one : other) + on_sphere(u, v); });
    for (const std::uint64_t memory : {little, std::uint64_t(64) << 20}) {
        std::size_t wrong = 0;
        for (const auto& [p, n] : normals(spheres, memory)) {
            const Vec3d& centre = p[0] < 500001.5 ? one : other;
            if (dot(n, p - centre) <= 0) ++wrong;
        }
        EXPECT_EQ(wrong, 0u) << memory;
    }
}

TEST_F(Orientation, AFoldedSheetKeepsOneSide)
{
    // A sheet that winds through more than a full turn: its normals point everywhere, but its side is one.
    const auto turn_of = [](double u) { return 1.2 * pi * u; };
    const auto sheet = cloud_of(20000, 52, [&](double u, double v, double) {
        const double a = turn_of(u);
        return Vec3d{5 * std::sin(a), 4 * v, 5 - 5 * std::cos(a)};
    });
    for (const std::uint64_t memory : {little, std::uint64_t(64) << 20}) {
        std::size_t inward = 0, outward = 0;
        for (const auto& [p, n] : normals(sheet, memory)) ++(dot(n, {p[0], 0, p[2] - 5}) > 0 ? outward : inward);
        EXPECT_EQ(std::min(inward, outward), 0u) << memory;
        EXPECT_EQ(inward, 0u) << memory;  // more of it looks outward from its middle than up
    }
}

TEST_F(Orientation, PiecesThatAreTurnedCountTurned)
{
    // An almost closed tube: its units point up by themselves, half of them into it.
    for (const double turn : {0.0, 1.0, 2.5, 4.0}) {
        const auto tube = cloud_of(12000, 58, [&](double u, double v, double) {
            const double a = turn + 1.9 * pi * u;
            return Vec3d{5 * std::cos(a), 4 * v, 5 * std::sin(a)};
        });
        std::size_t inward = 0;
        for (const auto& [p, n] : normals(tube, little)) inward += dot(n, {p[0], 0, p[2]}) < 0;
        EXPECT_EQ(inward, 0u) << turn;
    }
}

TEST_F(Orientation, GroundPointsUpAndWallsAgree)
{
    const auto scene = cloud_of(20000, 53, [](double u, double v, double w) {
        if (w < 0.6) return Vec3d{20 * u, 20 * v, 0.5 * std::sin(2 * u)};
        return Vec3d{20 * u, 40, 3 + 10 * v};  // far from the ground
    });
    std::size_t down = 0, one = 0, other = 0;
    for (const auto& [p, n] : normals(scene, little)) {
        if (p[1] < 30)
            down += n[2] <= 0;
        else
            ++(n[1] > 0 ? one : other);
    }
    EXPECT_EQ(down, 0u);
    EXPECT_EQ(std::min(one, other), 0u);
}

TEST_F(Orientation, DoesNotDependOnTheThreads)
{
    const auto scene = cloud_of(15000, 54, [](double u, double v, double w) {
        return w < 0.9 ? Vec3d{9 * u, 9 * v, std::sin(3 * u)} : Vec3d{9 * u, 9 * v, 9 * w};
    });
    normals(scene, little, 1);
    const auto hash = Tree::open(tree_)->info().content_hash;
    normals(scene, little, 4);
    EXPECT_EQ(Tree::open(tree_)->info().content_hash, hash);
}

// The sides of a plate that is thinner than its points are apart: which of two opposite normals is right nothing says
// there, and they are marked.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(Orientation, PCM_NOT_UNDER_THREAD(ThinPlatesAreMarked))
{
    neighbours_ = 16;
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise(0, 0.001);
    for (const double thick : {0.02, 0.06}) {  // points are 0.14 apart on a side
        const auto plate = cloud_of(20000, 61, [&](double u, double v, double w) {
            return Vec3d{14 * u, 14 * v, (w < 0.5 ? 0 : thick) + noise(random)};
        });
        for (const std::uint64_t memory : {little, std::uint64_t(64) << 20}) {
            std::size_t wrong = 0, marked = 0;
            for (const auto& [p, n] : normals(plate, memory)) wrong += (n[2] > 0) != (p[2] > thick / 2);
            const Oracle oracle(tree_);
            for (const OraclePoint& p : oracle.points) marked += oracle.value(p, "normal_confidence") == 4;
            EXPECT_GT(wrong, 4000u) << "nothing to mark: all sides are right";
            EXPECT_GT(marked, 16000u) << thick << " " << memory;
            EXPECT_EQ(report_.two_surfaces, marked);
            ASSERT_EQ(report_.notes.size(), 1u);
            EXPECT_NE(report_.notes[0].find(std::to_string(marked) + " points"), std::string::npos) << report_.notes[0];
        }
    }
    // Nothing of that on one surface, even with as much noise, and at steps.
    const auto sheet = cloud_of(20000, 62, [&](double u, double v, double) {
        return Vec3d{14 * u, 14 * v, (u < 0.5 ? 0 : 0.1) + 20 * noise(random)};
    });
    normals(sheet);
    EXPECT_LT(report_.two_surfaces, 40u);
    EXPECT_TRUE(report_.notes.empty());
}

// Not one bit of any column depends on the threads and the memory, where all distances are ties, and places too.
TEST_F(Orientation, ColumnsAreTheSameForAnyThreadsAndMemory)
{
    std::size_t number = 0;
    const std::vector<MemoryCloud> clouds{
        cloud_of(12000, 64,
                 [&](double, double, double) {
                     const std::size_t i = number++ % 12000;
                     return Vec3d{500000 + 0.01 * double(i % 100), 4800000 + 0.01 * double(i / 100), 0};
                 }),
        cloud_of(9000, 65,
                 [&](double u, double v, double w) {
                     return Vec3d{500000 + std::floor(12 * u), 4800000 + std::floor(12 * v), std::floor(9 * w)};
                 }),
        cloud_of(12000, 66, [](double u, double v, double w) {
            return w < 0.5 ? Vec3d{u, v, 0.2 * std::sin(9 * u)} : Vec3d{u, v, w};
        })};
    for (const MemoryCloud& cloud : clouds) {
        fs::remove_all(tree_);
        build_small(cloud, tree_);
        std::vector<std::vector<double>> first;
        for (const unsigned threads : {1u, 2u, 5u})
            for (const std::uint64_t memory : {least_filter_memory, std::uint64_t(1) << 30, little}) {
                fs::remove_all(folder_ / "copy.pct");
                fs::copy(tree_, folder_ / "copy.pct", fs::copy_options::recursive);
                NeighbourAttributeOptions options;
                options.wanted = all_values();
                options.threads = threads;
                options.memory_bytes = memory;
                options.unit_points = 1000;
                compute_neighbour_attributes(folder_ / "copy.pct", options);
                const Oracle oracle(folder_ / "copy.pct");
                std::vector<std::vector<double>> columns(7);
                for (const OraclePoint& p : oracle.points) {
                    std::size_t c = 0;
                    for (const char* name : {"radius", "curvature", "normal_confidence", "mean_distance"})
                        columns[c++].push_back(oracle.value(p, name));
                    for (std::uint32_t a = 0; a < 3; ++a) columns[c++].push_back(oracle.value(p, "normal", a));
                }
                if (first.empty()) first = columns;
                for (std::size_t c = 0; c < columns.size(); ++c)
                    ASSERT_TRUE(columns[c] == first[c]) << c << " " << threads;
            }
    }
}

TEST_F(Orientation, OfPointsWithoutNormals)
{
    for (const auto& [p, n] : normals(cloud_of(50, 55, [](double, double, double) { return Vec3d{1, 2, 3}; })))
        EXPECT_EQ(n, (Vec3d{0, 0, 0}));
    EXPECT_EQ(normals(cloud_of(1, 55, [](double, double, double) { return Vec3d{1, 2, 3}; })).size(), 1u);
    for (const auto& [p, n] : normals(cloud_of(40, 56, [](double u, double, double) { return Vec3d{u, 2, 3}; })))
        EXPECT_GT(n[2], 0.99);  // a line: up
}

}  // namespace
