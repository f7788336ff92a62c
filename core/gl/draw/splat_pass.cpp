#include "pcm/gl/draw/splat_pass.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/gl/draw/splat_program.h"
#include "pcm/gl/draw/splat_sieve.h"
#include "pcm/gl/tuning.h"

#include <GL/glew.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace pcm {

namespace {

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

}  // namespace

struct SplatPass::Impl {
    // The driver's capabilities and limits, queried once.
    struct Device {
        bool compatibility = false;
        bool doubles = false;
        bool sample_mask = false;
        float largest_point = 1;
        GLint viewport_most[2] = {0, 0};

        static Device ask()
        {
            Device device;
            device.compatibility = is_compatibility_context();
            const auto* vendor = reinterpret_cast<const char*>(glGetString(GL_VENDOR));
            // Intel's devices have no doubles since their 11th generation; Mesa emulates them with integers, a hundred
            // times slower.
            const bool emulated = vendor && std::strstr(vendor, "Intel") != nullptr;
            device.doubles = !emulated && glUniform3dv && glUniformMatrix3dv && has_extension("GL_ARB_gpu_shader_fp64");
            device.sample_mask = has_extension("GL_ARB_sample_shading");
            float range[2] = {1, 1};
            glGetFloatv(device.compatibility ? GL_ALIASED_POINT_SIZE_RANGE : GL_POINT_SIZE_RANGE, range);
            device.largest_point = std::max(1.0f, range[1]);
            glGetIntegerv(GL_MAX_VIEWPORT_DIMS, device.viewport_most);
            return device;
        }
    };

    bool may_use_doubles = true;
    std::optional<Device> device;
    std::map<SplatPermutation, SplatProgram> programs;

    // From begin() to end(). No view: nothing is drawn.
    std::optional<SplatView> view;
    unsigned samples = 1;
    bool paraboloids = false;
    GLuint vertex_array = 0;
    GLint scissor[4] = {0, 0, 0, 0};
    GLboolean scissor_test = GL_FALSE;
    const SplatProgram* current = nullptr;
    std::array<bool, 4> enabled{};
    std::optional<SplatSieve> sieve;
    std::vector<GLint> first;
    std::vector<GLsizei> count;

    void begin(const Camera& camera, const TreeInfo& tree, const CloudStyle& usable, bool reversed,
               unsigned framebuffer_samples, bool as_paraboloids, const ShownValues& values, const ShownPoints& points)
    {
        if (!device) device = Device::ask();
        samples = std::max(framebuffer_samples, 1u);
        paraboloids = as_paraboloids;
        current = nullptr;
        std::array<int, 4> viewport{};
        glGetIntegerv(GL_VIEWPORT, viewport.data());
        const auto splat_camera = SplatCamera::of(camera, viewport[0], viewport[1], reversed);
        if (!splat_camera) {
            view.reset();
            return;
        }
        view = SplatView{
            *splat_camera,          &tree,       usable, viewport, 0, device->largest_point, values, points.clips,
            points.selected_colour, points.frame};
        if (paraboloids && traits_of(usable.splats).shape == SplatShape::sphere)
            view->style.radius_scale *= static_cast<float>(gl_tuning().splats.paraboloid_radius);

        glEnable(GL_DEPTH_TEST);
        glDepthFunc(reversed ? GL_GREATER : GL_LESS);
        glDepthMask(GL_TRUE);
        glDisable(GL_BLEND);
        glEnable(GL_PROGRAM_POINT_SIZE);
        if (device->compatibility) {
            // Points of a core context, and point sprites here, are squares of exactly the requested size. Plain legacy
            // points have their size and place rounded to whole pixels, which for a whole size covers the same pixels,
            // and Mesa's software rasteriser draws them twice as fast. With several samples they would be round; and
            // they have no gl_PointCoord, which a shader of another kind may read.
            const SplatTraits& traits = traits_of(usable.splats);
            const bool plain = traits.shape == SplatShape::pixels && traits.define[0] == 0 && samples == 1 &&
                               usable.point_size_px == std::floor(usable.point_size_px);
            plain ? glDisable(GL_POINT_SPRITE) : glEnable(GL_POINT_SPRITE);
            glDisable(GL_POINT_SMOOTH);
        }
        guard_the_border();
        sieve.emplace(view->camera, view->style, static_cast<double>(view->largest_point), view->guard);
        // Made anew each time: contexts of a share group do not share vertex arrays.
        glGenVertexArrays(1, &vertex_array);
        glBindVertexArray(vertex_array);
        enabled = {};
        enable(0, true);
    }

