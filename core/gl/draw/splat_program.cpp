#include "pcm/gl/draw/splat_program.h"

#include <GL/glew.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pcm {
namespace {

std::array<float, 2> floats(const std::array<double, 2>& v)
{
    return {static_cast<float>(v[0]), static_cast<float>(v[1])};
}

}  // namespace

bool SplatPermutation::operator<(const SplatPermutation& o) const
{
    return std::tie(mode, colouring, orthographic, quads, samples, doubles, paraboloid, clips, selected) <
           std::tie(o.mode, o.colouring, o.orthographic, o.quads, o.samples, o.doubles, o.paraboloid, o.clips,
                    o.selected);
}

std::vector<std::string> SplatPermutation::defines() const
{
    std::vector<std::string> list;
    if (colouring == Colouring::vertex) list.emplace_back("VERTEX_COLOUR");
    if (colouring == Colouring::value) list.emplace_back("VALUE_COLOUR");
    if (colouring == Colouring::height) list.emplace_back("HEIGHT_COLOUR");
    if (colouring == Colouring::shaded_height) list.emplace_back("SHADED_HEIGHT_COLOUR");
    if (const std::string define = traits_of(mode).define; !define.empty()) list.push_back(define);
    if (orthographic) list.emplace_back("ORTHOGRAPHIC");
    if (quads) list.emplace_back("QUADS");
    if (samples > 1) list.emplace_back("SAMPLES " + std::to_string(samples));
    if (doubles) list.emplace_back("DOUBLE");
    if (paraboloid) list.emplace_back("PARABOLOID");
    if (clips) list.emplace_back("CLIPS");
    if (selected) list.emplace_back("SELECTED");
    return list;
}

Box3d SplatView::box_of(const VertexEntry& entry) const
{
    Box3d box;
    for (std::size_t a = 0; a < 3; ++a) {
        // Where the grid's offset is the local origin, the large numbers cancel exactly.
        box.min[a] =
            static_cast<double>(entry.origin[a]) * info->grid.scale[a] + (info->grid.offset[a] - camera.view.origin[a]);
        box.max[a] = box.min[a] + entry.extent[a];
    }
    return box;
}

SplatProgram::SplatProgram(const SplatPermutation& permutation)
    : program_("splat.vert", "splat.frag", permutation.defines()),
      colouring_(permutation.colouring),
      samples_(permutation.samples),
      doubles_(permutation.doubles)
{
    const auto find = [&](const char* name) { return program_.uniform(name); };
    at_ = {find("projection"),    find("to_eye"),         find("eye_scale"),      find("point_size"),
           find("pixels"),        find("radius_scale"),   find("viewport"),       find("guard"),
           find("focal"),         find("principal"),      find("depth_of"),       find("sample_places"),
           find("normal_to_eye"), find("pixel_x"),        find("pixel_y"),        find("centre_ray"),
           find("centre_pixel"),  find("pixel_bounds"),   find("near"),           find("reference"),
           find("translation"),   find("from_eye"),       find("least_radius"),   find("least_pixels"),
           find("ramp"),          find("ramp_place"),     find("uniform_colour"), find("clip_planes"),
           find("clip_ends"),     find("clip_count"),     find("clip_outside"),   find("selected_colour"),
           find("tone"),          find("value_exponent"), find("frame")};
}

void SplatProgram::set(std::int32_t place, const Vec3d& v) const
{
    if (place < 0) return;
    if (doubles_)
        glUniform3dv(place, 1, v.data());
    else
        glUniform3f(place, static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]));
}

void SplatProgram::set(std::int32_t place, const std::array<double, 2>& v) const
{
    if (place < 0) return;
    if (doubles_)
        glUniform2dv(place, 1, v.data());
    else
        glUniform2fv(place, 1, floats(v).data());
}

void SplatProgram::set(std::int32_t place, const std::array<double, 9>& matrix) const
{
    if (place < 0) return;
    if (doubles_) {
        glUniformMatrix3dv(place, 1, GL_FALSE, matrix.data());
        return;
    }
    std::array<float, 9> f{};
    std::transform(matrix.begin(), matrix.end(), f.begin(), [](double d) { return static_cast<float>(d); });
    glUniformMatrix3fv(place, 1, GL_FALSE, f.data());
}

void SplatProgram::set_view(const SplatView& view) const
{
    const SplatCamera& c = view.camera;
    glUniformMatrix4fv(at_.projection, 1, GL_FALSE, c.projection.data());
    set(at_.to_eye, c.to_eye);
    glUniform1f(at_.eye_scale, static_cast<float>(c.scale));
    glUniform1f(at_.point_size, std::clamp(view.style.point_size_px, 1.0f, view.largest_point));
    glUniform1f(at_.pixels, static_cast<float>(c.square_pixels()));
    const auto width = static_cast<float>(view.viewport[2]);
    const auto height = static_cast<float>(view.viewport[3]);
    glUniform1f(at_.radius_scale, view.style.radius_scale);
    glUniform2f(at_.viewport, width, height);
    glUniform2f(at_.guard, width / (width + 2 * static_cast<float>(view.guard)),
                height / (height + 2 * static_cast<float>(view.guard)));
    if (at_.depth_of >= 0) glUniform2fv(at_.depth_of, 1, floats(c.depth_of).data());
    if (at_.ramp >= 0)
        glUniform3fv(at_.ramp, static_cast<GLsizei>(ramp_stops), traits_of(ramp_of(view.style)).table.front().data());
    if (at_.tone >= 0) {
        const bool toned = view.style.colour == ColourMode::rgb;
        glUniform2f(at_.tone, toned ? view.style.brightness : 1.0f, toned ? 1 / view.style.gamma : 1.0f);
    }
    if (at_.value_exponent >= 0) glUniform1f(at_.value_exponent, static_cast<float>(view.values.shade_exponent));
    if (at_.selected_colour >= 0) glUniform3fv(at_.selected_colour, 1, view.selected_colour.data());
    if (at_.frame >= 0) glUniform1ui(at_.frame, view.frame);
    if (at_.focal >= 0) set_disc(view);
}

