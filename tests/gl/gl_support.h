// A framebuffer to draw into, and small trees to draw.
#pragma once

#include "tests/las_points.h"
#include "tests/offscreen_support.h"
#include "tests/support.h"

#include "pcm/gl/draw/renderer.h"

#include <GL/glew.h>

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace pcm::test {

using Profile = OffscreenProfile;

struct Pixel {
    std::uint8_t r, g, b, a;
    bool operator==(const Pixel& o) const { return r == o.r && g == o.g && b == o.b && a == o.a; }
};

// Colour and depth, bound and its viewport set while it lives. Row 0 is the lowest.
class Framebuffer {
public:
    Framebuffer(int width, int height);
    ~Framebuffer();
    Framebuffer(const Framebuffer&) = delete;
    Framebuffer& operator=(const Framebuffer&) = delete;
    void bind() const;  // again, after another framebuffer was bound
    void clear() const;
    std::vector<Pixel> read() const;
    int width() const { return width_; }
    int height() const { return height_; }

private:
    int width_, height_;
    GLuint framebuffer_ = 0, colour_ = 0, depth_ = 0;
};

// Column-major matrices.
using Matrix = std::array<double, 16>;
Matrix identity();
Matrix translation(double x, double y, double z);
Matrix rotation_x(double radians);
Matrix perspective(double vertical_angle, double aspect, double near, double far);
Matrix orthographic(double half_width, double half_height, double near, double far);
Camera view_of(const Matrix& modelview, const Matrix& projection, int width, int height,
               const Vec3d& origin = {0, 0, 0});

// Writes the points as LAS on the grid, builds a tree and opens it.
std::shared_ptr<PointCloud> make_cloud(const TemporaryFolder& folder, const std::string& name, const Grid& grid,
                                       const std::vector<LasPoint>& points, std::uint32_t chunk_points = 5000);

// One cloud in one view, with everything needed to draw it. White squares of two pixels unless the style is changed.
// Constant splats of two pixels: pictures that a test can work out.
inline CloudStyle constant_squares()
{
    CloudStyle style;
    style.splats = SplatMode::constant;
    return style;
}

class Drawing {
public:
    explicit Drawing(std::shared_ptr<PointCloud> cloud, const L1Options& l1 = {});
    Drawing(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1);
    FrameReport draw(const Camera& view, const Vec3d& origin, const RenderOptions& options);
    void set_wake(std::function<void()> wake) { drawn.set_wake(std::move(wake)); }
    const std::shared_ptr<L1Cache>& l1() const { return drawn.l1(); }
    void release();  // an L1 of its own too

    CloudStyle style = constant_squares();
    DrawnCloud drawn;
    Renderer renderer;
    Picture picture;

private:
    bool l1_is_own_ = false;
};

// The usual scene: a cube of random points at map coordinates, a view of it from above and in front, and no budgets.
inline constexpr Vec3d map_offset{500000, 5000000, 100};
std::vector<LasPoint> random_points(std::size_t count, std::int32_t extent, std::uint64_t seed);
// `count` x `count` points, 0.1 apart, in a plane z = height(x).
template <class Height>
std::vector<LasPoint> sheet(std::int32_t count, const Height& height)
{
    std::vector<LasPoint> points;
    for (std::int32_t y = 0; y < count; ++y)
        for (std::int32_t x = 0; x < count; ++x) {
            LasPoint p;
            p.x = 100 * x;
            p.y = 100 * y;
            p.z = height(x);
            points.push_back(p);
        }
    return points;
}

inline Grid grid_at(const Vec3d& offset, double scale = 0.001) { return {{scale, scale, scale}, offset}; }
Matrix overview(double extent);  // view of the cube of this side at the local origin
RenderOptions everything();

std::size_t count_lit(const std::vector<Pixel>& pixels);

// Draws until the picture is final and returns the last report. Fails the test after `most` frames.
FrameReport draw_until_done(Drawing& drawing, const Framebuffer& framebuffer, const Camera& view, const Vec3d& origin,
                            const RenderOptions& options, int most = 5000);

}  // namespace pcm::test

// Skips the test, with the reason, where no context can be made.
#define PCM_REQUIRE_GL(name, profile)                                         \
    std::string name##_why;                                                   \
    const auto name = pcm::test::make_offscreen(16, 16, name##_why, profile); \
    if (!name) GTEST_SKIP() << name##_why
