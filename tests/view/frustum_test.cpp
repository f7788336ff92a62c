// Culling and projected sizes against plain projection, in long double where digits count.
#include "pcm/view/frustum.h"

#include "tests/sanitizers.h"
#include "tests/view/random_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

using Long = long double;  // 64 bits of mantissa: 2048 times finer than double
static_assert(std::numeric_limits<Long>::digits >= 64);

// Clip coordinates, and the same sums over absolute values, which bound the rounding error of the computation in
// double.
struct ClipSums {
    std::array<Long, 4> value{}, bound{};
};

ClipSums exact_clip(const Camera& view, const Vec3d& source)
{
    const auto absolute = [](const Matrix4d& m) {
        Matrix4d result = m;
        for (double& v : result) v = std::abs(v);
        return result;
    };
    const auto apply = [](const Matrix4d& m, const std::array<Long, 4>& v) {
        std::array<Long, 4> r{};
        for (std::size_t row = 0; row < 4; ++row)
            for (std::size_t column = 0; column < 4; ++column) r[row] += m[column * 4 + row] * v[column];
        return r;
    };
    std::array<Long, 4> local{0, 0, 0, 1}, size{0, 0, 0, 1};
    for (std::size_t a = 0; a < 3; ++a) {
        local[a] = static_cast<Long>(source[a]) - view.origin[a];
        size[a] = std::abs(static_cast<Long>(source[a])) + std::abs(static_cast<Long>(view.origin[a]));
    }
    // A common factor of an affine matrix has no effect.
    Camera scaled = view;
    for (double& v : scaled.modelview) v /= view.modelview[15];
    return {apply(view.projection, apply(scaled.modelview, local)),
            apply(absolute(view.projection), apply(absolute(scaled.modelview), size))};
}

Vec3d corner_of(const Box3d& box, unsigned number)
{
    return {number & 1 ? box.max[0] : box.min[0], number & 2 ? box.max[1] : box.min[1],
            number & 4 ? box.max[2] : box.min[2]};
}

class Random {
public:
    explicit Random(std::uint64_t seed) : random_(seed) {}
    std::mt19937_64& engine() { return random_; }
    double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
    double power(double low, double high) { return std::pow(10.0, low + (high - low) * unit()); }
    Vec3d near(const Vec3d& place, double spread)
    {
        return place + spread * Vec3d{unit() - 0.5, unit() - 0.5, unit() - 0.5};
    }

private:
    std::mt19937_64 random_;
};

// Cameras at map coordinates with a local origin there, elsewhere or at 0; near planes down to 1e-6 of the scene;
// perspective (also off-axis) and orthographic; matrices with a common factor.
struct StiffView {
    Camera view;
    Vec3d place;
    double reach;
};

StiffView stiff_view(Random& random, int i)
{
    StiffView stiff;
    const Vec3d far{500000, 5000000, 100};
    stiff.place = i % 4 == 3 ? Vec3d{0, 0, 0} : far;
    const Vec3d origin = i % 4 == 0 ? Vec3d{0, 0, 0} : i % 4 == 1 ? random.near(far, 2000) : stiff.place;
    stiff.reach = random.power(-2, 3);
    stiff.view = random_view(random.engine(), random.near(stiff.place, stiff.reach), origin, stiff.reach);
    if (i % 5 == 0)
        for (double& v : stiff.view.modelview) v *= i % 2 ? -4 : 0.25;
    return stiff;
}

}  // namespace

