// Splats by the points' surroundings, against their formula.
#include "tests/gl/splat_formulas.h"
#include "tests/sanitizers.h"

#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

const VertexFormat fitted_format{ColourSource::rgb, true, false, true};

// The radius that the shader reads out of the packed one.
double packed_radius(double radius, PointShape shape)
{
    const float packed = with_shape(static_cast<float>(radius), shape);
    std::uint32_t bits;
    std::memcpy(&bits, &packed, 4);
    bits = (bits & ~0x3ffffu) | 0x20000u;
    float read;
    std::memcpy(&read, &bits, 4);
    return static_cast<double>(read);
}

Vec3d turned(const Camera& view, const Vec3d& v)
{
    Vec3d eye{};
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) eye[r] += view.modelview[c * 4 + r] * v[c];
    return eye;
}

// The ends of two perpendicular half axes of the splat's disc, eye space; whether it lies in a surface.
struct Axes {
    Vec3d u, v;
    bool lies;
};

Axes axes_of(const Camera& view, const Eye& eye, PointShape shape, double r)
{
    const bool parallel = view.projection[11] == 0;
    const Surroundings kind = surroundings_of(shape);
    Axes axes{{r, 0, 0}, {0, r, 0}, kind == Surroundings::surface};
    if (axes.lies) {
        const Vec3d n = turned(view, direction_of(shape));
        axes.u = normalised(cross(n, std::fabs(n[0]) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
        axes.v = r * cross(n, axes.u);
        axes.u = r * axes.u;
    } else if (kind == Surroundings::line) {
        axes.u = r * turned(view, direction_of(shape));
        axes.v = 0.25 * r * normalised(cross(parallel ? Vec3d{0, 0, -1} : eye.place, axes.u));
    }
    if (parallel) return axes;
    // The farthest and the nearest place of its edge along the view are no more than half the depth away.
    const double angle = std::atan2(axes.v[2], axes.u[2]);
    const Vec3d steep = std::cos(angle) * axes.u + std::sin(angle) * axes.v;
    if (std::fabs(steep[2]) <= 0.5 * eye.depth) return axes;
    const Vec3d level = -std::sin(angle) * axes.u + std::cos(angle) * axes.v;
    return {(0.5 * eye.depth / std::fabs(steep[2])) * steep, level, axes.lies};
}

// By solving for the ray of each pixel, not by the derivatives that the shader has for the depth.
Splat ellipse(const Camera& view, const Disc& disc, PointShape shape)
{
    const Eye eye = eye_of(view, disc);
    const ClipDepths clip = clip_of(view);
    const bool parallel = view.projection[11] == 0;
    double r = packed_radius(disc.radius, shape);
    if (surroundings_of(shape) == Surroundings::volume && volume_of(shape) > 0)
        r = std::min(r, 5 * (2 - volume_of(shape)) / eye.focal[1]);
    if (!parallel && surroundings_of(shape) != Surroundings::surface)
        r = std::min(r, 0.5 * std::sqrt(dot(eye.place, eye.place)));
    const Axes axes = axes_of(view, eye, shape, r);
    const auto project = [&](const Vec3d& d) {
        Vec3d p{};
        for (std::size_t a = 0; a < 2; ++a)
            p[a] = eye.focal[a] * (d[a] + (parallel ? 0 : eye.place[a] / eye.depth * d[2]));
        return p;
    };
    const Vec3d pu = project(axes.u), pv = project(axes.v);
    const double xx = pu[0] * pu[0] + pv[0] * pv[0] + 0.5, yy = pu[1] * pu[1] + pv[1] * pv[1] + 0.5,
                 xy = pu[0] * pu[1] + pv[0] * pv[1], determinant = xx * yy - xy * xy;
    const Vec3d n = cross(axes.u, axes.v);
    return [=](double x, double y) {
        const double dx = x - eye.window[0], dy = y - eye.window[1];
        const double q = (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / determinant;
        if (!(q <= 1)) return infinity;
        double inverse = 1 / eye.depth, depth = eye.depth;
        if (axes.lies) {
            const Vec3d step{dx / eye.focal[0], dy / eye.focal[1], 0};  // at the centre's depth
            Vec3d ray = parallel ? Vec3d{0, 0, -1} : eye.place / eye.depth;
            const double least = 0.02 * std::sqrt(dot(n, n)) * std::sqrt(dot(ray, ray));
            double towards = dot(n, ray);
            towards = towards < 0 ? std::min(towards, -least) : std::max(towards, least);
            const double offset = dot(n, step) / towards;  // relative to the depth where it is not parallel
            if (parallel)
                depth += std::clamp(offset, -r, r);
            else
                inverse += std::clamp(offset / (eye.depth * eye.depth), -r / (eye.depth * eye.depth),
                                      r / (eye.depth * eye.depth));
        }
        const double result = parallel ? depth + r * q : 1 / (inverse - r * q / (eye.depth * eye.depth));
        if (result < clip.near || !(eye.depth > clip.near && eye.depth < clip.far)) return infinity;
        return result > 0 && result < clip.far ? result : clip.far * 0.9999999;
    };
}

struct Shaped {
    std::vector<Disc> discs;
    std::vector<PointShape> shapes;
};

Shaped shaped_field(int count, double size)
{
    Shaped field{pcm::test::field(count, 1, size > 1 ? 1.5 : 0.8, size), {}};
    std::mt19937_64 random(17);
    std::normal_distribution<double> normal;
    for (int d = 0; d < count; ++d) {
        const Vec3d direction = normalised(Vec3d{normal(random), normal(random), normal(random)});
        switch (d % 4) {
            case 0:
                field.shapes.push_back(0);
                break;
            case 1:
                field.shapes.push_back(shape_of(Surroundings::surface, direction));
                if (d % 8 == 5) field.shapes.back() = with_steps(field.shapes.back(), 2 + d % 9, 1);
                break;
            case 2:
                field.shapes.push_back(volume_shape(0.05 * (d % 21)));
                break;
            default:
                field.shapes.push_back(shape_of(Surroundings::line, direction));
        }
    }
    return field;
}

Drawn fitted(const SplatScene& scene, const Camera& view, bool reversed = true, const ChunkLook& look = {})
{
    return draw(scene, view, style_of(SplatMode::fitted), reversed, look);
}

std::size_t count_covered(const Drawn& picture)
{
    return static_cast<std::size_t>(
        std::count_if(picture.colours.begin(), picture.colours.end(), [](const Pixel& p) { return p.a != 0; }));
}

// Pixels across and down of what is drawn.
std::array<int, 2> extent_of(const Drawn& picture)
{
    int low[2] = {width, height}, high[2] = {-1, -1};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (picture.colours[static_cast<std::size_t>(y * width + x)].a) {
                low[0] = std::min(low[0], x), high[0] = std::max(high[0], x);
                low[1] = std::min(low[1], y), high[1] = std::max(high[1], y);
            }
    return {high[0] - low[0] + 1, high[1] - low[1] + 1};
}

SplatScene one(PointShape shape, double radius, const Vec3d& at = {0.02, 0.01, -9})
{
    return SplatScene(fine_grid(), {{at, {0, 0, 1}, radius}}, fitted_format, {shape});
}

}  // namespace

// Not under the address sanitizer: much drawing in software.
TEST(FittedSplat, PCM_NOT_UNDER_ADDRESS(AgreesWithItsFormula))
{
    for (const Profile profile : {Profile::core, Profile::compatibility}) {
        PCM_REQUIRE_GL(context, profile);
        for (const double size : {0.04, 1.0, 12.0}) {
            const Shaped field = shaped_field(size < 1 ? 600 : 80, size);
            const SplatScene scene(fine_grid(), field.discs, fitted_format, field.shapes);
            for (const Camera& view : {perspective_view(), parallel_view()})
                for (const bool reversed : {true, false}) {
                    const bool parallel = view.projection[11] == 0;
                    if (!reversed && !parallel) continue;  // floats near 1 resolve less
                    SCOPED_TRACE(testing::Message() << "size " << size << (parallel ? ", parallel" : ", perspective")
                                                    << (reversed ? ", reversed" : ""));
                    std::vector<Splat> splats;
                    const std::vector<Disc> discs = scene.discs(view);
                    for (std::size_t d = 0; d < discs.size(); ++d)
                        splats.push_back(ellipse(view, discs[d], field.shapes[d]));
                    const auto truth = picture_of(view, splats, 0.03);
                    expect_same(fitted(scene, view, reversed), truth, view, reversed, size < 1 ? 300 : 500, 2e-4);
                }
        }
    }
}

// However small it is, and however it lies: no point vanishes.
TEST(FittedSplat, EveryPointCoversAPixel)
{
    PCM_REQUIRE_GL(context, Profile::core);
    std::mt19937_64 random(23);
    std::uniform_real_distribution<double> even(-0.5, 0.5);
    for (const double radius : {0.0, 1e-6, 0.01, 0.3})
        for (const PointShape shape :
             {0u, shape_of(Surroundings::surface, {1, 0, 0}), shape_of(Surroundings::surface, {0, 0.6, 0.8}),
              volume_shape(1), shape_of(Surroundings::line, {0, 1, 0}), shape_of(Surroundings::line, {0, 0, 1})})
            for (int i = 0; i < 5; ++i)
                for (const Camera& view : {perspective_view(), parallel_view()})
                    EXPECT_GE(count_covered(fitted(one(shape, radius, {even(random), even(random), -9}), view)), 1u)
                        << radius << " " << shape;
}

TEST(FittedSplat, AShapeIsSeenAsWhatItIs)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const Camera view = parallel_view();  // 16 pixels a unit
    const auto across = [&](PointShape shape) { return extent_of(fitted(one(shape, 1), view)); };
    const auto round = across(0);
    EXPECT_NEAR(round[0], 33, 2);
    EXPECT_NEAR(round[1], 33, 2);
    const auto level = across(shape_of(Surroundings::surface, {0, 1, 0}));  // seen edge-on
    EXPECT_NEAR(level[0], 30, 4);                                           // its tips are less than a pixel high
    EXPECT_LE(level[1], 3);
    const auto tilted = across(shape_of(Surroundings::surface, normalised(Vec3d{0, 1, 1})));
    EXPECT_NEAR(tilted[0], 33, 2);
    EXPECT_NEAR(tilted[1], 33 * 0.707, 2);
    const auto wire = across(shape_of(Surroundings::line, {1, 0, 0}));
    EXPECT_NEAR(wire[0], 33, 2);
    EXPECT_NEAR(wire[1], 33 * 0.25, 2);
    const auto leaf = across(volume_shape(1));
    EXPECT_NEAR(leaf[0], 10, 2);
    EXPECT_NEAR(leaf[1], 10, 2);
    EXPECT_EQ(across(volume_shape(0)), round);
}

// Where finer points are missing splats grow, among leaves less.
TEST(FittedSplat, GrowsToFillGaps)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const Camera view = parallel_view();
    ChunkLook look;
    look.least_radius = 0.25f;
    look.least_px = 100;
    const auto area = [&](PointShape shape) {
        return double(count_covered(fitted(one(shape, 0.01), view, true, look)));
    };
    EXPECT_NEAR(area(0), pi * 16.5, 8);
    EXPECT_NEAR(area(shape_of(Surroundings::surface, {0, 0, 1})), area(0), 6);
    EXPECT_NEAR(area(volume_shape(1)), pi * (5.76 + 0.5), 6);
    look.least_px = 4;
    EXPECT_NEAR(area(0), pi * 4.5, 5);
}

