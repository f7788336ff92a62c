#include "pcm/gl/splat_pass.h"

#include "pcm/gl/gl_state.h"
#include "pcm/gl/shader_program.h"
#include "pcm/gl/splat_camera.h"
#include "pcm/gl/splat_sieve.h"

#include <GL/glew.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace pcm {

namespace {

enum class Colouring : std::uint8_t { vertex, height, uniform };

struct Permutation {
    SplatMode mode = SplatMode::constant;
    Colouring colouring = Colouring::uniform;
    bool orthographic = false;
    bool quads = false;
    unsigned samples = 1;
    bool doubles = false;

    bool operator<(const Permutation& o) const
    {
        return std::tie(mode, colouring, orthographic, quads, samples, doubles) <
               std::tie(o.mode, o.colouring, o.orthographic, o.quads, o.samples, o.doubles);
    }
    bool is_disc() const { return mode == SplatMode::perspective || mode == SplatMode::affine; }
    std::vector<std::string> defines() const
    {
        std::vector<std::string> list;
        if (colouring == Colouring::vertex) list.emplace_back("VERTEX_COLOUR");
        if (colouring == Colouring::height) list.emplace_back("HEIGHT_COLOUR");
        if (mode == SplatMode::dynamic) list.emplace_back("DYNAMIC");
        if (mode == SplatMode::affine) list.emplace_back("AFFINE");
        if (mode == SplatMode::perspective) list.emplace_back("DISC");
        if (orthographic) list.emplace_back("ORTHOGRAPHIC");
        if (quads) list.emplace_back("QUADS");
        if (samples > 1) list.emplace_back("SAMPLES " + std::to_string(samples));
        if (doubles) list.emplace_back("DOUBLE");
        return list;
    }
};

struct Program {
    ShaderProgram program;
    bool doubles = false;
    GLint reference = -1, to_eye = -1, translation = -1, height = -1, uniform_colour = -1, from_eye = -1,
          least_radius = -1, least_pixels = -1;

    void set(GLint place, const Vec3d& v) const
    {
        if (doubles)
            glUniform3dv(place, 1, v.data());
        else
            glUniform3f(place, static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]));
    }
    void set(GLint place, double x, double y) const
    {
        if (doubles)
            glUniform2d(place, x, y);
        else
            glUniform2f(place, static_cast<float>(x), static_cast<float>(y));
    }
    void set_matrix(GLint place, const std::array<double, 9>& m) const
    {
        if (doubles) {
            glUniformMatrix3dv(place, 1, GL_FALSE, m.data());
            return;
        }
        float f[9];
        for (std::size_t i = 0; i < 9; ++i) f[i] = static_cast<float>(m[i]);
        glUniformMatrix3fv(place, 1, GL_FALSE, f);
    }
};

constexpr std::array<std::array<float, 3>, 5> ramp{{{0.267f, 0.005f, 0.329f},
                                                    {0.230f, 0.322f, 0.546f},
                                                    {0.128f, 0.567f, 0.551f},
                                                    {0.369f, 0.789f, 0.383f},
                                                    {0.993f, 0.906f, 0.144f}}};

bool has_extension(const char* name)
{
    GLint count = 0;
    glGetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; ++i) {
        const auto* extension = reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
        if (extension && std::strcmp(extension, name) == 0) return true;
    }
    return false;
}

// What the driver can, asked once.
struct Device {
    bool compatibility = false;
    bool doubles = false;
    bool sample_mask = false;
    double point_most = 1;  // the largest point
    GLint viewport_most[2] = {0, 0};

    static Device ask()
    {
        Device device;
        device.compatibility = is_compatibility_context();
        const auto* vendor = reinterpret_cast<const char*>(glGetString(GL_VENDOR));
        // Intel's devices have had none since their 11th generation; Mesa emulates them there with integers, a hundred
        // times slower.
        const bool emulated = vendor && std::strstr(vendor, "Intel") != nullptr;
        device.doubles = !emulated && glUniform3dv && glUniformMatrix3dv && has_extension("GL_ARB_gpu_shader_fp64");
        device.sample_mask = has_extension("GL_ARB_sample_shading");
        float range[2] = {1, 1};
        glGetFloatv(device.compatibility ? GL_ALIASED_POINT_SIZE_RANGE : GL_POINT_SIZE_RANGE, range);
        device.point_most = std::max(1.0f, range[1]);
        glGetIntegerv(GL_MAX_VIEWPORT_DIMS, device.viewport_most);
        return device;
    }
};

}  // namespace

