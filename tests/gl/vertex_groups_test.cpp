// Groups of a few points with boxes: culled groups are never visible.
#include "tests/gl/splat_scene.h"

#include "pcm/gl/l1/vertex_groups.h"
#include "tests/sanitizers.h"
#include "tests/view/random_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

// A rough ground with objects on it, sorted so that consecutive points lie close together.
std::vector<Disc> ground(std::mt19937_64& random, std::size_t count, double largest_radius)
{
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> normal;
    std::vector<Disc> discs;
    for (std::size_t i = 0; i < count; ++i) {
        Disc disc;
        disc.centre = {100 * unit(random), 100 * unit(random), unit(random) < 0.9 ? unit(random) : 20 * unit(random)};
        disc.normal = {0.3 * normal(random), 0.3 * normal(random), 1};
        disc.radius = largest_radius * std::pow(unit(random), 2);
        discs.push_back(disc);
    }
    std::sort(discs.begin(), discs.end(), [](const Disc& a, const Disc& b) {
        const auto cell = [](const Disc& d) { return std::pair(int(d.centre[0] / 10), int(d.centre[1] / 10)); };
        return cell(a) < cell(b);
    });
    return discs;
}

// From somewhere in or around the ground, over areas of all sizes; some from above, some orthographic.
Camera look_around(std::mt19937_64& random, const Vec3d& origin)
{
    std::uniform_real_distribution<double> unit(0, 1);
    Camera view;
    view.width = 160;
    view.height = 120;
    view.origin = origin;
    const Vec3d eye{140 * unit(random) - 20, 140 * unit(random) - 20, 0.2 + 60 * std::pow(unit(random), 3)};
    view.modelview =
        product(rotation(random), translation({origin[0] - eye[0], origin[1] - eye[1], origin[2] - eye[2]}));
    const double near = std::pow(10.0, -3 + 3 * unit(random));
    const double half = near * (0.1 + unit(random));
    if (unit(random) < 0.7)
        view.projection = perspective(-half * 4 / 3, half * 4 / 3, -half, half, near, near + 1e4 * unit(random));
    else
        view.projection = orthographic(4 + 40 * unit(random), 3 + 30 * unit(random), -200, 200);
    return view;
}

Drawn draw(SplatPass& pass, const DepthFramebuffer& framebuffer, const SplatScene& scene, const VertexEntry& entry,
           const Camera& view, const CloudStyle& style, const ChunkLook& look)
{
    framebuffer.clear(true);
    scene.draw(entry, pass, view, style, true, 1, look);
    return {framebuffer.colours(), framebuffer.depths()};
}

}  // namespace

TEST(VertexGroups, BoxesAreTightAroundTheirPoints)
{
    std::mt19937_64 random(1);
    for (const std::size_t count : {0, 1, 127, 128, 129, 1000})
        for (const bool wide : {false, true}) {
            ChunkPositions positions;
            positions.wide = wide;
            std::vector<float> radii(count);
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t i = 0; i < count; ++i)
                    wide ? positions.wide_xyz[a].push_back(random() >> 20)
                         : positions.narrow_xyz[a].push_back(static_cast<std::uint32_t>(random()));
            for (float& radius : radii) radius = static_cast<float>(random() % 1000) * 0.001f;
            const Vec3d scale{0.001, 0.25, 1e-7};
            const std::vector<VertexGroup> groups = make_groups(positions, scale, radii.data());
            ASSERT_EQ(groups.size(), (count + VertexGroup::points - 1) / VertexGroup::points);
            for (std::size_t g = 0; g < groups.size(); ++g) {
                const std::size_t first = g * VertexGroup::points, end = std::min(count, first + VertexGroup::points);
                for (std::size_t a = 0; a < 3; ++a) {
                    float low = 1e30f, high = -1e30f;
                    for (std::size_t i = first; i < end; ++i) {
                        const auto place = static_cast<float>(static_cast<double>(positions.relative(i, a)) * scale[a]);
                        low = std::min(low, place);
                        high = std::max(high, place);
                    }
                    EXPECT_EQ(groups[g].low[a], low);
                    EXPECT_EQ(groups[g].high[a], high);
                }
                EXPECT_EQ(groups[g].largest_radius,
                          *std::max_element(radii.begin() + static_cast<std::ptrdiff_t>(first),
                                            radii.begin() + static_cast<std::ptrdiff_t>(end)));
            }
            for (const VertexGroup& group : make_groups(positions, scale, nullptr)) EXPECT_EQ(group.largest_radius, 0);
        }
}

TEST(VertexGroups, RunsGrow)
{
    std::vector<VertexRun> runs;
    add_run(runs, 0, 128);
    add_run(runs, 128, 128);
    add_run(runs, 512, 3);
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_EQ(runs[0].count, 256u);
    EXPECT_EQ(runs[1].first, 512u);
}