// Among equal splats in a plane that faces the view, the one whose centre is nearest is seen.
TEST(FittedSplat, TheNearestCentreIsSeen)
{
    PCM_REQUIRE_GL(context, Profile::core);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> even(-1, 1);
    Shaped field;
    for (int d = 0; d < 60; ++d) {
        field.discs.push_back({{4 * even(random), 3 * even(random), -9}, {0, 0, 1}, 2});
        field.shapes.push_back(shape_of(Surroundings::surface, {0, 0, 1}));
    }
    const SplatScene scene(fine_grid(), field.discs, fitted_format, field.shapes);
    const Camera view = parallel_view();
    std::vector<Eye> eyes;
    for (const Disc& disc : scene.discs(view)) eyes.push_back(eye_of(view, disc));
    const Drawn picture = fitted(scene, view);
    std::size_t covered = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Pixel& pixel = picture.colours[static_cast<std::size_t>(y * width + x)];
            if (pixel.a == 0) continue;
            ++covered;
            const auto away = [&](const Eye& e) { return std::hypot(x + 0.5 - e.window[0], y + 0.5 - e.window[1]); };
            double least = infinity;
            for (const Eye& e : eyes) least = std::min(least, away(e));
            EXPECT_LE(away(eyes[static_cast<std::size_t>(SplatScene::disc_of(pixel))]), least + 0.3);
        }
    EXPECT_GT(covered, 10000u);
}