std::array<float, 3> ramp_colour(float t)
{
    const float s = std::clamp(t, 0.0f, 1.0f) * 4;
    const auto first = static_cast<std::size_t>(std::min(s, 3.0f));
    const float part = s - static_cast<float>(first);
    std::array<float, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c) colour[c] = ramp[first][c] + part * (ramp[first + 1][c] - ramp[first][c]);
    return colour;
}

struct SplatPass::Impl {
    bool may_use_doubles = true;
    std::optional<Device> device;
    std::map<Permutation, Program> programs;

    // From begin() to end().
    std::optional<SplatCamera> camera;
    const TreeInfo* info = nullptr;
    CloudStyle style;
    unsigned samples = 1;
    GLuint vertex_array = 0;
    GLint viewport[4] = {0, 0, 0, 0};
    GLint scissor[4] = {0, 0, 0, 0};
    GLboolean scissor_test = GL_FALSE;
    int guard = 0;  // pixels that the clip volume is wider by, for dynamic splats
    const Program* current = nullptr;
    std::array<bool, 4> enabled{};
    std::optional<SplatSieve> sieve;
    std::vector<GLint> first;
    std::vector<GLsizei> count;

    void begin(const Camera& view, const TreeInfo& tree, const CloudStyle& usable, bool reversed,
               unsigned framebuffer_samples)
    {
        if (!device) device = Device::ask();
        info = &tree;
        style = usable;
        samples = std::max(framebuffer_samples, 1u);
        current = nullptr;
        glGetIntegerv(GL_VIEWPORT, viewport);
        camera = SplatCamera::of(view, viewport[0], viewport[1], reversed);
        if (!camera) return;

        glEnable(GL_DEPTH_TEST);
        glDepthFunc(reversed ? GL_GREATER : GL_LESS);
        glDepthMask(GL_TRUE);
        glDisable(GL_BLEND);
        glEnable(GL_PROGRAM_POINT_SIZE);
        if (device->compatibility) {
            // Points of a core context, and sprites here, are squares of exactly the asked size. Plain legacy points
            // have size and place rounded to whole pixels, which for a whole size covers the very same pixels; and
            // Mesa's software rasteriser draws them twice as fast. With several samples they would be round.
            const bool plain = style.splats == SplatMode::constant && samples == 1 &&
                               style.point_size_px == std::floor(style.point_size_px);
            plain ? glDisable(GL_POINT_SPRITE) : glEnable(GL_POINT_SPRITE);
            glDisable(GL_POINT_SMOOTH);
        }
        guard_the_border();
        sieve.emplace(*camera, style, device->point_most, guard);
        // Not kept: contexts of a share group do not share vertex arrays.
        glGenVertexArrays(1, &vertex_array);
        glBindVertexArray(vertex_array);
        enabled = {};
        enable(0, true);
    }

    // OpenGL drops a point whose centre is outside of the clip volume, however much of it is inside. So that splats do
    // not vanish at the border, the volume is made larger than the picture, which is cut out of it. (Discs are placed
    // inside by their shader.)
    void guard_the_border()
    {
        scissor_test = glIsEnabled(GL_SCISSOR_TEST);
        glGetIntegerv(GL_SCISSOR_BOX, scissor);
        guard = 0;
        if (style.splats == SplatMode::constant) return;
        const int wanted = static_cast<int>(std::ceil(std::min(device->point_most, 4096.0) / 2)) + 1;
        guard = std::clamp(wanted, 0,
                           std::max(0, std::min((device->viewport_most[0] - viewport[2]) / 2,
                                                (device->viewport_most[1] - viewport[3]) / 2)));
        GLint low[2] = {viewport[0], viewport[1]};
        GLint high[2] = {viewport[0] + viewport[2], viewport[1] + viewport[3]};
        for (int a = 0; a < 2 && scissor_test; ++a) {
            low[a] = std::max(low[a], scissor[a]);
            high[a] = std::max(low[a], std::min(high[a], scissor[a] + scissor[2 + a]));
        }
        glEnable(GL_SCISSOR_TEST);
        glScissor(low[0], low[1], high[0] - low[0], high[1] - low[1]);
    }

