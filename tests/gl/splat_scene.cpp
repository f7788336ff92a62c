#include "tests/gl/splat_scene.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/view/vertex_discs.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

namespace pcm::test {

namespace {

Vec3d random_direction(std::mt19937_64& random)
{
    std::normal_distribution<double> normal;
    return {normal(random), normal(random), normal(random)};
}

}  // namespace

DepthFramebuffer::DepthFramebuffer(int width, int height, unsigned samples)
    : width_(width), height_(height), samples_(samples)
{
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    const auto storage = [&](GLuint& name, GLenum format, GLenum attachment) {
        glGenRenderbuffers(1, &name);
        glBindRenderbuffer(GL_RENDERBUFFER, name);
        if (samples > 1)
            glRenderbufferStorageMultisample(GL_RENDERBUFFER, static_cast<GLsizei>(samples), format, width, height);
        else
            glRenderbufferStorage(GL_RENDERBUFFER, format, width, height);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, name);
    };
    storage(colour_, GL_RGBA8, GL_COLOR_ATTACHMENT0);
    storage(depth_, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT);
    EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), static_cast<GLenum>(GL_FRAMEBUFFER_COMPLETE));
    glViewport(0, 0, width, height);
}

DepthFramebuffer::~DepthFramebuffer()
{
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(1, &colour_);
    glDeleteRenderbuffers(1, &depth_);
}

void DepthFramebuffer::clear(bool reversed) const
{
    glClearColor(0, 0, 0, 0);
    glClearDepth(reversed ? 0 : 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glClearDepth(1);
}

std::vector<Pixel> DepthFramebuffer::colours() const
{
    std::vector<Pixel> pixels(static_cast<std::size_t>(width_ * height_));
    if (samples_ > 1) {
        const Framebuffer resolved(width_, height_);
        GLint target = 0;
        glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
        glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
        glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
        glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(target));
        pixels = resolved.read();
    } else {
        glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    return pixels;
}

std::vector<float> DepthFramebuffer::depths() const
{
    std::vector<float> depths(static_cast<std::size_t>(width_ * height_));
    glReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
    return depths;
}

SplatScene::SplatScene(const Grid& grid, const std::vector<Disc>& source_discs, const VertexFormat& format,
                       const std::vector<PointShape>& shapes)
    : owner_(l1_.add_owner())
{
    info_.grid = grid;
    info_.levels = 1;
    ChunkPositions positions;
    Column radius(ScalarType::f64, 1), normal(ScalarType::f64, 3);
    radius.resize(source_discs.size());
    normal.resize(source_discs.size());
    std::vector<std::uint8_t> rgba;
    for (std::size_t d = 0; d < source_discs.size(); ++d) {
        const Disc& disc = source_discs[d];
        Vec3i place{};
        for (std::size_t a = 0; a < 3; ++a) place[a] = std::llround((disc.centre[a] - grid.offset[a]) / grid.scale[a]);
        places_.push_back(place);
        info_.box.extend(place);
        radius.as<double>()[d] = disc.radius;
        std::copy(disc.normal.begin(), disc.normal.end(), normal.as<double>() + 3 * d);
        const std::size_t number = d + 1;
        for (const std::size_t byte : {number & 255, (number >> 8) & 255, (number >> 16) & 255, std::size_t(255)})
            rgba.push_back(static_cast<std::uint8_t>(byte));
    }
    make_radii(radius, {"radius", ScalarType::f64}, radii_);
    make_normals(normal, {"normal", ScalarType::f64, 3}, normals_);
    positions.origin = info_.box.min;
    positions.wide = true;
    for (std::size_t a = 0; a < 3; ++a)
        for (const Vec3i& place : places_)
            positions.wide_xyz[a].push_back(static_cast<std::uint64_t>(place[a] - positions.origin[a]));
    l1_.begin_frame(owner_);
    VertexAttributes attributes{rgba.data(), radii_.data(), normals_.data()};
    if (!shapes.empty()) attributes.shapes = shapes.data();
    EXPECT_TRUE(l1_.upload(owner_, 0, make_vertices(positions, grid.scale, format, attributes)));
}

SplatScene::~SplatScene() { l1_.release(); }

const VertexEntry& SplatScene::entry() const { return *l1_.find(owner_, 0); }

std::vector<Disc> SplatScene::discs(const Camera& view) const
{
    std::vector<Disc> discs;
    for (std::size_t d = 0; d < places_.size(); ++d) {
        Disc disc;
        for (std::size_t a = 0; a < 3; ++a) {
            const double chunk =
                static_cast<double>(info_.box.min[a]) * info_.grid.scale[a] + (info_.grid.offset[a] - view.origin[a]);
            disc.centre[a] = chunk + static_cast<double>(static_cast<float>(
                                         static_cast<double>(places_[d][a] - info_.box.min[a]) * info_.grid.scale[a]));
            disc.normal[a] = static_cast<double>(normals_[3 * d + a]);
        }
        disc.radius = static_cast<double>(radii_[d]);
        discs.push_back(disc);
    }
    return discs;
}

void SplatScene::draw(const VertexEntry& entry, SplatPass& pass, const Camera& view, const CloudStyle& style,
                      bool reversed, unsigned samples, const ChunkLook& look, bool paraboloids) const
{
    const GlStateGuard state;
    glClipControl(GL_LOWER_LEFT, static_cast<GLenum>(reversed ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE));
    pass.begin(view, info_, style, reversed, samples, paraboloids);
    pass.draw(entry, look);
    pass.end();
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    EXPECT_EQ(drain_gl_errors(), "");
}

double depth_of(const Camera& view, bool reversed, float value)
{
    const double ndc = reversed ? 1 - 2 * static_cast<double>(value) : 2 * static_cast<double>(value) - 1;
    const Matrix& p = view.projection;
    // With reversed depth, forming 1 - ndc would cancel near 0.
    if (p[11] == 0) return (p[14] - ndc) / p[10];
    return reversed ? p[14] / ((1 + p[10]) - 2 * static_cast<double>(value)) : p[14] / (ndc + p[10]);
}

CloudStyle style_of(SplatMode mode)
{
    CloudStyle style;
    style.splats = mode;
    return style;
}

Drawn draw(const SplatScene& scene, const Camera& view, const CloudStyle& style, bool reversed, const ChunkLook& look,
           bool paraboloids)
{
    SplatPass pass;
    const DepthFramebuffer framebuffer(view.width, view.height);
    framebuffer.clear(reversed);
    scene.draw(pass, view, style, reversed, 1, look, paraboloids);
    Drawn picture{framebuffer.colours(), framebuffer.depths()};
    pass.release();
    return picture;
}

std::vector<Disc> field(std::size_t count, std::uint64_t seed, double wideness, double size)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> even(-1, 1);
    std::vector<Disc> discs;
    for (std::size_t d = 0; d < count; ++d) {
        const double depth = 6 + 4 * even(random);
        Vec3d normal = random_direction(random);
        normal[2] += normal[2] < 0 ? -1 : 1;  // not edge-on, neither exactly nor in the affine mode's approximation
        discs.push_back({{wideness * depth * even(random), wideness * 0.75 * depth * even(random), -depth},
                         normal,
                         (0.5 + 0.45 * even(random)) * size});
    }
    return discs;
}

