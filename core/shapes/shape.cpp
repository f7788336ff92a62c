#include "pcm/shapes/shape.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/numbers.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <cmath>
#include <sstream>

namespace pcm {
namespace {

[[noreturn]] void refuse_shape(const std::string& what, const std::string& hint = {})
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

std::string all_forms()
{
    std::string forms = "one of: ";
    std::string separator;
    for (const ShapeTraits& row : shape_kinds()) {
        forms += separator + "'" + row.form + "'";
        separator = ", ";
    }
    return forms;
}

}  // namespace

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
    if (!kind) refuse_shape("'" + text + "' is not a shape", all_forms());
    const ShapeTraits& row = traits_of(*kind);
    std::vector<double> numbers;
    for (double number = 0; words >> number;) numbers.push_back(number);
    const std::size_t expected = 3u + (row.has_axis() ? 3u : 0u) + row.sizes.size();
    if (!words.eof() || numbers.size() != expected)
        refuse_shape("'" + text + "' was expected to be '" + row.form + "', " + std::to_string(expected) + " numbers");
    Shape shape;
    shape.kind = *kind;
    shape.point = {numbers[0], numbers[1], numbers[2]};
    if (row.has_axis()) shape.axis = {numbers[3], numbers[4], numbers[5]};
    std::size_t next = expected - row.sizes.size();
    for (const ShapeSize& size : row.sizes) {
        const double number = numbers[next++];
        shape.*size.value = size.unit == SizeUnit::angle ? number * degree : number;
    }
    check(shape);
    if (row.has_axis() && std::fabs(length(shape.axis) - 1) > 4e-16) shape.axis = normalised(shape.axis);
    return shape;
}

std::string text_of(const Shape& shape)
{
    const ShapeTraits& row = traits_of(shape.kind);
    std::string text = std::string(row.name) + " " + exact(shape.point);
    if (row.has_axis()) text += " " + exact(shape.axis);
    for (const ShapeSize& size : row.sizes) {
        const double number = shape.*size.value;
        text += " " + exact(size.unit == SizeUnit::angle ? number / degree : number);
    }
    return text;
}

void check(const Shape& shape)
{
    const ShapeTraits& row = traits_of(shape.kind);
    const std::string name = row.name;
    require_place("the place of the " + name, shape.point);
    if (row.has_axis() && !(is_finite(shape.axis) && length(shape.axis) > 0))
        refuse_shape("the " + name + "'s " + row.axis_name() + " is not finite, or has the length 0");
    if (row.has_radius()) require_coordinate("the " + name + "'s radius", shape.radius);
    if (row.has_radius() && !(shape.radius > 0)) refuse_shape("the " + name + "'s radius is not above 0");
    if (const char* const fault = row.fault(shape)) refuse_shape(fault);
}

bool is_proper(const Shape& shape)
{
    const ShapeTraits& row = traits_of(shape.kind);
    if (!is_finite(shape.point) || (row.has_axis() && !is_finite(shape.axis))) return false;
    if (row.has_radius() && !(std::isfinite(shape.radius) && shape.radius > 0)) return false;
    return !row.fault(shape);
}

double narrowest_radius(const Shape& shape)
{
    double radius = 0;
    for (const ShapeSize& size : traits_of(shape.kind).sizes)
        if (size.unit == SizeUnit::length) radius = shape.*size.value;
    return radius;
}

}  // namespace pcm