    void set_guard(bool on)
    {
        const int by = on ? guard : 0;
        glViewport(viewport[0] - by, viewport[1] - by, viewport[2] + 2 * by, viewport[3] + 2 * by);
    }

    void enable(GLuint attribute, bool on)
    {
        if (enabled[attribute] == on) return;
        enabled[attribute] = on;
        on ? glEnableVertexAttribArray(attribute) : glDisableVertexAttribArray(attribute);
    }

    Permutation permutation_for(const VertexEntry& entry) const
    {
        Permutation p;
        p.mode = style.splats;
        if (p.is_disc() && !entry.format.normal) p.mode = SplatMode::dynamic;
        if (p.mode != SplatMode::constant && !entry.format.radius) p.mode = SplatMode::constant;
        p.orthographic = p.is_disc() && camera->orthographic;
        if (p.orthographic) p.mode = SplatMode::perspective;  // the same, and exact
        const bool reads_colour = style.colour == ColourMode::rgb || style.colour == ColourMode::intensity ||
                                  style.colour == ColourMode::classification;
        if (reads_colour && entry.format.colour != ColourSource::none) p.colouring = Colouring::vertex;
        if (style.colour == ColourMode::height) p.colouring = Colouring::height;
        p.samples = p.is_disc() && device->sample_mask ? samples : 1;
        p.doubles = p.mode == SplatMode::perspective && device->doubles && may_use_doubles;
        return p;
    }

    // Of its points' positions, relative to the view's origin.
    Box3d box_of(const VertexEntry& entry) const
    {
        Box3d box;
        for (std::size_t a = 0; a < 3; ++a) {
            // Where the grid's offset is the local origin, the large numbers cancel exactly.
            box.min[a] = static_cast<double>(entry.origin[a]) * info->grid.scale[a] +
                         (info->grid.offset[a] - camera->view.origin[a]);
            box.max[a] = box.min[a] + entry.extent[a];
        }
        return box;
    }

    const Program& program_of(const Permutation& p)
    {
        const auto found = programs.find(p);
        if (found != programs.end()) return found->second;
        Program program;
        program.program = ShaderProgram("splat.vert", "splat.frag", p.defines());
        program.doubles = p.doubles;
        program.reference = program.program.uniform("reference");
        program.to_eye = program.program.uniform("to_eye");
        program.translation = program.program.uniform("translation");
        program.height = program.program.uniform("height");
        program.uniform_colour = program.program.uniform("uniform_colour");
        program.from_eye = program.program.uniform("from_eye");
        program.least_radius = program.program.uniform("least_radius");
        program.least_pixels = program.program.uniform("least_pixels");
        return programs.emplace(p, std::move(program)).first->second;
    }

    // What all chunks of a picture have in common.
    void set_common(const Program& program, const Permutation& p) const
    {
        const auto place = [&](const char* name) { return program.program.uniform(name); };
        const SplatCamera& c = *camera;
        glUniformMatrix4fv(place("projection"), 1, GL_FALSE, c.projection.data());
        program.set_matrix(program.to_eye, c.to_eye);
        glUniform1f(place("eye_scale"), static_cast<float>(c.scale));
        if (p.mode == SplatMode::constant) {
            glUniform1f(place("point_size"),
                        std::clamp(style.point_size_px, 1.0f, static_cast<float>(device->point_most)));
            glUniform1f(place("pixels"), static_cast<float>(c.square_pixels()));
            return;
        }
        const auto width = static_cast<float>(viewport[2]);
        const auto height = static_cast<float>(viewport[3]);
        glUniform1f(place("radius_scale"), style.radius_scale);
        glUniform2f(place("viewport"), width, height);
        if (p.mode == SplatMode::dynamic) {
            glUniform1f(place("pixels"), static_cast<float>(c.square_pixels()));
            glUniform2f(place("guard"), width / (width + 2 * static_cast<float>(guard)),
                        height / (height + 2 * static_cast<float>(guard)));
            return;
        }
        program.set(place("focal"), c.focal[0], c.focal[1]);
        program.set(place("principal"), c.principal[0], c.principal[1]);
        glUniform2f(place("depth_of"), static_cast<float>(c.depth_of[0]), static_cast<float>(c.depth_of[1]));
        if (p.samples > 1) {
            std::vector<float> places(2 * p.samples);
            for (unsigned s = 0; s < p.samples; ++s) {
                glGetMultisamplefv(GL_SAMPLE_POSITION, s, &places[2 * s]);
                places[2 * s] -= 0.5f;
                places[2 * s + 1] -= 0.5f;
            }
            glUniform2fv(place("sample_places"), static_cast<GLsizei>(p.samples), places.data());
        }
        if (p.mode == SplatMode::affine) {
            float m[9];
            for (std::size_t i = 0; i < 9; ++i) m[i] = static_cast<float>(c.normal_to_eye[i]);
            glUniformMatrix3fv(place("normal_to_eye"), 1, GL_FALSE, m);
            return;
        }
        program.set(place("pixel_x"), c.pixel_x);
        program.set(place("pixel_y"), c.pixel_y);
        program.set(place("centre_ray"), c.centre_ray);
        glUniform2f(place("centre_pixel"), static_cast<float>(c.centre_pixel[0]),
                    static_cast<float>(c.centre_pixel[1]));
        glUniform4f(place("pixel_bounds"), static_cast<float>(viewport[0]) + 0.5f,
                    static_cast<float>(viewport[1]) + 0.5f, static_cast<float>(viewport[0]) + width - 0.5f,
                    static_cast<float>(viewport[1]) + height - 0.5f);
        glUniform1f(place("near"), static_cast<float>(c.near));
    }