// The same chunk, once as it is and once with the whole box for each group: nothing is culled then.
// Not under the address sanitizer: much drawing in software.
TEST(VertexGroups, PCM_NOT_UNDER_ADDRESS(CulledGroupsAreInvisible))
{
    PCM_REQUIRE_GL(context, Profile::core);
    std::mt19937_64 random(2);
    const Grid grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
    const DepthFramebuffer framebuffer(160, 120);
    std::size_t left_out = 0, quads_too = 0, seen = 0;
    SplatPass pass;
    for (const double largest_radius : {0.3, 30.0}) {
        std::vector<PointShape> shapes;
        for (int d = 0; d < 5000; ++d)
            shapes.push_back(d % 3 == 0   ? volume_shape(0.001 * (d % 1000))
                             : d % 3 == 1 ? shape_of(Surroundings::line, {0.6, 0.8, 0})
                                          : shape_of(Surroundings::surface, {0, 0.6, 0.8}));
        const SplatScene scene(grid, ground(random, 5000, largest_radius), {ColourSource::rgb, true, true, true},
                               shapes);
        VertexEntry whole = scene.entry();
        for (VertexGroup& group : whole.groups) {
            group.low = {0, 0, 0};
            for (std::size_t a = 0; a < 3; ++a) group.high[a] = static_cast<float>(whole.extent[a]);
            group.largest_radius = whole.largest_radius;
        }
        for (int i = 0; i < 40; ++i) {
            const Camera view = look_around(random, {50, 50, 0});
            for (const SplatTraits& traits : splat_modes()) {
                CloudStyle style = style_of(traits.mode);
                style.colour = ColourMode::rgb;
                ChunkLook look;
                if (i % 2) look.least_radius = 0.5f, look.least_px = 20;
                const Drawn parts = draw(pass, framebuffer, scene, scene.entry(), view, style, look);
                const Drawn all = draw(pass, framebuffer, scene, whole, view, style, look);
                std::size_t different = 0;
                for (std::size_t p = 0; p < all.colours.size(); ++p) {
                    different += std::memcmp(&parts.colours[p], &all.colours[p], sizeof(Pixel)) != 0 ||
                                 parts.depths[p] != all.depths[p];
                    seen += all.colours[p].a != 0;
                }
                std::vector<SplatPart> of_view;
                pass.begin(view, scene.info(), style, true, 1);
                const std::uint64_t vertices = pass.preview(scene.entry(), of_view);
                pass.end();
                left_out += scene.entry().points > vertices ? scene.entry().points - vertices : 0;
                quads_too += traits.shape != SplatShape::pixels && vertices > scene.entry().points;
                // Squares whose sides are not whole pixels are rounded differently as points and as quads, at their
                // edges.
                const bool rounded = traits.shape == SplatShape::sphere;
                EXPECT_LE(different, rounded ? all.colours.size() / 10 : 0)
                    << "view " << i << ", " << traits.name << ", radius " << largest_radius;
            }
        }
    }
    pass.release();
    EXPECT_GT(left_out, 500'000u);
    EXPECT_GT(quads_too, 20u);
    EXPECT_GT(seen, 500'000u);
}

// In every view: all visible points are counted, and few others; and the pixels per unit at their places are right.
TEST(VertexGroups, PreviewsCountThePointsInView)
{
    PCM_REQUIRE_GL(context, Profile::core);
    std::mt19937_64 random(3);
    const Grid grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
    const std::vector<Disc> discs = ground(random, 20000, 0.1);
    const SplatScene scene(grid, discs);
    SplatPass pass;
    const DepthFramebuffer framebuffer(160, 120);
    double log_of_sizes = 0, log_of_counts = 0;
    int views = 0;
    for (int i = 0; i < 200; ++i) {
        const Camera view = look_around(random, {0, 0, 0});
        double squares = 0;
        std::uint64_t inside = 0;
        for (const Disc& disc : discs) {
            const std::array<double, 4> c = clip(view, disc.centre);
            if (!is_visible(c)) continue;
            ++inside;
            squares += std::pow(0.5 * view.height * view.projection[5] / c[3], 2);
        }
        std::vector<SplatPart> parts;
        pass.begin(view, scene.info(), style_of(SplatMode::constant), true, 1);
        const std::uint64_t vertices = pass.preview(scene.entry(), parts);
        pass.end();
        double counted = 0, estimate = 0;
        for (const SplatPart& part : parts) {
            counted += part.points;
            estimate += part.points * double(part.pixels_per_unit) * double(part.pixels_per_unit);
        }
        EXPECT_GE(vertices, inside) << i;
        if (inside < 2000) continue;
        ++views;
        log_of_counts += std::log(counted / double(inside));
        log_of_sizes += std::abs(std::log(estimate / squares));
        EXPECT_LT(std::abs(std::log(estimate / squares)), std::log(8.0))
            << i << ": " << estimate << " instead of " << squares;
    }
    ASSERT_GT(views, 40);
    EXPECT_LT(log_of_counts / views, std::log(1.4));
    EXPECT_LT(log_of_sizes / views, std::log(1.7));
    pass.release();
}
