// Lists of measures as JSON.
#include "pcm/lists/json_fields.h"
#include "pcm/measure/measure_list.h"
#include "pcm/system/bounded_json.h"
#include "pcm/system/error.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace pcm {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* format = "pcm measures";

[[noreturn]] void refuse_list(const std::string& what) { throw Error(ErrorCode::bad_format, {}, what); }

double finite(double value, const Measure& measure)
{
    if (!std::isfinite(value))
        throw Error(ErrorCode::invalid_argument, {},
                    "the measure '" + measure.name + "' has a number that is not finite: it cannot be kept");
    return value;
}

Json json_of(const MeasuredPoint& point, const Measure& measure)
{
    Json json;
    for (const double x : point.position) json["position"].push_back(finite(x, measure));
    if (point.spacing != 0) json["spacing"] = finite(point.spacing, measure);
    if (point.grid_step != 0) json["grid_step"] = finite(point.grid_step, measure);
    if (!point.cloud.empty()) json["cloud"] = point.cloud;
    return json;
}

Json json_of(const Measure& measure)
{
    Json json{{"kind", name_of(measure.kind)}, {"name", measure.name}};
    if (measure.hidden) json["hidden"] = true;
    if (measure.width != 0) json["width"] = finite(measure.width, measure);
    if (measure.surface) json["surface"] = text_of(*measure.surface);
    json["points"] = Json::array();
    for (const MeasuredPoint& point : measure.points) json["points"].push_back(json_of(point, measure));
    for (const MeasureValue& value : measure.computed)
        json["computed"].push_back({{"name", value.name},
                                    {"value", finite(value.value, measure)},
                                    {"uncertainty", finite(value.uncertainty, measure)},
                                    {"unit", value.unit}});
    return json;
}

MeasuredPoint point_of(const Json& json, const std::string& where)
{
    const JsonFields fields(json, where);
    MeasuredPoint point;
    point.position = fields.vector("position");
    point.spacing = fields.number("spacing", false);
    point.grid_step = fields.number("grid_step", false);
    point.cloud = fields.text("cloud", false);
    return point;
}

Measure measure_of(const Json& json, const std::string& where)
{
    const JsonFields fields(json, where);
    Measure measure;
    const std::string kind = fields.text("kind", true);
    const auto known = measure_kind(kind);
    if (!known) refuse_list(fields.named("kind") + " is '" + kind + "', which is no kind of measure");
    measure.kind = *known;
    measure.name = fields.text("name", true);
    measure.hidden = fields.flag("hidden");
    measure.width = fields.number("width", false);
    try {
        if (fields.has("surface")) measure.surface = parse_shape(fields.text("surface", true));
    } catch (const Error& error) {
        refuse_list(fields.named("surface") + ": " + error.what());
    }
    std::size_t number = 0;
    for (const Json& point : fields.list("points", true))
        measure.points.push_back(point_of(point, "point " + std::to_string(++number) + " of " + where));
    for (const Json& value : fields.list("computed", false)) {
        const JsonFields one(value, "a computed value of " + where);
        measure.computed.push_back({one.text("name", true), one.number("value", true, true),
                                    one.number("uncertainty", true), one.text("unit", true)});
    }
    return measure;
}

}  // namespace

std::string MeasureList::text() const
{
    Json json{{"format", format}, {"version", 1}, {"measures", Json::array()}};
    for (std::size_t i = 0; i < size(); ++i) json["measures"].push_back(json_of((*this)[i]));
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

MeasureList MeasureList::parse(const std::string& text)
{
    const Json json = parse_bounded_json(text);
    const JsonFields fields(json, "the file");
    if (!fields.has("format") || fields.text("format", true) != format)
        refuse_list("this is no list of measures: 'format' is not \"pcm measures\"");
    if (fields.number("version", true) != 1) refuse_list("'version' is not 1, the only version supported");
    MeasureList list;
    std::size_t number = 0;
    for (const Json& measure : fields.list("measures", true)) {
        const std::string where = "measure " + std::to_string(++number);
        try {
            list.add(measure_of(measure, where));
        } catch (const Error& error) {
            if (error.code() == ErrorCode::bad_format) throw;
            refuse_list(where + ": " + error.what());
        }
        list.forget_steps();
    }
    return list;
}

MeasureList MeasureList::read(const std::filesystem::path& file)
{
    const std::string text = read_list_file(file, "measures");
    try {
        return parse(text);
    } catch (const Error& error) {
        throw Error(error.code(), file, error.what());
    }
}

}  // namespace pcm