    // See shaders/splat.vert: the reference is the point of the chunk's box nearest to the eye.
    void set_chunk(const Program& program, const VertexEntry& entry, const ChunkLook& look) const
    {
        const Box3d box = box_of(entry);
        Vec3d local{};
        float reference[3];
        for (std::size_t a = 0; a < 3; ++a) {
            reference[a] = static_cast<float>(std::clamp(camera->eye[a] - box.min[a], 0.0, entry.extent[a]));
            local[a] = box.min[a] + static_cast<double>(reference[a]);
        }
        glUniform3fv(program.reference, 1, reference);
        program.set(program.translation, camera->eye_of(local));
        program.set(program.from_eye,
                    {local[0] - camera->eye[0], local[1] - camera->eye[1], local[2] - camera->eye[2]});
        glUniform1f(program.least_radius, look.least_radius);
        glUniform1f(program.least_pixels, std::min(look.least_px, static_cast<float>(device->point_most)));
        if (program.height >= 0) {
            const double bottom = static_cast<double>(info->box.min[2]);
            const double top = static_cast<double>(info->box.max[2]);
            const double range = (top - bottom) * info->grid.scale[2];
            const double above = (static_cast<double>(entry.origin[2]) - bottom) * info->grid.scale[2];
            const bool flat = !(range > 0);
            glUniform2f(program.height, flat ? 0.0f : static_cast<float>(1 / range),
                        flat ? 0.5f : static_cast<float>(above / range));
        }
        if (program.uniform_colour >= 0) glUniform3fv(program.uniform_colour, 1, colour_of(look).data());
    }

    std::array<float, 3> colour_of(const ChunkLook& look) const
    {
        if (style.colour == ColourMode::level)
            return ramp_colour(look.level / std::max(1.0f, static_cast<float>(info->levels) - 1));
        // Half a pixel is at the ramp's beginning, 64 pixels at its end.
        if (style.colour == ColourMode::error) return ramp_colour((std::log2(std::max(look.error_px, 0.5f)) + 1) / 7);
        return style.uniform_colour;
    }

    void draw(const VertexEntry& entry, const ChunkLook& look)
    {
        if (!camera || entry.points == 0) return;
        Permutation p = permutation_for(entry);
        sieve->sort(entry, box_of(entry), p.mode, look);
        for (const bool quads : {false, true}) {
            const std::vector<VertexRun>& runs = quads ? sieve->as_quads() : sieve->as_points();
            if (runs.empty()) continue;
            p.quads = quads;
            const Program& program = program_of(p);
            if (current != &program) {
                glUseProgram(program.program.id());
                set_common(program, p);
                set_guard(p.mode == SplatMode::dynamic && !quads);
                current = &program;
            }
            set_chunk(program, entry, look);
            enable(1, p.colouring == Colouring::vertex);
            enable(2, p.mode != SplatMode::constant);
            enable(3, p.is_disc());
            draw_runs(entry, runs, quads);
        }
    }

