#include "tests/gl/gl_support.h"

#include "pcm/build/builder.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace pcm::test {

Framebuffer::Framebuffer(int width, int height) : width_(width), height_(height)
{
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glGenRenderbuffers(1, &colour_);
    glBindRenderbuffer(GL_RENDERBUFFER, colour_);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
    glGenRenderbuffers(1, &depth_);
    glBindRenderbuffer(GL_RENDERBUFFER, depth_);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
    EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), static_cast<GLenum>(GL_FRAMEBUFFER_COMPLETE));
    glViewport(0, 0, width, height);
    clear();
}

Framebuffer::~Framebuffer()
{
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(1, &colour_);
    glDeleteRenderbuffers(1, &depth_);
}

void Framebuffer::bind() const { glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_); }

void Framebuffer::clear() const
{
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

std::vector<Pixel> Framebuffer::read() const
{
    std::vector<Pixel> pixels(static_cast<std::size_t>(width_ * height_));
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    return pixels;
}

Matrix identity() { return translation(0, 0, 0); }

Matrix translation(double x, double y, double z) { return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1}; }

Matrix rotation_x(double radians)
{
    const double c = std::cos(radians);
    const double s = std::sin(radians);
    return {1, 0, 0, 0, 0, c, s, 0, 0, -s, c, 0, 0, 0, 0, 1};
}

Matrix perspective(double vertical_angle, double aspect, double near, double far)
{
    const double f = 1 / std::tan(vertical_angle / 2);
    return {
        f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near),
        0};
}

Matrix orthographic(double half_width, double half_height, double near, double far)
{
    return {1 / half_width,
            0,
            0,
            0,
            0,
            1 / half_height,
            0,
            0,
            0,
            0,
            -2 / (far - near),
            0,
            0,
            0,
            -(far + near) / (far - near),
            1};
}

Camera view_of(const Matrix& modelview, const Matrix& projection, int width, int height, const Vec3d& origin)
{
    Camera view;
    view.modelview = modelview;
    view.projection = projection;
    view.width = width;
    view.height = height;
    view.origin = origin;
    return view;
}

std::shared_ptr<PointCloud> make_cloud(const TemporaryFolder& folder, const std::string& name, const Grid& grid,
                                       const std::vector<LasPoint>& points, std::uint32_t chunk_points)
{
    write_las_points(folder / (name + ".las"), grid, points);
    BuildOptions options;
    options.chunk_points = chunk_points;
    options.threads = 2;
    options.memory_bytes = std::uint64_t(128) << 20;
    build_tree({folder / (name + ".las")}, folder / (name + ".pct"), options);
    return PointCloud::open(folder / (name + ".pct"));
}

Drawing::Drawing(std::shared_ptr<PointCloud> cloud, const L1Options& l1)
    : Drawing(std::move(cloud), std::make_shared<L1Cache>(l1))
{
    l1_is_own_ = true;
}

Drawing::Drawing(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1)
    : drawn(std::move(cloud), l1), renderer(l1)
{
    style.colour = ColourMode::uniform;
    style.uniform_colour = {1, 1, 1};
}

FrameReport Drawing::draw(const Camera& view, const Vec3d& origin, const RenderOptions& options)
{
    SceneItem item;
    item.cloud = &drawn;
    item.origin = origin;
    item.style = style;
    return renderer.draw(picture, view, {item}, options);
}

void Drawing::release()
{
    picture.release();
    renderer.release();
    drawn.release();
    if (l1_is_own_) l1()->release();
}

std::vector<LasPoint> random_points(std::size_t count, std::int32_t extent, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::vector<LasPoint> points(count);
    for (LasPoint& p : points) {
        p.x = static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(extent));
        p.y = static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(extent));
        p.z = static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(extent));
        p.red = static_cast<std::uint16_t>(random());
        p.green = static_cast<std::uint16_t>(random());
        p.blue = static_cast<std::uint16_t>(random());
        p.intensity = static_cast<std::uint16_t>(random() % 3000);
    }
    return points;
}

Matrix overview(double extent)
{
    return product(translation(0, 0, -3 * extent),
                   product(rotation_x(-0.9), translation(-extent / 2, -extent / 2, -extent / 2)));
}

RenderOptions everything()
{
    RenderOptions options;
    options.target_spacing_px = 0;
    options.frame_budget_ms = 1e9;  // the picture does not depend on the machine's speed
    options.upload_budget_ms = 1000;
    options.eye_dome = 0;
    return options;
}

FrameReport draw_until_done(Drawing& drawing, const Framebuffer& framebuffer, const Camera& view, const Vec3d& origin,
                            const RenderOptions& options, int most)
{
    FrameReport report;
    for (int frame = 0; frame < most; ++frame) {
        framebuffer.clear();
        report = drawing.draw(view, origin, options);
        if (!report.error.empty()) {
            ADD_FAILURE() << report.error;
            return report;
        }
        if (!report.refining) return report;
        if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "still refining after " << most << " frames";
    return report;
}

std::size_t count_lit(const std::vector<Pixel>& pixels)
{
    return static_cast<std::size_t>(
        std::count_if(pixels.begin(), pixels.end(), [](const Pixel& p) { return p.a > 0; }));
}

}  // namespace pcm::test