void SplatProgram::set_clips(const SplatView& view, const Vec3d& reference, const Vec3d& extent) const
{
    const ClipUniforms clips = view.clips->uniforms(reference, extent);
    glUniform4fv(at_.clip_planes, static_cast<GLsizei>(clips.planes.size()), clips.planes.front().data());
    glUniform1iv(at_.clip_ends, static_cast<GLsizei>(clips.ends.size()), clips.ends.data());
    glUniform1i(at_.clip_count, clips.count);
    glUniform1i(at_.clip_outside, clips.outside);
}

// What a vertex holds, its z or a number, is at the place (it * x + y) ^ z of the ramp.
void SplatProgram::set_values(const SplatView& view, const VertexEntry& entry) const
{
    const TreeInfo& info = *view.info;
    ValueRange range{0, 1, 1};
    double step = 1, first = 0;  // the value of a vertex that holds 0, and what 1 adds to it
    if (colouring_ == Colouring::height || colouring_ == Colouring::shaded_height) {
        range = view.values.range.value_or(
            ValueRange{info.grid.to_source(info.box.min[2], 2), info.grid.to_source(info.box.max[2], 2), 1});
        first = info.grid.to_source(entry.origin[2], 2);
    } else if (view.values.range) {
        range = *view.values.range;
        first = view.values.stored_low;
        step = view.values.stored_high - first;
    }
    const double width = range.high - range.low;
    const auto factor = static_cast<float>(step / width);
    const auto added = static_cast<float>((first - range.low) / width);
    const bool flat = !(width > 0) || !std::isfinite(factor) || !std::isfinite(added);
    glUniform3f(at_.ramp_place, flat ? 0.0f : factor, flat ? 0.5f : added,
                flat ? 1.0f : static_cast<float>(range.exponent));
}

void SplatProgram::set_disc(const SplatView& view) const
{
    const SplatCamera& c = view.camera;
    set(at_.focal, c.focal);
    set(at_.principal, c.principal);
    if (at_.sample_places >= 0) {
        std::vector<float> places(2 * samples_);
        for (unsigned s = 0; s < samples_; ++s) {
            glGetMultisamplefv(GL_SAMPLE_POSITION, s, &places[2 * s]);
            places[2 * s] -= 0.5f;
            places[2 * s + 1] -= 0.5f;
        }
        glUniform2fv(at_.sample_places, static_cast<GLsizei>(samples_), places.data());
    }
    if (at_.normal_to_eye >= 0) {
        float m[9];
        for (std::size_t i = 0; i < 9; ++i) m[i] = static_cast<float>(c.normal_to_eye[i]);
        glUniformMatrix3fv(at_.normal_to_eye, 1, GL_FALSE, m);
    }
    set(at_.pixel_x, c.pixel_x);
    set(at_.pixel_y, c.pixel_y);
    set(at_.centre_ray, c.centre_ray);
    glUniform2fv(at_.centre_pixel, 1, floats(c.centre_pixel).data());
    const auto left = static_cast<float>(view.viewport[0]);
    const auto bottom = static_cast<float>(view.viewport[1]);
    glUniform4f(at_.pixel_bounds, left + 0.5f, bottom + 0.5f, left + static_cast<float>(view.viewport[2]) - 0.5f,
                bottom + static_cast<float>(view.viewport[3]) - 0.5f);
    glUniform1f(at_.near, static_cast<float>(c.near));
}

// See shaders/splat.vert: the reference is the point of the chunk's box nearest to the eye.
void SplatProgram::set_chunk(const SplatView& view, const VertexEntry& entry, const ChunkLook& look) const
{
    const SplatCamera& camera = view.camera;
    const TreeInfo& info = *view.info;
    const Box3d box = view.box_of(entry);
    Vec3d local{};
    float reference[3];
    for (std::size_t a = 0; a < 3; ++a) {
        reference[a] = static_cast<float>(std::clamp(camera.eye[a] - box.min[a], 0.0, entry.extent[a]));
        local[a] = box.min[a] + static_cast<double>(reference[a]);
    }
    glUniform3fv(at_.reference, 1, reference);
    set(at_.translation, camera.eye_of(local));
    set(at_.from_eye, Vec3d{local[0] - camera.eye[0], local[1] - camera.eye[1], local[2] - camera.eye[2]});
    glUniform1f(at_.least_radius, look.least_radius);
    glUniform1f(at_.least_pixels, std::min(look.least_px, view.largest_point));
    if (at_.clip_planes >= 0) set_clips(view, camera.view.origin + local, entry.extent);
    if (at_.ramp_place >= 0) set_values(view, entry);
    if (at_.uniform_colour >= 0) {
        const auto of_chunk = traits_of(view.style.colour).of_chunk;
        glUniform3fv(at_.uniform_colour, 1,
                     (of_chunk ? of_chunk(view.style, look, info.levels) : view.style.uniform_colour).data());
    }
}

}  // namespace pcm
