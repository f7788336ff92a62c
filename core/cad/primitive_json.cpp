// Lists of primitives as JSON. Angles are in radians here, so that every number reads back as the same double.
#include "pcm/cad/primitive_files.h"
#include "pcm/cloud/numbers.h"
#include "pcm/lists/json_fields.h"
#include "pcm/lists/undo_list.h"
#include "pcm/system/bounded_json.h"
#include "pcm/system/error.h"

#include <cmath>
#include <limits>

namespace pcm {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* format = "pcm primitives";
constexpr std::uint64_t most_count = std::numeric_limits<std::uint64_t>::max();

double finite(double value, const Primitive& primitive)
{
    if (!std::isfinite(value))
        throw Error(ErrorCode::invalid_argument, {},
                    "the primitive '" + primitive.name + "' has a number that is not finite: it cannot be kept");
    return value;
}

Json vector_json(const Vec3d& v, const Primitive& primitive)
{
    return {finite(v[0], primitive), finite(v[1], primitive), finite(v[2], primitive)};
}

// Standard deviations and the condition may be infinite, for which JSON has null.
Json null_if_infinite(double value, const Primitive& primitive)
{
    if (value == infinity) return nullptr;
    return finite(value, primitive);
}

void put_shape(Json& json, const Primitive& primitive)
{
    const Shape& shape = primitive.fit.shape;
    const ShapeTraits& traits = traits_of(shape.kind);
    json["kind"] = traits.name;
    json["point"] = vector_json(shape.point, primitive);
    if (traits.has_axis()) json["axis"] = vector_json(shape.axis, primitive);
    for (const ShapeSize& size : traits.sizes) json[size.key] = finite(shape.*size.value, primitive);
}

void put_bounds(Json& json, const Primitive& primitive)
{
    const ShapeBounds& bounds = primitive.bounds;
    const ShapeTraits& traits = traits_of(primitive.fit.shape.kind);
    Json own = Json::object();
    if (traits.extent == ShapeExtent::outline)
        for (const Vec3d& corner : bounds.outline) own["outline"].push_back(vector_json(corner, primitive));
    if (traits.has_length() && (bounds.from != 0 || bounds.to != 0)) {
        own["from"] = finite(bounds.from, primitive);
        own["to"] = finite(bounds.to, primitive);
    }
    if (traits.has_arc() && bounds.zero != Vec3d{}) {
        own["zero"] = vector_json(bounds.zero, primitive);
        own["begin"] = finite(bounds.begin, primitive);
        own["end"] = finite(bounds.end, primitive);
    }
    if (!own.empty()) json["bounds"] = own;
}

void put_fit(Json& json, const Primitive& primitive)
{
    const ShapeFit& fit = primitive.fit;
    const ShapeErrors& errors = fit.errors;
    json["sigma"] = {{"position", null_if_infinite(errors.position, primitive)},
                     {"angle", null_if_infinite(errors.angle, primitive)},
                     {"radius", null_if_infinite(errors.radius, primitive)},
                     {"second", null_if_infinite(errors.second, primitive)}};
    json["rms"] = finite(fit.rms, primitive);
    json["noise"] = finite(fit.noise, primitive);
    json["threshold"] = finite(fit.threshold, primitive);
    json["condition"] = null_if_infinite(fit.condition, primitive);
    json["inliers"] = fit.inliers;
    json["verdict"] = name_of(fit.verdict);
    if (fit.issue != FitIssue::none) json["issue"] = name_of(fit.issue);
    if (!fit.message.empty()) json["message"] = fit.message;
    json["iterations"] = fit.iterations;
    json["seconds"] = finite(fit.seconds, primitive);
}

void put_stations(Json& json, const Primitive& primitive)
{
    if (!primitive.stations) return;
    const StationFacts& facts = *primitive.stations;
    json["stations"] = {{"source", name_of(facts.source)},
                        {"count", facts.stations},
                        {"spread", finite(facts.spread, primitive)},
                        {"freedom", facts.freedom},
                        {"registration", finite(facts.registration, primitive)}};
    if (facts.turn > 0) json["stations"]["turn"] = finite(facts.turn, primitive);
    if (facts.ray_share > 0) json["stations"]["ray_share"] = finite(facts.ray_share, primitive);
}

Json json_of(const Primitive& primitive)
{
    check_list_name(primitive.name, "primitive");
    check(primitive.fit.shape);
    Json json{{"name", primitive.name}, {"colour", primitive.colour}};
    if (primitive.hidden) json["hidden"] = true;
    put_shape(json, primitive);
    put_bounds(json, primitive);
    put_fit(json, primitive);
    put_stations(json, primitive);
    json["points"] = primitive.points;
    if (primitive.label) json["label"] = primitive.label;
    if (!primitive.estimator.empty()) json["estimator"] = primitive.estimator;
    if (!primitive.cloud.empty()) json["cloud"] = primitive.cloud;
    return json;
}

// The enumerator that is written as the field's text; the first where the field is not there.
template <class Enumerator>
Enumerator chosen(const JsonFields& fields, const char* key, Enumerator last)
{
    if (!fields.has(key)) return {};
    const std::string text = fields.text(key, true);
    for (int i = 0; i <= static_cast<int>(last); ++i)
        if (text == name_of(static_cast<Enumerator>(i))) return static_cast<Enumerator>(i);
    fields.refuse(key, " is '" + text + "', which is not known");
}

Shape shape_of(const JsonFields& fields)
{
    const std::string name = fields.text("kind", true);
    const auto kind = shape_kind(name);
    if (!kind) fields.refuse("kind", " is '" + name + "', which is not a kind of shape");
    const ShapeTraits& traits = traits_of(*kind);
    Shape shape;
    shape.kind = *kind;
    shape.point = fields.vector("point");
    if (traits.has_axis()) shape.axis = fields.vector("axis");
    for (const ShapeSize& size : traits.sizes) shape.*size.value = fields.number(size.key, true);
    try {
        check(shape);
    } catch (const Error& error) {
        fields.refuse("kind", std::string(": ") + error.what());
    }
    if (traits.has_axis() && std::fabs(length(shape.axis) - 1) > 4e-16)
        shape.axis = normalised(shape.axis / largest_magnitude(shape.axis));
    return shape;
}

ShapeBounds bounds_of_fields(const JsonFields& fields, const Shape& shape)
{
    const ShapeTraits& traits = traits_of(shape.kind);
    ShapeBounds bounds;
    if (traits.extent == ShapeExtent::outline) {
        std::size_t number = 0;
        for (const Json& corner : fields.list("outline", false))
            bounds.outline.push_back(
                vector_of(corner, "corner " + std::to_string(++number) + " of " + fields.named("outline")));
        if (number == 1 || number == 2) fields.refuse("outline", " has fewer than three corners");
    }
    if (traits.has_length()) {
        bounds.from = fields.number("from", false, true);
        bounds.to = fields.number("to", false, true);
        if (bounds.from > bounds.to) fields.refuse("from", " is greater than 'to'");
        if (traits.extent == ShapeExtent::length_from_apex && bounds.from < 0)
            fields.refuse("from", std::string(" is before the ") + traits.name + "'s apex");
    }
    if (!traits.has_arc() || !fields.has("zero")) return bounds;
    bounds.zero = fields.vector("zero");
    bounds.begin = fields.number("begin", true);
    bounds.end = fields.number("end", true);
    if (!(std::fabs(length(bounds.zero) - 1) < 1e-6 && std::fabs(dot(bounds.zero, shape.axis)) < 1e-6))
        fields.refuse("zero", " is not a unit vector across the axis");
    if (!(bounds.begin < 2 * pi)) fields.refuse("begin", " is not below 2 pi");
    if (!(bounds.begin < bounds.end && bounds.end <= bounds.begin + 2 * pi))
        fields.refuse("end", " is not between 'begin' and a whole circle more");
    return bounds;
}

ShapeFit fit_of(const JsonFields& fields)
{
    ShapeFit fit;
    fit.shape = shape_of(fields);
    fit.verdict = fields.has("verdict") ? chosen(fields, "verdict", FitVerdict::refused) : FitVerdict::good;
    fit.issue = chosen(fields, "issue", FitIssue::uneven);
    fit.message = fields.text("message", false);
    if (fields.has("sigma")) {
        const JsonFields sigma = fields.object("sigma");
        fit.errors = {sigma.number_or_null("position"), sigma.number_or_null("angle"), sigma.number_or_null("radius"),
                      sigma.number_or_null("second")};
    }
    fit.rms = fields.number("rms", false);
    fit.noise = fields.number("noise", false);
    fit.threshold = fields.number("threshold", false);
    fit.condition = fields.number_or_null("condition");
    fit.inliers = fields.whole("inliers", most_count);
    fit.iterations = fields.whole("iterations", most_count);
    fit.seconds = fields.number("seconds", false);
    return fit;
}

StationFacts stations_of(const JsonFields& fields)
{
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    StationFacts facts;
    facts.source = chosen(fields, "source", StationSource::time_gaps);
    facts.stations = static_cast<std::uint32_t>(fields.whole("count", most));
    facts.spread = fields.number("spread", false);
    facts.freedom = static_cast<std::uint32_t>(fields.whole("freedom", most));
    facts.registration = fields.number("registration", false);
    if (fields.has("turn")) facts.turn = fields.number("turn", false);
    if (fields.has("ray_share")) facts.ray_share = fields.number("ray_share", false);
    return facts;
}

Primitive primitive_of(const Json& json, const std::string& where)
{
    const JsonFields fields(json, where);
    Primitive primitive;
    primitive.name = fields.text("name", true);
    try {
        check_list_name(primitive.name, "primitive");
    } catch (const Error& error) {
        fields.refuse("name", std::string(": ") + error.what());
    }
    const Json& colour = fields.list("colour", false);
    if (!colour.empty()) {
        if (colour.size() != 3) fields.refuse("colour", " is not three numbers from 0 to 255");
        for (std::size_t a = 0; a < 3; ++a) {
            if (!colour[a].is_number_unsigned() || colour[a].get<std::uint64_t>() > 255)
                fields.refuse("colour", " is not three numbers from 0 to 255");
            primitive.colour[a] = colour[a].get<std::uint8_t>();
        }
    }
    primitive.hidden = fields.flag("hidden");
    primitive.cloud = fields.text("cloud", false);
    primitive.fit = fit_of(fields);
    if (fields.has("bounds")) primitive.bounds = bounds_of_fields(fields.object("bounds"), primitive.fit.shape);
    if (fields.has("stations")) primitive.stations = stations_of(fields.object("stations"));
    primitive.points = fields.whole("points", most_count);
    primitive.label = static_cast<std::uint32_t>(fields.whole("label", std::numeric_limits<std::uint32_t>::max()));
    primitive.estimator = fields.text("estimator", false);
    return primitive;
}

}  // namespace

std::string json_of(const std::vector<Primitive>& primitives)
{
    Json json{{"format", format}, {"version", 1}, {"angles", "radians"}, {"primitives", Json::array()}};
    for (const Primitive& primitive : primitives) json["primitives"].push_back(json_of(primitive));
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<Primitive> parse_primitives(const std::string& text)
{
    const Json json = parse_bounded_json(text);
    const JsonFields fields(json, "the file");
    if (!fields.has("format") || fields.text("format", true) != format)
        throw Error(ErrorCode::bad_format, {}, "this is not a list of primitives: 'format' is not \"pcm primitives\"");
    if (fields.number("version", true) != 1) fields.refuse("version", " is not 1, the only version supported");
    std::vector<Primitive> primitives;
    for (const Json& primitive : fields.list("primitives", true))
        primitives.push_back(primitive_of(primitive, "primitive " + std::to_string(primitives.size() + 1)));
    return primitives;
}

std::vector<Primitive> read_primitives(const std::filesystem::path& file)
{
    const std::string text = read_list_file(file, "primitives");
    try {
        return parse_primitives(text);
    } catch (const Error& error) {
        throw Error(error.code(), file, error.what());
    }
}

}  // namespace pcm