TEST(Frustum, NeverDropsABoxWithAVisiblePoint)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    std::size_t visible = 0;
    std::size_t culled = 0;
    for (int i = 0; visible < 10000; ++i) {
        ASSERT_LT(i, 2000000);
        const Vec3d origin = i % 3 == 0 ? Vec3d{0, 0, 0} : Vec3d{500000, 5000000, 100};
        const Vec3d place = i % 3 == 1 ? origin : Vec3d{500000, 5000000, 100};  // far from the local origin at times
        const double reach = std::pow(10.0, 5 * unit(random) - 2);
        const auto near_place = [&](double spread) {
            return Vec3d{place[0] + spread * (unit(random) - 0.5), place[1] + spread * (unit(random) - 0.5),
                         place[2] + spread * (unit(random) - 0.5)};
        };
        const Camera view = random_view(random, near_place(reach), origin, reach);
        const auto frustum = Frustum::of(view);
        ASSERT_TRUE(frustum);
        Vec3d point = near_place(reach);
        auto c = clip(view, point);
        if (i % 2 == 0 && is_visible(c)) {
            // Move towards the border of the clip volume by bisection: the hard cases lie there.
            Vec3d outside = near_place(20 * reach);
            if (!is_visible(clip(view, outside))) {
                for (int step = 0; step < 80; ++step) {
                    Vec3d middle{};
                    for (std::size_t a = 0; a < 3; ++a) middle[a] = point[a] + (outside[a] - point[a]) / 2;
                    (is_visible(clip(view, middle)) ? point : outside) = middle;
                }
                c = clip(view, point);
            }
        }
        Box3d box;
        box.extend(point);
        const int shape = i % 4;  // a point, a line, a flat box, a box; the point in a corner or inside
        for (int a = 0; a < shape; ++a) {
            const double size = reach * std::pow(10.0, -3 * unit(random));
            box.min[a] -= unit(random) < 0.5 ? 0 : size * unit(random);
            box.max[a] += unit(random) < 0.5 ? 0 : size * unit(random);
        }
        if (is_visible(c)) {
            ++visible;
            ASSERT_TRUE(frustum->intersects(box)) << "case " << i;
        } else {
            culled += !frustum->intersects(box);
        }
    }
    EXPECT_GT(culled, 1000u);  // it does cull
}

TEST(Frustum, CullsWhatIsBeyondOnePlane)
{
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    std::size_t outside = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3d place{500000, 5000000, 100};
        const Camera view = random_view(random, place, place, 10);
        Box3d box;
        for (int corner = 0; corner < 2; ++corner)
            box.extend(Vec3d{place[0] + 40 * (unit(random) - 0.5), place[1] + 40 * (unit(random) - 0.5),
                             place[2] + 40 * (unit(random) - 0.5)});
        // All eight corners beyond one plane by more than the rounding at map coordinates.
        bool beyond = false;
        for (std::size_t axis = 0; axis < 3 && !beyond; ++axis)
            for (const double sign : {-1.0, 1.0}) {
                bool all = true;
                for (int corner = 0; corner < 8; ++corner) {
                    const auto c =
                        clip(view, {corner & 1 ? box.max[0] : box.min[0], corner & 2 ? box.max[1] : box.min[1],
                                    corner & 4 ? box.max[2] : box.min[2]});
                    all = all && sign * c[axis] > c[3] + 1e-6 * (std::abs(c[axis]) + std::abs(c[3]) + 1);
                }
                beyond = beyond || all;
            }
        if (!beyond) continue;
        ++outside;
        EXPECT_FALSE(Frustum::of(view)->intersects(box)) << "case " << i;
    }
    EXPECT_GT(outside, 1000u);
}

TEST(Frustum, PixelsAreThoseOfAProjectedSegment)
{
    // A segment across the view: on the axis at distance d in perspective, anywhere in orthographic views. The
    // projection is the oracle; 1e-6 is the relative rounding error of half a metre at coordinates of 5e6 after two
    // projections.
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 2000; ++i) {
        const Vec3d eye{500000, 5000000, 100};
        const Vec3d origin = i % 2 ? eye : Vec3d{0, 0, 0};
        const Matrix4d turn = rotation(random);
        const double scale = std::pow(10.0, 2 * unit(random) - 1);
        Camera view;
        view.origin = origin;
        view.width = 900;
        view.height = 600;
        view.modelview = product(
            turn, product(scaling(scale), translation({origin[0] - eye[0], origin[1] - eye[1], origin[2] - eye[2]})));
        const bool ortho = i % 4 >= 2;
        view.projection = ortho ? orthographic(3, 2, 1e-6, 1000) : perspective(-3e-6, 3e-6, -2e-6, 2e-6, 2e-6, 1e6);
        const double distance = 1 + 50 * unit(random);
        const Vec3d right{turn[0], turn[4], turn[8]};
        const Vec3d back{turn[2], turn[6], turn[10]};
        const double length = 0.5;
        Vec3d a{}, b{};
        for (std::size_t k = 0; k < 3; ++k) {
            a[k] = eye[k] - distance * back[k];
            b[k] = a[k] + length * right[k];
        }
        const auto ca = clip(view, a);
        const auto cb = clip(view, b);
        const double expected = (cb[0] / cb[3] - ca[0] / ca[3]) * view.width / 2;
        Box3d box;
        box.extend(a);
        const auto frustum = Frustum::of(view);
        EXPECT_EQ(frustum->orthographic(), ortho);
        EXPECT_NEAR(frustum->pixels(length, box), expected, 1e-6 * expected);
    }
}