    std::uint64_t preview(const VertexEntry& entry, std::vector<SplatPart>& parts)
    {
        if (!camera || entry.points == 0) return 0;
        sieve->sort(entry, box_of(entry), permutation_for(entry).mode, {}, &parts);
        std::uint64_t vertices = 0;
        for (const VertexRun& run : sieve->as_points()) vertices += run.count;
        for (const VertexRun& run : sieve->as_quads()) vertices += 4 * std::uint64_t(run.count);
        return vertices;
    }

    void point_at(const VertexEntry& entry, std::size_t vertex) const
    {
        const VertexFormat& format = entry.format;
        const auto stride = static_cast<GLsizei>(format.stride());
        const auto place = [&](std::size_t byte) {
            return reinterpret_cast<const void*>(vertex * format.stride() + byte);
        };
        glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, place(0));
        if (enabled[1])
            glVertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, place(VertexFormat::colour_place));
        if (enabled[2]) glVertexAttribPointer(2, 1, GL_FLOAT, GL_FALSE, stride, place(format.radius_place()));
        if (enabled[3]) glVertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, stride, place(VertexFormat::normal_place));
    }

    void draw_runs(const VertexEntry& entry, const std::vector<VertexRun>& runs, bool quads)
    {
        auto run = runs.begin();
        std::uint32_t passed = 0;  // points of the chunk, in the ranges before
        std::uint32_t buffer = 0;  // that `first` and `count` are of
        first.clear();
        count.clear();
        for (GLuint a = 0; quads && a < 4; ++a) glVertexAttribDivisor(a, 1);
        for (const VertexRange& range : entry.ranges) {
            const std::uint32_t end = passed + static_cast<std::uint32_t>(range.count);
            if (range.buffer != buffer) {
                flush_points(entry, buffer);
                buffer = range.buffer;
            }
            while (run != runs.end() && run->first < end) {
                const std::uint32_t from = std::max(run->first, passed), to = std::min(run->first + run->count, end);
                const auto vertex = static_cast<GLint>(range.first + (from - passed));
                if (quads) {
                    glBindBuffer(GL_ARRAY_BUFFER, buffer);
                    point_at(entry, static_cast<std::size_t>(vertex));
                    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(to - from));
                } else {
                    first.push_back(vertex);
                    count.push_back(static_cast<GLsizei>(to - from));
                }
                if (run->first + run->count > end) break;  // it goes on in the next range
                ++run;
            }
            passed = end;
        }
        flush_points(entry, buffer);
        for (GLuint a = 0; quads && a < 4; ++a) glVertexAttribDivisor(a, 0);
    }

    void flush_points(const VertexEntry& entry, std::uint32_t buffer)
    {
        if (first.empty()) return;
        glBindBuffer(GL_ARRAY_BUFFER, buffer);
        point_at(entry, 0);
        glMultiDrawArrays(GL_POINTS, first.data(), count.data(), static_cast<GLsizei>(first.size()));
        first.clear();
        count.clear();
    }

    void end()
    {
        if (!camera) return;
        camera.reset();
        sieve.reset();
        current = nullptr;
        glBindVertexArray(0);
        glDeleteVertexArrays(1, &vertex_array);
        vertex_array = 0;
        glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
        glScissor(scissor[0], scissor[1], scissor[2], scissor[3]);
        scissor_test ? glEnable(GL_SCISSOR_TEST) : glDisable(GL_SCISSOR_TEST);
    }
};

SplatPass::SplatPass(bool doubles) : impl_(std::make_unique<Impl>()) { impl_->may_use_doubles = doubles; }
SplatPass::~SplatPass() = default;
SplatPass::SplatPass(SplatPass&&) noexcept = default;
SplatPass& SplatPass::operator=(SplatPass&&) noexcept = default;

void SplatPass::begin(const Camera& view, const TreeInfo& info, const CloudStyle& usable, bool reversed,
                      unsigned samples)
{
    impl_->begin(view, info, usable, reversed, samples);
}
void SplatPass::draw(const VertexEntry& entry, const ChunkLook& look) { impl_->draw(entry, look); }
std::uint64_t SplatPass::preview(const VertexEntry& entry, std::vector<SplatPart>& parts)
{
    return impl_->preview(entry, parts);
}
void SplatPass::end() { impl_->end(); }

void SplatPass::release()
{
    for (auto& [permutation, program] : impl_->programs) program.program.release();
    impl_->programs.clear();
    impl_->device.reset();
}

}  // namespace pcm
