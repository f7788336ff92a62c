#include "pcm/gl/base/render_target.h"

#include "pcm/system/error.h"

#include <GL/glew.h>

#include <algorithm>
#include <string>
#include <vector>

namespace pcm {
namespace {

unsigned samples_of_driver()
{
    GLint colour = 1, depth = 1;
    glGetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &colour);
    glGetIntegerv(GL_MAX_DEPTH_TEXTURE_SAMPLES, &depth);
    return static_cast<unsigned>(std::clamp(std::min(colour, depth), 1, RenderTarget::most_samples));
}

GLuint make_texture(GLenum format, GLenum components, GLenum type, int width, int height, unsigned samples)
{
    GLuint texture = 0;
    glGenTextures(1, &texture);
    if (samples > 1) {
        glBindTexture(GL_TEXTURE_2D_MULTISAMPLE, texture);
        glTexImage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, static_cast<GLsizei>(samples), format, width, height,
                                GL_TRUE);
    } else {
        glBindTexture(GL_TEXTURE_2D, texture);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
        glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0, components, type, nullptr);
    }
    return texture;
}

GLenum texture_target(const RenderTarget& picture)
{
    return picture.samples() > 1 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D;
}

// For drawing in the host's viewport: depth tested, partly covered pixels blended.
void begin_in_host(const ShaderProgram& program, const GlStateGuard& host)
{
    glBindFramebuffer(GL_FRAMEBUFFER, host.framebuffer());
    glViewport(host.viewport()[0], host.viewport()[1], host.viewport()[2], host.viewport()[3]);
    glDepthFunc(GL_LEQUAL);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glUseProgram(program.id());
    glUniform2i(program.uniform("corner"), host.viewport()[0], host.viewport()[1]);
    glUniform2f(program.uniform("depth_range"), host.depth_range()[0], host.depth_range()[1]);
}

void set_finish(const ShaderProgram& composite, const RenderTarget& from, const Matrix4d& projection,
                const Finish& finish)
{
    if (!finish.needs_one_sample()) return;
    const std::array<double, 4> k = distance_of_depth(projection);
    glUniform4f(composite.uniform("distance_of_depth"), static_cast<float>(k[0]), static_cast<float>(k[1]),
                static_cast<float>(k[2]), static_cast<float>(k[3]));
    const bool orthographic = projection[3] == 0 && projection[7] == 0 && projection[11] == 0;
    const double height = projection[5] != 0 ? std::abs(2 * projection[15] / projection[5]) : 0;
    glUniform1f(composite.uniform("relief_of_distance"),
                orthographic && height > 0 ? static_cast<float>(1 / height) : 0.0f);
    // A pixel over the distance, or over the visible height.
    const double slope = projection[5] != 0 ? std::abs(2 / projection[5]) : 0;
    glUniform1f(composite.uniform("relief_of_pixel"), static_cast<float>((orthographic ? 1 : slope) / from.height()));
    if (finish.eye_dome > 0) glUniform1f(composite.uniform("strength"), finish.eye_dome);
    glUniform2i(composite.uniform("size"), from.width(), from.height());
}

}  // namespace

bool RenderTarget::prepare(int width, int height, unsigned samples)
{
    if (framebuffer_ && width == width_ && height == height_ && samples == asked_samples_) return false;
    release();
    drain_gl_errors();
    width_ = width;
    height_ = height;
    asked_samples_ = samples;
    samples_ = samples > 1 ? std::min(samples, samples_of_driver()) : 1;
    reversed_ = gl_has_clip_control();
    const GLenum target = samples_ > 1 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D;
    colours_ = make_texture(GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, width, height, samples_);
    depths_ = make_texture(GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, width, height, samples_);
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, target, colours_, 0);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, target, depths_, 0);
    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    const std::string errors = drain_gl_errors();
    if (status != GL_FRAMEBUFFER_COMPLETE || !errors.empty()) {
        release();
        throw Error(ErrorCode::unsupported, {},
                    "the driver cannot make a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                        " pixels with " + std::to_string(samples) + " samples each" +
                        (errors.empty() ? "" : ": OpenGL error " + errors),
                    "ask for fewer samples or a smaller picture");
    }
    return true;
}

void RenderTarget::bind() const
{
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, width_, height_);
}

void RenderTarget::clear() const
{
    glClearColor(0, 0, 0, 0);
    glClearDepth(reversed_ ? 0 : 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void RenderTarget::release()
{
    if (framebuffer_) glDeleteFramebuffers(1, &framebuffer_);
    if (colours_) glDeleteTextures(1, &colours_);
    if (depths_) glDeleteTextures(1, &depths_);
    *this = RenderTarget();
}

std::array<double, 4> distance_of_depth(const Matrix4d& p)
{
    // z_ndc = (p10 z + p14) / (p11 z + p15), d = (1 - z_ndc) / 2, distance = -z.
    return {p[14] - p[15], 2 * p[15], p[10] - p[11], 2 * p[11]};
}

bool ColourTarget::begin(int width, int height)
{
    drain_gl_errors();
    if (!framebuffer_ || width != width_ || height != height_) {
        release();
        width_ = width;
        height_ = height;
        if (content_ == sums) {
            texture_ = make_texture(GL_RGBA32F, GL_RGBA, GL_FLOAT, width, height, 1);
        } else {
            texture_ = make_texture(GL_R8, GL_RED, GL_UNSIGNED_BYTE, width, height, 1);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        }
        glGenFramebuffers(1, &framebuffer_);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
        if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || !drain_gl_errors().empty()) {
            release();
            return false;
        }
    }
    bind();
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    return true;
}

void ColourTarget::bind() const
{
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, width_, height_);
}

