// Which points of a chunk are drawn, and how, against each point's own place and size in the picture.
#include "pcm/gl/draw/splat_sieve.h"

#include "pcm/gl/draw/view_clips.h"
#include "tests/support.h"
#include "tests/view/random_views.h"

#include <cmath>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double largest_point = 60;
constexpr int guard = 200;
const Vec3d origin{100, -30, 8};  // origin of the views

// Clusters of 128 points, and the radius of each point.
struct SyntheticChunk {
    VertexEntry entry;
    Box3d box;                  // relative to the views' origin
    std::vector<Vec3d> places;  // positions of the points, likewise
    std::vector<float> radii;
};

SyntheticChunk random_chunk(std::mt19937_64& random)
{
    std::uniform_real_distribution<double> unit(0, 1);
    SyntheticChunk chunk;
    const double size = std::pow(10.0, 2 * unit(random) - 1), spread = 0.3 * size * unit(random);
    const Vec3d corner{20 * unit(random) - 10, 20 * unit(random) - 10, 20 * unit(random) - 10};
    const std::size_t points = 1 + random() % 2000;
    std::vector<std::array<float, 3>> positions;
    Vec3d centre{};
    for (std::size_t i = 0; i < points; ++i) {
        if (i % VertexGroup::points == 0) centre = {size * unit(random), size * unit(random), size * unit(random)};
        std::array<float, 3> p{};
        for (std::size_t a = 0; a < 3; ++a) p[a] = static_cast<float>(std::fabs(centre[a] + spread * unit(random)));
        positions.push_back(p);
        chunk.radii.push_back(static_cast<float>(0.02 * size * std::pow(unit(random), 6)));
    }
    chunk.box.min = chunk.box.max = corner;
    for (std::size_t i = 0; i < points; ++i) {
        if (i % VertexGroup::points == 0) {
            chunk.entry.groups.emplace_back();
            chunk.entry.groups.back().low = chunk.entry.groups.back().high = positions[i];
        }
        VertexGroup& group = chunk.entry.groups.back();
        Vec3d place{};
        for (std::size_t a = 0; a < 3; ++a) {
            group.low[a] = std::min(group.low[a], positions[i][a]);
            group.high[a] = std::max(group.high[a], positions[i][a]);
            place[a] = corner[a] + static_cast<double>(positions[i][a]);
        }
        group.largest_radius = std::max(group.largest_radius, chunk.radii[i]);
        chunk.entry.largest_radius = std::max(chunk.entry.largest_radius, chunk.radii[i]);
        chunk.places.push_back(place);
        chunk.box.extend(place);
    }
    chunk.entry.points = static_cast<std::uint32_t>(points);
    return chunk;
}

// 0: not drawn, 1: as points, 2: as quads. Runs are in order, apart, and of points that there are.
std::vector<int> ways_of(const SplatSieve& sieve, std::size_t points)
{
    std::vector<int> ways(points, 0);
    for (const int way : {1, 2}) {
        std::size_t last = 0;
        for (const VertexRun& run : way == 1 ? sieve.as_points() : sieve.as_quads()) {
            EXPECT_GE(run.first, last);
            EXPECT_GT(run.count, 0u);
            last = run.first + run.count;
            EXPECT_LE(last, points);
            for (std::size_t i = run.first; i < std::min(last, points); ++i) {
                EXPECT_EQ(ways[i], 0) << "drawn twice";
                ways[i] = way;
            }
        }
    }
    return ways;
}

// Whether something of a point's square is in the view; squares are tested at their centres and at some places in them.
bool is_seen(const SplatCamera& camera, const Vec3d& place, double radius, std::mt19937_64& random)
{
    std::uniform_real_distribution<double> unit(-0.7, 0.7);
    if (!is_visible(clip(camera.view, place + camera.view.origin))) return false;
    if (camera.is_in_view(place)) return true;
    for (int k = 0; k < 4; ++k)
        if (camera.is_in_view(place + radius * Vec3d{unit(random), unit(random), unit(random)})) return true;
    return false;
}

template <class Check>
void for_views(const Check& check)
{
    std::mt19937_64 random(31);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 150; ++i) {
        SCOPED_TRACE(i);
        const Vec3d eye = origin + 15.0 * Vec3d{unit(random), unit(random), unit(random)};
        const auto camera = SplatCamera::of(random_view(random, eye, origin, 20), 0, 0, i % 2);
        ASSERT_TRUE(camera);
        check(*camera, random);
    }
}

