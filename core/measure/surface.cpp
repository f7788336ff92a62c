#include "pcm/measure/surface.h"

#include "pcm/cloud/exact_products.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <cmath>
#include <sstream>

namespace pcm {
namespace {

struct Row {
    Surface::Shape shape;
    const char* name;
    bool axis, radius;
    const char* form;
};
constexpr std::array<Row, 3> shapes{
    {{Surface::Shape::plane, "plane", true, false, "plane X Y Z NX NY NZ"},
     {Surface::Shape::sphere, "sphere", false, true, "sphere X Y Z RADIUS"},
     {Surface::Shape::cylinder, "cylinder", true, true, "cylinder X Y Z AX AY AZ RADIUS"}}};

const Row& row_of(Surface::Shape shape) { return shapes[static_cast<std::size_t>(shape)]; }

[[noreturn]] void refuse(const std::string& what, const std::string& hint = {})
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

}  // namespace

const char* name_of(Surface::Shape shape) { return row_of(shape).name; }

std::optional<Surface::Shape> surface_shape(const std::string& name)
{
    for (const Row& row : shapes)
        if (name == row.name) return row.shape;
    return {};
}

Surface parse_surface(const std::string& text)
{
    std::string plain = text;
    for (char& c : plain)
        if (c == ',') c = ' ';
    std::istringstream words(plain);
    words.imbue(std::locale::classic());
    std::string name;
    words >> name;
    const auto shape = surface_shape(name);
    if (!shape)
        refuse("'" + text + "' is no surface",
               std::string("one of: '") + shapes[0].form + "', '" + shapes[1].form + "', '" + shapes[2].form + "'");
    const Row& row = row_of(*shape);
    std::vector<double> numbers;
    for (double number = 0; words >> number;) numbers.push_back(number);
    const std::size_t expected = 3u + (row.axis ? 3u : 0u) + (row.radius ? 1u : 0u);
    if (!words.eof() || numbers.size() != expected)
        refuse("'" + text + "' was expected to be '" + row.form + "', " + std::to_string(expected) + " numbers");
    Surface surface;
    surface.shape = *shape;
    surface.origin = {numbers[0], numbers[1], numbers[2]};
    if (row.axis) surface.axis = {numbers[3], numbers[4], numbers[5]};
    if (row.radius) surface.radius = numbers.back();
    check(surface);
    return surface;
}

std::string text_of(const Surface& surface)
{
    const Row& row = row_of(surface.shape);
    std::string text = std::string(row.name) + " " + exact(surface.origin);
    if (row.axis) text += " " + exact(surface.axis);
    if (row.radius) text += " " + exact(surface.radius);
    return text;
}

void check(const Surface& surface)
{
    const Row& row = row_of(surface.shape);
    const std::string name = row.name;
    if (!is_finite(surface.origin)) refuse("the place of the " + name + " is not finite");
    if (row.axis && !(is_finite(surface.axis) && length(surface.axis) > 0))
        refuse(surface.shape == Surface::Shape::plane ? "the plane's normal is not finite, or has the length 0"
                                                      : "the cylinder's axis is not finite, or has the length 0");
    if (row.radius && !(std::isfinite(surface.radius) && surface.radius > 0))
        refuse("the " + name + "'s radius is not above 0");
}

double distance_to(const Surface& surface, const Vec3d& p)
{
    const Vec3d d = p - surface.origin;
    switch (surface.shape) {
        case Surface::Shape::plane:
            return std::fabs(exact_dot(normalised(surface.axis), d));
        case Surface::Shape::sphere:
            return std::fabs(length(d) - surface.radius);
        case Surface::Shape::cylinder:
            break;
    }
    return std::fabs(length(exact_cross(normalised(surface.axis), d)) - surface.radius);
}

}  // namespace pcm