    // OpenGL drops a point whose centre is outside the clip volume, however much of it is inside. So that splats do not
    // vanish at the border, the volume is made larger than the picture and the scissor crops it. (Discs are placed
    // inside by their shader.)
    void guard_the_border()
    {
        scissor_test = glIsEnabled(GL_SCISSOR_TEST);
        glGetIntegerv(GL_SCISSOR_BOX, scissor);
        if (traits_of(view->style.splats).shape == SplatShape::pixels) return;
        const auto& viewport = view->viewport;
        const int wanted = static_cast<int>(std::ceil(std::min(view->largest_point, 4096.0f) / 2)) + 1;
        view->guard = std::clamp(wanted, 0,
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
        const auto& viewport = view->viewport;
        const int by = on ? view->guard : 0;
        glViewport(viewport[0] - by, viewport[1] - by, viewport[2] + 2 * by, viewport[3] + 2 * by);
    }

    void enable(GLuint attribute, bool on)
    {
        if (enabled[attribute] == on) return;
        enabled[attribute] = on;
        on ? glEnableVertexAttribArray(attribute) : glDisableVertexAttribArray(attribute);
    }

    SplatPermutation permutation_for(const VertexEntry& entry) const
    {
        SplatPermutation p;
        p.mode = drawable_mode(view->style.splats, entry.format.radius, entry.format.normal, entry.format.shape);
        const bool is_disc = traits_of(p.mode).shape == SplatShape::disc;
        p.paraboloid = paraboloids && traits_of(p.mode).shape == SplatShape::sphere;
        p.orthographic = (is_disc || p.paraboloid || p.mode == SplatMode::fitted) && view->camera.orthographic;
        if (p.orthographic) p.mode = traits_of(p.mode).in_parallel;
        p.colouring = traits_of(view->style.colour).colouring;
        // The entry may still hold what another style shows.
        if (p.colouring == Colouring::vertex || p.colouring == Colouring::value)
            p.colouring = entry.format.colour == ColourSource::none ? Colouring::chunk
                          : is_value(entry.format.colour)           ? Colouring::value
                                                                    : Colouring::vertex;
        if (p.colouring == Colouring::shaded_height && entry.format.colour != ColourSource::intensity)
            p.colouring = Colouring::height;
        p.samples = is_disc && device->sample_mask ? samples : 1;
        p.selected = entry.selection != 0;
        p.doubles = traits_of(p.mode).has_doubles && device->doubles && may_use_doubles;
        return p;
    }

    const SplatProgram& program_of(const SplatPermutation& p)
    {
        const auto found = programs.find(p);
        return found != programs.end() ? found->second : programs.emplace(p, SplatProgram(p)).first->second;
    }

    std::uint32_t draw(const VertexEntry& entry, const ChunkLook& look)
    {
        if (!view || entry.points == 0) return 0;
        const Box3d box = view->box_of(entry);
        const BoxRelation kept = view->kept_of(box);
        if (kept == BoxRelation::outside) return entry.points;
        SplatPermutation p = permutation_for(entry);
        p.clips = kept == BoxRelation::crosses;
        const SplatTraits& traits = traits_of(p.mode);
        sieve->sort(entry, box, traits.shape, look, nullptr, p.clips ? view->clips : nullptr);
        for (const bool quads : {false, true}) {
            const std::vector<VertexRun>& runs = quads ? sieve->as_quads() : sieve->as_points();
            if (runs.empty()) continue;
            p.quads = quads;
            const SplatProgram& program = program_of(p);
            if (current != &program) {
                glUseProgram(program.id());
                program.set_view(*view);
                set_guard((traits.shape == SplatShape::sphere || traits.shape == SplatShape::ellipse) && !quads);
                current = &program;
            }
            program.set_chunk(*view, entry, look);
            enable(1, p.colouring == Colouring::vertex || p.colouring == Colouring::value ||
                          p.colouring == Colouring::shaded_height);
            enable(2, traits.reads_radius);
            enable(3, traits.reads_normal);
            draw_runs(entry, runs, quads);
        }
        return sieve->clipped();
    }

    std::uint64_t preview(const VertexEntry& entry, std::vector<SplatPart>& parts)
    {
        if (!view || entry.points == 0) return 0;
        const Box3d box = view->box_of(entry);
        const BoxRelation kept = view->kept_of(box);
        if (kept == BoxRelation::outside) return 0;
        sieve->sort(entry, box, traits_of(permutation_for(entry).mode).shape, {}, &parts,
                    kept == BoxRelation::crosses ? view->clips : nullptr);
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
        if (enabled[1] && is_value(format.colour))
            glVertexAttribPointer(1, 1, GL_FLOAT, GL_FALSE, stride, place(VertexFormat::colour_place));
        else if (enabled[1])
            glVertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, place(VertexFormat::colour_place));
        if (enabled[2]) glVertexAttribPointer(2, 1, GL_FLOAT, GL_FALSE, stride, place(format.radius_place()));
        if (enabled[3]) glVertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, stride, place(VertexFormat::normal_place));
    }

    void draw_runs(const VertexEntry& entry, const std::vector<VertexRun>& runs, bool quads)
    {
        auto run = runs.begin();
        std::uint32_t passed = 0;  // points of the chunk, in earlier ranges
        std::uint32_t buffer = 0;  // the one that `first` and `count` refer to
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
                if (run->first + run->count > end) break;  // it continues in the next range
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
        if (!view) return;
        sieve.reset();
        current = nullptr;
        glBindVertexArray(0);
        glDeleteVertexArrays(1, &vertex_array);
        vertex_array = 0;
        const auto& viewport = view->viewport;
        glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
        glScissor(scissor[0], scissor[1], scissor[2], scissor[3]);
        scissor_test ? glEnable(GL_SCISSOR_TEST) : glDisable(GL_SCISSOR_TEST);
        view.reset();
    }
};

SplatPass::SplatPass(bool doubles) : impl_(std::make_unique<Impl>()) { impl_->may_use_doubles = doubles; }
SplatPass::~SplatPass() = default;
SplatPass::SplatPass(SplatPass&&) noexcept = default;
SplatPass& SplatPass::operator=(SplatPass&&) noexcept = default;

void SplatPass::begin(const Camera& view, const TreeInfo& info, const CloudStyle& usable, bool reversed,
                      unsigned samples, bool paraboloids, const ShownValues& values, const ShownPoints& points)
{
    impl_->begin(view, info, usable, reversed, samples, paraboloids, values, points);
}
std::uint32_t SplatPass::draw(const VertexEntry& entry, const ChunkLook& look) { return impl_->draw(entry, look); }
std::uint64_t SplatPass::preview(const VertexEntry& entry, std::vector<SplatPart>& parts)
{
    return impl_->preview(entry, parts);
}
void SplatPass::end() { impl_->end(); }
std::size_t SplatPass::programs() const { return impl_->programs.size(); }

void SplatPass::release()
{
    for (auto& [permutation, program] : impl_->programs) program.release();
    impl_->programs.clear();
    impl_->device.reset();
}

}  // namespace pcm