// One sieve for chunks of all kinds, one after the other, as in a frame.
TEST(SplatSieves, LeaveOutNoPointThatIsSeenAndDrawLargeOnesAsQuads)
{
    std::size_t seen = 0, left_out = 0, large = 0, quads = 0;
    for_views([&](const SplatCamera& camera, std::mt19937_64& random) {
        CloudStyle style;
        style.radius_scale = static_cast<float>(1 + random() % 3);
        SplatSieve sieve(camera, style, largest_point, guard);
        for (int k = 0; k < 12; ++k) {
            const SyntheticChunk chunk = random_chunk(random);
            const SplatShape shape = k % 3 ? SplatShape::sphere : SplatShape::pixels;
            sieve.sort(chunk.entry, chunk.box, shape, {});
            EXPECT_EQ(sieve.clipped(), 0u);
            const std::vector<int> ways = ways_of(sieve, chunk.places.size());
            for (std::size_t i = 0; i < ways.size(); ++i) {
                const double radius = static_cast<double>(chunk.radii[i] * style.radius_scale);
                left_out += ways[i] == 0;
                quads += ways[i] == 2;
                if (!is_seen(camera, chunk.places[i], shape == SplatShape::pixels ? 0 : radius, random)) continue;
                ++seen;
                ASSERT_NE(ways[i], 0) << i << " of " << ways.size();
                const double pixels = 2 * radius * camera.pixels_at(-camera.eye_of(chunk.places[i])[2]);
                const bool is_large = shape == SplatShape::sphere && pixels > largest_point * (1 + 1e-9);
                large += is_large;
                if (is_large || shape == SplatShape::pixels) {
                    ASSERT_EQ(ways[i], is_large ? 2 : 1) << pixels << " pixels";
                }
            }
        }
    });
    EXPECT_GT(seen, 20000u);
    EXPECT_GT(left_out, 20000u);
    EXPECT_GT(large, 50u);
    EXPECT_GT(quads, large);
}

// The parts of a chunk: their points are those in view, their sizes those at some depth of the chunk.
TEST(SplatSieves, PartsHaveThePointsInViewAndTheirDistances)
{
    std::size_t whole = 0, none = 0;
    for_views([&](const SplatCamera& camera, std::mt19937_64& random) {
        const CloudStyle style;
        SplatSieve sieve(camera, style, largest_point, guard);
        for (int k = 0; k < 12; ++k) {
            const SyntheticChunk chunk = random_chunk(random);
            std::vector<SplatPart> parts;
            sieve.sort(chunk.entry, chunk.box, SplatShape::sphere, {}, &parts);
            double points = 0, least = std::numeric_limits<double>::infinity(), most = 0;
            for (const SplatPart& part : parts) {
                points += part.points;
                least = std::min(least, part.pixels_per_unit);
                most = std::max(most, part.pixels_per_unit);
            }
            EXPECT_LE(points, static_cast<double>(chunk.entry.points));
            bool all = true;
            double near = std::numeric_limits<double>::infinity(), far = -near;
            for (unsigned corner = 0; corner < 8; ++corner) {
                Vec3d p{};
                for (std::size_t a = 0; a < 3; ++a) p[a] = (corner >> a) & 1 ? chunk.box.max[a] : chunk.box.min[a];
                all = all && is_visible(clip(camera.view, p + origin));
                near = std::min(near, -camera.eye_of(p)[2]);
                far = std::max(far, -camera.eye_of(p)[2]);
            }
            none += parts.empty();
            if (parts.empty() || !all) continue;
            ++whole;
            EXPECT_NEAR(points, static_cast<double>(chunk.entry.points), 1e-9 * points);
            EXPECT_GE(least, camera.pixels_at(far) * (1 - 1e-9));
            EXPECT_LE(most, camera.pixels_at(near) * (1 + 1e-9));
        }
    });
    EXPECT_GT(whole, 50u);
    EXPECT_GT(none, 50u);
}

TEST(SplatSieves, GroupsOutsideOfAClipAreLeftOutAndCounted)
{
    std::size_t clipped = 0, kept = 0;
    for_views([&](const SplatCamera& camera, std::mt19937_64& random) {
        const CloudStyle style;
        SplatSieve sieve(camera, style, largest_point, guard);
        for (int k = 0; k < 8; ++k) {
            const SyntheticChunk chunk = random_chunk(random);
            Box3d half = chunk.box;
            const std::size_t axis = random() % 3;
            half.max[axis] -= 0.5 * half.extent(axis);
            const ViewClips clips({{Region::box({half.min + origin, half.max + origin}), false}});
            std::size_t outside = 0;
            for (std::size_t g = 0; g < chunk.entry.groups.size(); ++g) {
                const VertexGroup& group = chunk.entry.groups[g];
                bool apart = false;
                for (std::size_t a = 0; a < 3; ++a)
                    apart = apart || chunk.box.min[a] + static_cast<double>(group.low[a]) > half.max[a];
                outside += apart ? std::min(VertexGroup::points, chunk.places.size() - g * VertexGroup::points) : 0;
            }
            sieve.sort(chunk.entry, chunk.box, SplatShape::pixels, {}, nullptr, &clips);
            const std::vector<int> ways = ways_of(sieve, chunk.places.size());
            if (ways == std::vector<int>(ways.size(), 0) && sieve.clipped() == 0) continue;  // out of view
            EXPECT_EQ(sieve.clipped(), outside);
            clipped += outside;
            for (std::size_t i = 0; i < ways.size(); ++i)
                if (is_visible(clip(camera.view, chunk.places[i] + origin)) && half.contains(chunk.places[i])) {
                    ++kept;
                    ASSERT_EQ(ways[i], 1);
                }
        }
    });
    EXPECT_GT(clipped, 5000u);
    EXPECT_GT(kept, 5000u);
}

}  // namespace