// Radii whose lowest bits do not hold a shape are not read as one.
TEST(FittedSplat, WithoutShapesItIsAdaptive)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const SplatScene scene(fine_grid(), field(80, 1, 0.8, 1.0));
    const Camera view = perspective_view();
    EXPECT_EQ(fitted(scene, view).colours == draw(scene, view, style_of(SplatMode::adaptive)).colours, true);
}

// Sparse ground and walls next to the eye, whose discs would reach behind it: none of them covers what is before it.
TEST(FittedSplat, NothingNextToTheEyeHidesWhatIsBeforeIt)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const Camera view = perspective_view();
    for (const double radius : {0.5, 1.0, 2.0, 4.0, 30.0})
        for (const double ahead : {0.02, 0.1, 0.5, 1.0, 2.0})
            for (const auto& [side, normal] :
                 {std::pair{Vec3d{0, -1.6, 0}, Vec3d{0, 1, 0}}, std::pair{Vec3d{1.6, 0, 0}, Vec3d{-1, 0, 0}},
                  std::pair{Vec3d{-1.2, -1.2, 0}, normalised(Vec3d{1, 1, 0})}})
                for (const PointShape shape : {PointShape{0}, shape_of(Surroundings::surface, normal),
                                               shape_of(Surroundings::line, {0, 0, 1})}) {
                    const Vec3d at{side[0], side[1], -ahead};
                    const Drawn picture = fitted(one(shape, radius, at), view);
                    const Pixel& middle = picture.colours[static_cast<std::size_t>(height / 2 * width + width / 2)];
                    EXPECT_EQ(middle.a, 0) << radius << " " << ahead << " " << side[0] << " " << shape;
                }
}