TEST(Frustum, TheEyeInsideABoxGivesAFiniteSizeLimitedByTheNearPlane)
{
    Camera view;
    view.modelview = identity();
    view.projection = perspective(-1e-6, 1e-6, -1e-6, 1e-6, 1e-6, 1);
    view.width = view.height = 1000;
    Box3d box;
    box.extend(Vec3d{-1, -1, -1});
    box.extend(Vec3d{1, 1, 1});
    const auto frustum = Frustum::of(view);
    ASSERT_TRUE(frustum);
    EXPECT_NEAR(frustum->pixels(1e-6, box), 500, 1e-3);  // half the viewport at the near plane
    EXPECT_EQ(frustum->pixels(0, box), 0);
}

TEST(Frustum, RefusesViewsThatShowNothing)
{
    Camera view;
    view.modelview = identity();
    view.projection = orthographic(1, 1, -1, 1);
    view.width = view.height = 10;
    EXPECT_TRUE(Frustum::of(view));
    Camera bad = view;
    bad.width = 0;
    EXPECT_FALSE(Frustum::of(bad));
    bad = view;
    bad.modelview[0] = std::nan("");
    EXPECT_FALSE(Frustum::of(bad));
    bad = view;
    bad.modelview[5] = 0;  // singular
    EXPECT_FALSE(Frustum::of(bad));
    bad = view;
    bad.modelview[3] = 1;  // not affine
    EXPECT_FALSE(Frustum::of(bad));
    bad = view;
    bad.projection[10] = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(Frustum::of(bad));
}

// contains() is true only when the long double projection puts every corner inside; intersects() is false only when one
// plane of the clip volume has every corner beyond. Both decide as soon as the corners are off by more than rounding.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(Frustum, PCM_NOT_UNDER_THREAD(ClassifiesBoxesAsExactProjectionDoes))
{
    Random random(11);
    std::size_t inside = 0, outside = 0, undecided = 0;
    constexpr Long epsilon = std::numeric_limits<double>::epsilon();
    for (int i = 0; i < 60000; ++i) {
        const StiffView stiff = stiff_view(random, i);
        const auto frustum = Frustum::of(stiff.view);
        ASSERT_TRUE(frustum) << i;
        // Boxes of all sizes, half of them near the eye.
        Box3d box;
        const Vec3d middle = random.near(i % 2 ? frustum->eye() : stiff.place, stiff.reach * random.power(-3, 1));
        const double size = stiff.reach * random.power(-6, 0);
        for (int corner = 0; corner < 2; ++corner) box.extend(random.near(middle, size));

        bool all_inside = true, surely_inside = true, beyond = false, surely_beyond = false;
        std::array<ClipSums, 8> corners;
        for (unsigned c = 0; c < 8; ++c) corners[c] = exact_clip(stiff.view, corner_of(box, c));
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const Long sign : {Long(-1), Long(1)}) {
                bool all_beyond = true, all_surely_beyond = true;
                for (const ClipSums& c : corners) {
                    const Long above = c.value[3] + sign * c.value[axis];  // >= 0 inside
                    const Long margin = 64 * epsilon * (c.bound[3] + c.bound[axis]);
                    all_inside = all_inside && above >= 0;
                    surely_inside = surely_inside && above > margin;
                    all_beyond = all_beyond && above < 0;
                    all_surely_beyond = all_surely_beyond && above < -margin;
                }
                beyond = beyond || all_beyond;
                surely_beyond = surely_beyond || all_surely_beyond;
            }
        if (frustum->contains(box)) ASSERT_TRUE(all_inside) << i;
        if (!frustum->intersects(box)) ASSERT_TRUE(beyond) << i;
        if (surely_inside) ASSERT_TRUE(frustum->contains(box)) << i;
        if (surely_beyond) ASSERT_FALSE(frustum->intersects(box)) << i;
        if (frustum->contains(box)) ASSERT_TRUE(frustum->intersects(box)) << i;
        inside += surely_inside;
        outside += surely_beyond;
        undecided += !surely_inside && !surely_beyond;
    }
    EXPECT_GT(inside, 500u);
    EXPECT_GT(outside, 500u);
    EXPECT_GT(undecided, 500u);
}