Grid fine_grid() { return {{1e-6, 1e-6, 1e-6}, {0, 0, 0}}; }

Camera perspective_view() { return view_of(identity(), perspective(1, aspect, 0.1, 100), width, height); }
Camera parallel_view() { return view_of(translation(0.3, 0, 0), orthographic(5, 5 / aspect, 0.1, 20), width, height); }

Agreement compare(const SplatScene& scene, const Camera& view, bool reversed, bool doubles, double margin)
{
    SplatPass pass(doubles);
    const DepthFramebuffer framebuffer(view.width, view.height);
    framebuffer.clear(reversed);
    scene.draw(pass, view, style_of(SplatMode::perspective), reversed);
    const std::vector<Pixel> colours = framebuffer.colours();
    const std::vector<float> depths = framebuffer.depths();
    pass.release();

    const std::vector<Disc> discs = scene.discs(view);
    const DiscOracle oracle(view);
    const std::vector<DiscHit> truth = oracle.picture(discs, margin);
    Agreement agreement;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        agreement.not_numbers += std::isnan(depths[i]);
        if (!truth[i].certain) continue;
        ++agreement.certain;
        const int seen = SplatScene::disc_of(colours[i]);
        if ((seen >= 0) != (truth[i].disc >= 0)) {
            ++agreement.wrong_coverage;
            continue;
        }
        if (seen < 0) continue;
        ++agreement.covered;
        const Disc& disc = discs[static_cast<std::size_t>(truth[i].disc)];
        double size = 0;  // eye units per source unit
        for (std::size_t r = 0; r < 3; ++r) size += view.modelview[r] * view.modelview[r];
        const double radius = disc.radius * std::sqrt(size);
        // Either of two discs at equal depth may win.
        if (seen != truth[i].disc && truth[i].runner_up - truth[i].depth > 2e-4 * radius) ++agreement.wrong_disc;
        double ray = 1;  // length of the ray per depth of 1
        if (view.projection[11] != 0) {
            const double x = (2 * (static_cast<double>(i % static_cast<std::size_t>(view.width)) + 0.5) / view.width -
                              1 + view.projection[8]) /
                             view.projection[0];
            const double y = (2 * (static_cast<double>(i / static_cast<std::size_t>(view.width)) + 0.5) / view.height -
                              1 + view.projection[9]) /
                             view.projection[5];
            ray = std::sqrt(1 + x * x + y * y);
        }
        agreement.worst_depth = std::max(agreement.worst_depth,
                                         std::abs(depth_of(view, reversed, depths[i]) - truth[i].depth) * ray / radius);
    }
    return agreement;
}

}  // namespace pcm::test
