// Primitives as a script of AutoCAD's commands.
//
// A line is an input, an empty line the key Enter. Commands and options have the names that every language knows ("_"),
// commands those that nobody has redefined ("."). "_NON" before a place keeps object snaps from moving it. Numbers are
// written without exponents, with all digits. So that map coordinates cost no digits, the coordinate system is moved to
// the primitive first, then turned.
#include "pcm/cad/drawing_list.h"
#include "pcm/cad/layer_names.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/output_file.h"

#include <charconv>
#include <cmath>

namespace pcm {
namespace {

std::string decimal(double value)
{
    char text[400];
    const auto end = std::to_chars(text, text + sizeof text, value + 0.0, std::chars_format::fixed);
    return {text, end.ptr};
}

std::string decimal(const Vec3d& v) { return decimal(v[0]) + "," + decimal(v[1]) + "," + decimal(v[2]); }

class Script {
public:
    explicit Script(const std::filesystem::path& path) : file_(path) {}

    void comment(const std::string& text)
    {
        std::string plain = "; ";
        for (const char c : text) plain += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        line(plain);
    }
    void line(const std::string& text) { file_.append(text + "\r\n"); }
    void enter() { line({}); }
    void lines(std::initializer_list<std::string> texts)
    {
        for (const std::string& text : texts) line(text);
    }
    void place(const Vec3d& p) { lines({"_NON", decimal(p)}); }
    // The origin, and two axes at right angles. First moved, along the present axes: any step does.
    void coordinate_system(const Vec3d& origin, const Vec3d& x, const Vec3d& y)
    {
        lines({"_.UCS", "_W", "_.UCS", "_3"});
        place(origin);
        place({origin[0] + 1 + std::fabs(origin[0]), origin[1], origin[2]});
        place({origin[0], origin[1] + 1 + std::fabs(origin[1]), origin[2]});
        if (x == Vec3d{1, 0, 0} && y == Vec3d{0, 1, 0}) return;
        lines({"_.UCS", "_3"});
        place({});
        place(x);
        place(y);
    }
    void finish() { file_.finish(); }

private:
    OutputFile file_;
};

void write_plane(Script& script, const Primitive& primitive)
{
    const Vec3d& origin = primitive.bounds.outline.front();
    script.coordinate_system(origin, {1, 0, 0}, {0, 1, 0});
    script.line("_.3DPOLY");
    for (const Vec3d& corner : primitive.bounds.outline) script.place(corner - origin);
    script.line("_C");
}

void write_cylinder(Script& script, const Shape& shape, const ShapeBounds& bounds)
{
    const AxisFrame frame(shape.axis);
    script.coordinate_system(shape.point + bounds.from * shape.axis, frame.u, frame.v);
    script.line("_.CYLINDER");
    script.place({});
    script.lines({decimal(shape.radius), decimal(bounds.to - bounds.from)});
}

// From its base at the wide end towards the apex.
void write_cone(Script& script, const Shape& shape, const ShapeBounds& bounds)
{
    const AxisFrame frame(-1 * shape.axis);
    script.coordinate_system(shape.point + bounds.to * shape.axis, frame.u, frame.v);
    script.line("_.CONE");
    script.place({});
    script.line(decimal(bounds.to * std::tan(shape.second)));
    if (bounds.from > 0) script.lines({"_T", decimal(bounds.from * std::tan(shape.second))});
    script.line(decimal(bounds.to - bounds.from));
}

void write_torus(Script& script, const Shape& shape, const ShapeBounds& bounds)
{
    const double arc = bounds.end - bounds.begin;
    if (bounds.zero == Vec3d{} || arc >= 2 * pi) {
        const AxisFrame frame(shape.axis);
        script.coordinate_system(shape.point, frame.u, frame.v);
        script.line("_.TORUS");
        script.place({});
        script.lines({decimal(shape.radius), decimal(shape.second)});
        return;
    }
    // The tube's circle at the arc's beginning, revolved about the axis, which is y here.
    const Vec3d zero = normalised(bounds.zero - dot(bounds.zero, shape.axis) * shape.axis);
    const Vec3d begin = std::cos(bounds.begin) * zero + std::sin(bounds.begin) * cross(shape.axis, zero);
    script.coordinate_system(shape.point, begin, shape.axis);
    script.line("_.CIRCLE");
    script.place({shape.radius, 0, 0});
    script.line(decimal(shape.second));
    script.lines({"_.REVOLVE", "_L", ""});
    script.place({});
    script.place({0, 1, 0});
    script.line(decimal(arc * 180 / pi));
}

void write_solid(Script& script, const Primitive& primitive)
{
    const Shape& shape = primitive.fit.shape;
    switch (shape.kind) {
        case ShapeKind::plane:
            return write_plane(script, primitive);
        case ShapeKind::cylinder:
            return write_cylinder(script, shape, primitive.bounds);
        case ShapeKind::cone:
            return write_cone(script, shape, primitive.bounds);
        case ShapeKind::torus:
            return write_torus(script, shape, primitive.bounds);
        case ShapeKind::sphere:
            break;
    }
    script.coordinate_system(shape.point, {1, 0, 0}, {0, 1, 0});
    script.line("_.SPHERE");
    script.place({});
    script.line(decimal(shape.radius));
}

}  // namespace

void write_script(const std::filesystem::path& file, const DrawingList& list, const CadOptions& options)
{
    const std::vector<std::string> layers = plain_layer_names(list.names());
    Script script(file);
    script.comment("Primitives of a point cloud, in its own coordinates. Run it with the command SCRIPT.");
    script.comment(options.unit == CadUnit::none ? "The unit of lengths is not known."
                                                 : std::string("Lengths are in ") + name_of(options.unit) + ".");
    script.comment("Angles are in degrees, as the drawing has them by default (AUNITS 0).");
    script.lines({"_.UNDO", "_BE"});
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Primitive& primitive = *list.shown[i];
        script.comment(primitive.name);
        const auto& c = primitive.colour;
        const std::string colour = std::to_string(c[0]) + "," + std::to_string(c[1]) + "," + std::to_string(c[2]);
        script.lines({"_.-LAYER", "_M", layers[i], "_C", "_T", colour, layers[i], ""});
        write_solid(script, primitive);
    }
    script.lines({"_.UCS", "_W", "_.-LAYER", "_S", "0", "", "_.ZOOM", "_E", "_.UNDO", "_E"});
    script.finish();
}

}  // namespace pcm