TEST(Frustum, TheEyeIsWhereTheModelviewPutsZero)
{
    Random random(12);
    for (int i = 0; i < 3000; ++i) {
        const StiffView stiff = stiff_view(random, i);
        const auto frustum = Frustum::of(stiff.view);
        ASSERT_TRUE(frustum);
        const Matrix4d& m = stiff.view.modelview;
        const Vec3d eye = frustum->local_eye();
        for (std::size_t r = 0; r < 3; ++r) {
            Long sum = m[12 + r], size = std::abs(m[12 + r]);
            for (std::size_t c = 0; c < 3; ++c) {
                sum += static_cast<Long>(m[c * 4 + r]) * eye[c];
                size += std::abs(static_cast<Long>(m[c * 4 + r]) * eye[c]);
            }
            // Gaussian elimination with pivoting on a rotation with scale: a few roundings per row.
            ASSERT_LE(std::abs(sum), 32 * std::numeric_limits<double>::epsilon() * size) << i;
        }
        EXPECT_EQ(frustum->eye(), stiff.view.origin + eye);
    }
}

// The same for stiff cameras, with the segment's ends moved by the origin so that they are not rounded.
TEST(Frustum, PixelsAreThoseOfAProjectedSegmentInStiffViews)
{
    Random random(13);
    std::size_t compared = 0;
    for (int i = 0; i < 20000; ++i) {
        const StiffView stiff = stiff_view(random, i);
        const auto frustum = Frustum::of(stiff.view);
        ASSERT_TRUE(frustum);
        const Vec3d point = random.near(frustum->eye(), stiff.reach);
        const ClipSums clip = exact_clip(stiff.view, point);
        // Not where the rounding of the point's coordinates is of the size of its depth.
        if (!(clip.value[3] > 1e-9L * clip.bound[3]) || std::abs(clip.value[2]) > clip.value[3]) continue;
        if (std::abs(clip.value[0]) > 1e-3L * clip.value[3] || std::abs(clip.value[1]) > 1e-3L * clip.value[3])
            if (!frustum->orthographic()) continue;  // off the axis the same depth is farther away
        Box3d box;
        box.extend(point);
        const double size = stiff.reach * 1e-3;
        const Matrix4d& m = stiff.view.modelview;
        const Vec3d right{m[0], m[4], m[8]}, across = (size / length(right)) * right;
        const auto on_screen = [&](const Vec3d& at, double sign) {
            Camera moved = stiff.view;  // the segment's end relative to the point, without rounding it
            moved.origin = stiff.view.origin - (sign / 2) * across;
            const ClipSums c = exact_clip(moved, at);
            return c.value[0] / c.value[3] * stiff.view.width / 2;
        };
        const Long seen = std::abs(on_screen(point, 1) - on_screen(point, -1));
        ASSERT_NEAR(frustum->pixels(size, box) / static_cast<double>(seen), 1, 1e-4) << i;
        ++compared;
    }
    EXPECT_GT(compared, 100u);
}

TEST(Frustum, ACommonFactorOfTheModelviewChangesNothing)
{
    Random random(14);
    for (int i = 0; i < 1000; ++i) {
        const StiffView stiff = stiff_view(random, 1);
        const auto frustum = Frustum::of(stiff.view);
        Camera scaled = stiff.view;
        for (double& v : scaled.modelview) v *= -0.5;  // a power of two: the same digits
        const auto same = Frustum::of(scaled);
        ASSERT_TRUE(frustum && same);
        Box3d box;
        for (int corner = 0; corner < 2; ++corner) box.extend(random.near(stiff.place, stiff.reach));
        EXPECT_EQ(same->intersects(box), frustum->intersects(box));
        EXPECT_EQ(same->contains(box), frustum->contains(box));
        EXPECT_EQ(same->pixels(1, box), frustum->pixels(1, box));
    }
}

TEST(Frustum, AnySingularModelviewIsRefusedInAnyUnit)
{
    Random random(15);
    for (const double unit : {1e-100, 1e-3, 1.0, 1e100}) {
        Camera view;
        view.projection = perspective(-1, 1, -1, 1, 1, 10);
        view.width = view.height = 100;
        view.modelview = rotation(random.engine());
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t r = 0; r < 3; ++r) view.modelview[c * 4 + r] *= unit;
        EXPECT_TRUE(Frustum::of(view)) << unit;
        for (std::size_t gone = 0; gone < 3; ++gone) {
            Camera flat = view;  // one row is the sum of the others
            for (std::size_t c = 0; c < 3; ++c)
                flat.modelview[c * 4 + gone] =
                    view.modelview[c * 4 + (gone + 1) % 3] + view.modelview[c * 4 + (gone + 2) % 3];
            EXPECT_FALSE(Frustum::of(flat)) << unit << ", row " << gone;
        }
    }
}
