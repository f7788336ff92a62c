#include "pcm/shapes/shape.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/exact_products.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <cmath>
#include <sstream>

namespace pcm {
namespace {

constexpr double degree = pi / 180;

[[noreturn]] void refuse_shape(const std::string& what, const std::string& hint = {})
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

std::string all_forms()
{
    std::string forms = "one of: ";
    for (const ShapeTraits& row : shape_kinds())
        forms += std::string(row.kind == ShapeKind::plane ? "'" : ", '") + row.form + "'";
    return forms;
}

// d = p - point in coordinates of the axis: h along it, q across it.
struct AxisPlace {
    Vec3d across{};
    double h = 0, q = 0;
};

AxisPlace axis_place(const Shape& shape, const Vec3d& d)
{
    AxisPlace place;
    place.h = exact_dot(shape.axis, d);
    place.q = length(exact_cross(shape.axis, d));
    place.across = d - place.h * shape.axis;
    return place;
}

Vec3d direction_across(const Shape& shape, const AxisPlace& place)
{
    const double q = length(place.across);
    return q > 0 ? place.across / q : AxisFrame(shape.axis).u;
}

}  // namespace

const std::vector<ShapeTraits>& shape_kinds()
{
    static const std::vector<ShapeTraits> rows{
        {ShapeKind::plane, "plane", "Plane", "plane X Y Z NX NY NZ", true, false, false},
        {ShapeKind::cylinder, "cylinder", "Cylinder", "cylinder X Y Z AX AY AZ RADIUS", true, true, false},
        {ShapeKind::sphere, "sphere", "Sphere", "sphere X Y Z RADIUS", false, true, false},
        {ShapeKind::cone, "cone", "Cone", "cone X Y Z AX AY AZ DEGREES", true, false, true},
        {ShapeKind::torus, "torus", "Torus", "torus X Y Z AX AY AZ RADIUS TUBE", true, true, true},
    };
    return rows;
}

const ShapeTraits& traits_of(ShapeKind kind) { return shape_kinds()[static_cast<std::size_t>(kind)]; }

std::optional<ShapeKind> shape_kind(const std::string& name)
{
    for (const ShapeTraits& row : shape_kinds())
        if (name == row.name) return row.kind;
    return {};
}

Shape parse_shape(const std::string& text)
{
    std::string plain = text;
    for (char& c : plain)
        if (c == ',') c = ' ';
    std::istringstream words(plain);
    words.imbue(std::locale::classic());
    std::string name;
    words >> name;
    const auto kind = shape_kind(name);
    if (!kind) refuse_shape("'" + text + "' is no shape", all_forms());
    const ShapeTraits& row = traits_of(*kind);
    std::vector<double> numbers;
    for (double number = 0; words >> number;) numbers.push_back(number);
    const std::size_t expected = 3u + (row.axis ? 3u : 0u) + row.radius + row.second;
    if (!words.eof() || numbers.size() != expected)
        refuse_shape("'" + text + "' was expected to be '" + row.form + "', " + std::to_string(expected) + " numbers");
    Shape shape;
    shape.kind = *kind;
    shape.point = {numbers[0], numbers[1], numbers[2]};
    if (row.axis) shape.axis = {numbers[3], numbers[4], numbers[5]};
    if (row.second) shape.second = *kind == ShapeKind::cone ? numbers.back() * degree : numbers.back();
    if (row.radius) shape.radius = numbers[numbers.size() - 1 - row.second];
    check(shape);
    if (row.axis && std::fabs(length(shape.axis) - 1) > 4e-16) shape.axis = normalised(shape.axis);
    return shape;
}

std::string text_of(const Shape& shape)
{
    const ShapeTraits& row = traits_of(shape.kind);
    std::string text = std::string(row.name) + " " + exact(shape.point);
    if (row.axis) text += " " + exact(shape.axis);
    if (row.radius) text += " " + exact(shape.radius);
    if (row.second) text += " " + exact(shape.kind == ShapeKind::cone ? shape.second / degree : shape.second);
    return text;
}

void check(const Shape& shape)
{
    const ShapeTraits& row = traits_of(shape.kind);
    const std::string name = row.name;
    require_place("the place of the " + name, shape.point);
    if (row.axis && !(is_finite(shape.axis) && length(shape.axis) > 0))
        refuse_shape("the " + name + "'s " + (shape.kind == ShapeKind::plane ? "normal" : "axis") +
                     " is not finite, or has the length 0");
    if (row.radius) require_coordinate("the " + name + "'s radius", shape.radius);
    if (row.radius && !(shape.radius > 0)) refuse_shape("the " + name + "'s radius is not above 0");
    if (shape.kind == ShapeKind::cone && !(shape.second > 0 && shape.second < pi / 2))
        refuse_shape("half the cone's opening angle is not between 0 and 90 degrees");
    if (shape.kind == ShapeKind::torus && !(shape.second > 0 && shape.second < shape.radius))
        refuse_shape("the radius of the torus' tube is not between 0 and that of its circle");
}

double signed_distance(const Shape& shape, const Vec3d& p)
{
    const Vec3d d = p - shape.point;
    switch (shape.kind) {
        case ShapeKind::plane:
            return exact_dot(shape.axis, d);
        case ShapeKind::sphere:
            return length(d) - shape.radius;
        case ShapeKind::cylinder:
            return length(exact_cross(shape.axis, d)) - shape.radius;
        case ShapeKind::cone: {
            const AxisPlace place = axis_place(shape, d);
            const double c = std::cos(shape.second), s = std::sin(shape.second);
            return place.h * c + place.q * s < 0 ? length(d) : place.q * c - place.h * s;
        }
        case ShapeKind::torus:
            break;
    }
    const AxisPlace place = axis_place(shape, d);
    return std::hypot(place.q - shape.radius, place.h) - shape.second;
}

Vec3d normal_at(const Shape& shape, const Vec3d& p)
{
    const Vec3d d = p - shape.point;
    if (shape.kind == ShapeKind::plane) return shape.axis;
    if (shape.kind == ShapeKind::sphere) return length(d) > 0 ? normalised(d) : Vec3d{0, 0, 1};
    const AxisPlace place = axis_place(shape, d);
    const Vec3d across = direction_across(shape, place);
    if (shape.kind == ShapeKind::cylinder) return across;
    if (shape.kind == ShapeKind::cone) {
        const double c = std::cos(shape.second), s = std::sin(shape.second);
        if (place.h * c + place.q * s < 0 && length(d) > 0) return normalised(d);
        return c * across - s * shape.axis;
    }
    const double out = place.q - shape.radius, away = std::hypot(out, place.h);
    return away > 0 ? (out / away) * across + (place.h / away) * shape.axis : across;
}

}  // namespace pcm