void ColourTarget::release()
{
    if (framebuffer_) glDeleteFramebuffers(1, &framebuffer_);
    if (texture_) glDeleteTextures(1, &texture_);
    *this = ColourTarget(content_);
}

const ShaderProgram& Compositor::program(const RenderTarget& picture, Into into, const Finish& finish, bool resolved)
{
    const unsigned samples = picture.samples(), every = !(finish.eye_dome > 0) ? 0 : finish.fast ? 2 : 1;
    ShaderProgram& program = programs_[{samples, resolved, picture.reversed(), into, every, finish.close_gaps}];
    if (!program) {
        std::vector<std::string> defines;
        if (samples > 1) defines.push_back("SAMPLES " + std::to_string(samples));
        if (resolved) defines.emplace_back("RESOLVED");
        if (picture.reversed()) defines.emplace_back("REVERSED");
        if (every > 0) defines.push_back("EYE_DOME " + std::to_string(every));
        if (finish.close_gaps) defines.emplace_back("CLOSE_GAPS");
        if (into == another_target) defines.emplace_back("RESOLVE");
        if (into == a_sum) defines.emplace_back("SUM");
        if (into == shades_of_it) defines.emplace_back("SHADES");
        if (into == the_host_shaded) defines.emplace_back("SHADED");
        program = ShaderProgram("composite.vert", into == the_host_mean ? "mean.frag" : "composite.frag", defines);
    }
    return program;
}

void Compositor::run(const ShaderProgram& program, const char* colours, std::uint32_t of_colours,
                     std::uint32_t colour_target, const RenderTarget& depths)
{
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(colour_target, of_colours);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(texture_target(depths), depths.depths());
    glUniform1i(program.uniform(colours), 0);
    glUniform1i(program.uniform("depths"), 1);
    // Made anew each time: contexts of a share group do not share vertex arrays.
    GLuint vertex_array = 0;
    glGenVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    if (gl_has_clip_control()) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
    glDeleteVertexArrays(1, &vertex_array);
}

// Pictures of several samples are composited as they are, or made pictures of one sample first.
const RenderTarget& Compositor::one_sample(const RenderTarget& picture, RenderTarget& resolved, const Finish& finish)
{
    if (!finish.needs_one_sample() || picture.samples() == 1) return picture;
    resolved.prepare(picture.width(), picture.height(), 1);
    resolved.bind();
    resolved.clear();
    glDisable(GL_BLEND);
    glDepthFunc(GL_ALWAYS);
    const ShaderProgram& resolve = program(picture, another_target);
    glUseProgram(resolve.id());
    glUniform2i(resolve.uniform("corner"), 0, 0);
    run(resolve, "colours", picture.colours(), texture_target(picture), picture);
    return resolved;
}

bool Compositor::find_shades(const RenderTarget& from, ColourTarget& shades, const Matrix4d& projection,
                             const Finish& finish, bool resolved)
{
    if (!shades.begin((from.width() + 1) / 2, (from.height() + 1) / 2)) return false;
    const Finish lighting{finish.eye_dome, finish.fast, false};
    const ShaderProgram& shade = program(from, shades_of_it, lighting, resolved);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glUseProgram(shade.id());
    glUniform2i(shade.uniform("corner"), 0, 0);
    set_finish(shade, from, projection, lighting);
    run(shade, "colours", from.colours(), texture_target(from), from);
    glEnable(GL_DEPTH_TEST);
    return true;
}

void Compositor::draw(const RenderTarget& picture, RenderTarget& resolved, ColourTarget& shades,
                      const GlStateGuard& host, const Matrix4d& projection, const Finish& finish)
{
    const RenderTarget& from = one_sample(picture, resolved, finish);
    const bool is_resolved = &from == &resolved;
    const bool has_shades =
        finish.eye_dome > 0 && finish.fast && find_shades(from, shades, projection, finish, is_resolved);
    const Finish left{has_shades ? 0 : finish.eye_dome, false, finish.close_gaps};
    const ShaderProgram& composite = program(from, has_shades ? the_host_shaded : the_host, left, is_resolved);
    begin_in_host(composite, host);
    set_finish(composite, from, projection, left);
    if (has_shades) {
        glUniform1i(composite.uniform("shades"), 2);
        glUniform2i(composite.uniform("size"), from.width(), from.height());
        glActiveTexture(GL_TEXTURE2);
        glBindTexture(GL_TEXTURE_2D, shades.texture());
    }
    run(composite, "colours", from.colours(), texture_target(from), from);
}

void Compositor::add(const RenderTarget& picture, RenderTarget& resolved, const ColourTarget& sum,
                     const Matrix4d& projection, const Finish& finish)
{
    const RenderTarget& from = one_sample(picture, resolved, finish);
    const ShaderProgram& composite = program(from, a_sum, finish, &from == &resolved);
    sum.bind();
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE);
    glUseProgram(composite.id());
    glUniform2i(composite.uniform("corner"), 0, 0);
    set_finish(composite, from, projection, finish);
    run(composite, "colours", from.colours(), texture_target(from), from);
    glEnable(GL_DEPTH_TEST);
}

void Compositor::draw_mean(const ColourTarget& sum, unsigned frames, const RenderTarget& picture,
                           const GlStateGuard& host)
{
    const ShaderProgram& mean = program(picture, the_host_mean);
    begin_in_host(mean, host);
    glUniform1f(mean.uniform("frames"), static_cast<float>(frames));
    glUniform2i(mean.uniform("size"), picture.width(), picture.height());
    run(mean, "sums", sum.texture(), GL_TEXTURE_2D, picture);
}

void Compositor::release()
{
    for (auto& [key, program] : programs_) program.release();
    programs_.clear();
}

}  // namespace pcm
