#include "pcm/gl/draw/line_pass.h"

#include "pcm/cloud/vector.h"
#include "pcm/gl/base/gl_state.h"
#include "pcm/view/screen_map.h"

#include <GL/glew.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace pcm {
namespace {

constexpr double border = 1;  // dark, around each line, pixels
constexpr double smooth = 1;  // room for antialiasing, pixels

// As shaders/line.vert reads it. A segment is a quad; its fragments know their place along and across it.
struct LineVertex {
    float place[3];    // normalised device coordinates
    float segment[4];  // along and across it, its length and half its width, pixels
    float colour[4];
    float hidden;
};

struct LineStroke {
    std::array<float, 4> colour;
    double width;
    float hidden;
};

class LineVertices {
public:
    explicit LineVertices(const ScreenMap& map, const Camera& camera) : map_(map), camera_(camera) {}

    void add(const SceneLine& line)
    {
        const std::size_t count = line.points.size();
        const std::size_t segments = count < 2 ? 0 : count - 1 + (line.closed && count > 2 ? 1 : 0);
        const LineStroke stroke{line.colour, line.width_px, line.hidden};
        for (std::size_t i = 0; i < segments; ++i) {
            const auto part = map_.clipped(map_.eye_of(line.points[i]), map_.eye_of(line.points[(i + 1) % count]),
                                           2 * (line.width_px + border + smooth));
            if (part) add(window_of(part->first, line.width_px), window_of(part->second, line.width_px), stroke);
        }
    }

    void add(const SceneMark& mark)
    {
        const Vec3d eye = map_.eye_of(mark.at);
        const double reach = mark.size_px / 2;
        if (!map_.clipped(eye, eye, mark.size_px)) return;
        const Vec3d centre = window_of(eye, mark.size_px);
        const LineStroke stroke{mark.colour, mark.width_px, mark.hidden};
        for (std::size_t axis = 0; axis < 2; ++axis) {
            Vec3d from = centre, to = centre;
            from[axis] -= reach;
            to[axis] += reach;
            add(from, to, stroke);
        }
    }

    const std::vector<LineVertex>& all() const { return vertices_; }

private:
    // The place in the window, with the depth of a place that is nearer to the eye by the size of this many pixels.
    // What is beyond the far plane is drawn at it.
    Vec3d window_of(const Vec3d& eye, double pixels) const
    {
        Vec3d place = map_.window_of(eye);
        Vec3d nearer = eye;
        // No more than half of the way to the eye.
        const double by = pixels * map_.pixel_at(eye);
        nearer[2] += map_.orthographic() ? by : std::min(by, 0.5 * std::fabs(eye[2]));
        const double depth = map_.window_of(nearer)[2];
        place[2] = std::isfinite(depth) ? std::clamp(depth, -1.0, 1.0 - 1e-6) : -1.0;
        return place;
    }

    void add(const Vec3d& from, const Vec3d& to, const LineStroke& stroke)
    {
        const double x = to[0] - from[0], y = to[1] - from[1], size = std::hypot(x, y);
        const double along[2] = {size > 0 ? x / size : 1, size > 0 ? y / size : 0};
        const double half = stroke.width / 2, reach = half + border + smooth;
        const auto vertex = [&](bool end, double side) {
            const Vec3d& at = end ? to : from;
            const double forth = end ? reach : -reach, across = side * reach;
            LineVertex v{};
            v.place[0] = static_cast<float>(2 * (at[0] + forth * along[0] - across * along[1]) / camera_.width - 1);
            v.place[1] = static_cast<float>(2 * (at[1] + forth * along[1] + across * along[0]) / camera_.height - 1);
            v.place[2] = static_cast<float>(at[2]);
            v.segment[0] = static_cast<float>((end ? size : 0) + forth);
            v.segment[1] = static_cast<float>(across);
            v.segment[2] = static_cast<float>(size);
            v.segment[3] = static_cast<float>(half);
            std::copy(stroke.colour.begin(), stroke.colour.end(), v.colour);
            v.hidden = stroke.hidden;
            return v;
        };
        const LineVertex corners[4] = {vertex(false, -1), vertex(true, -1), vertex(false, 1), vertex(true, 1)};
        for (const int corner : {0, 1, 2, 2, 1, 3}) vertices_.push_back(corners[corner]);
    }

    const ScreenMap& map_;
    const Camera& camera_;
    std::vector<LineVertex> vertices_;
};

void point_at_vertices()
{
    const auto attribute = [](GLuint number, GLint numbers, std::size_t byte) {
        glEnableVertexAttribArray(number);
        glVertexAttribPointer(number, numbers, GL_FLOAT, GL_FALSE, sizeof(LineVertex),
                              reinterpret_cast<const void*>(byte));
    };
    attribute(0, 3, offsetof(LineVertex, place));
    attribute(1, 4, offsetof(LineVertex, segment));
    attribute(2, 4, offsetof(LineVertex, colour));
    attribute(3, 1, offsetof(LineVertex, hidden));
}

}  // namespace

void LinePass::draw(const Camera& camera, const std::vector<SceneLine>& lines, const std::vector<SceneMark>& marks)
{
    const std::optional<ScreenMap> map = ScreenMap::of(camera);
    if (!map || (lines.empty() && marks.empty())) return;
    LineVertices vertices(*map, camera);
    for (const SceneLine& line : lines) vertices.add(line);
    for (const SceneMark& mark : marks) vertices.add(mark);
    if (vertices.all().empty()) return;
    if (!program_) program_ = ShaderProgram("line.vert", "line.frag");

    const GlStateGuard host;
    host.set_plain();
    if (gl_has_clip_control()) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glDepthRange(static_cast<double>(host.depth_range()[0]), static_cast<double>(host.depth_range()[1]));
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    GLuint vertex_array = 0, buffer = 0;
    glGenVertexArrays(1, &vertex_array);
    glGenBuffers(1, &buffer);
    glBindVertexArray(vertex_array);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.all().size() * sizeof(LineVertex)),
                 vertices.all().data(), GL_STREAM_DRAW);
    point_at_vertices();
    glUseProgram(program_.id());
    // First what is behind something, so that it does not cover what is not.
    for (const bool hidden : {true, false}) {
        glDepthFunc(hidden ? GL_GREATER : GL_LEQUAL);
        glUniform1i(program_.uniform("is_hidden"), hidden ? 1 : 0);
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.all().size()));
    }
    glBindVertexArray(0);
    glDeleteVertexArrays(1, &vertex_array);
    glDeleteBuffers(1, &buffer);
}

void LinePass::release() { program_.release(); }

}  // namespace pcm
