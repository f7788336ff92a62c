// Lists of measures as JSON.
#include "pcm/measure/measure_list.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace pcm {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* format = "pcm measures";
constexpr std::uint64_t most_bytes = std::uint64_t{256} << 20;

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::bad_format, {}, what); }

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

// Fields of one object. `where` names the object in errors.
class Fields {
public:
    Fields(const Json& json, std::string where) : json_(json), where_(std::move(where))
    {
        if (!json_.is_object()) refuse(where_ + " is not an object");
    }
    bool has(const char* key) const { return json_.contains(key); }
    double number(const char* key, bool needed, bool negative = false) const
    {
        if (!has(key) && !needed) return 0;
        if (!has(key) || !json_[key].is_number()) refuse(named(key) + " is not a number");
        const double value = json_[key].get<double>();
        if (!std::isfinite(value) || (value < 0 && !negative)) refuse(named(key) + " is negative, or too large");
        return value;
    }
    std::string text(const char* key, bool needed) const
    {
        if (!has(key) && !needed) return {};
        if (!has(key) || !json_[key].is_string()) refuse(named(key) + " is not a text");
        return json_[key].get<std::string>();
    }
    bool flag(const char* key) const
    {
        if (!has(key)) return false;
        if (!json_[key].is_boolean()) refuse(named(key) + " is neither true nor false");
        return json_[key].get<bool>();
    }
    const Json& array(const char* key, bool needed) const
    {
        static const Json none = Json::array();
        if (!has(key) && !needed) return none;
        if (!has(key) || !json_[key].is_array()) refuse(named(key) + " is not a list");
        return json_[key];
    }
    std::string named(const char* key) const { return "'" + std::string(key) + "' of " + where_; }

private:
    const Json& json_;
    std::string where_;
};

MeasuredPoint point_of(const Json& json, const std::string& where)
{
    const Fields fields(json, where);
    MeasuredPoint point;
    const Json& position = fields.array("position", true);
    if (position.size() != 3) refuse(fields.named("position") + " is not three numbers");
    for (std::size_t a = 0; a < 3; ++a) {
        if (!position[a].is_number()) refuse(fields.named("position") + " is not three numbers");
        point.position[a] = position[a].get<double>();
    }
    if (!is_finite(point.position)) refuse(fields.named("position") + " is not finite");
    point.spacing = fields.number("spacing", false);
    point.grid_step = fields.number("grid_step", false);
    point.cloud = fields.text("cloud", false);
    return point;
}

Measure measure_of(const Json& json, const std::string& where)
{
    const Fields fields(json, where);
    Measure measure;
    const std::string kind = fields.text("kind", true);
    const auto known = measure_kind(kind);
    if (!known) refuse(fields.named("kind") + " is '" + kind + "', which is no kind of measure");
    measure.kind = *known;
    measure.name = fields.text("name", true);
    measure.hidden = fields.flag("hidden");
    measure.width = fields.number("width", false);
    try {
        if (fields.has("surface")) measure.surface = parse_surface(fields.text("surface", true));
    } catch (const Error& error) {
        refuse(fields.named("surface") + ": " + error.what());
    }
    std::size_t number = 0;
    for (const Json& point : fields.array("points", true))
        measure.points.push_back(point_of(point, "point " + std::to_string(++number) + " of " + where));
    for (const Json& value : fields.array("computed", false)) {
        const Fields one(value, "a computed value of " + where);
        measure.computed.push_back({one.text("name", true), one.number("value", true, true),
                                    one.number("uncertainty", true), one.text("unit", true)});
    }
    return measure;
}

}  // namespace

std::string MeasureList::text() const
{
    Json json{{"format", format}, {"version", 1}, {"measures", Json::array()}};
    for (const auto& measure : measures_) json["measures"].push_back(json_of(*measure));
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

MeasureList MeasureList::parse(const std::string& text)
{
    Json json;
    try {
        json = Json::parse(text);
    } catch (const Json::exception& error) {
        refuse(std::string("this is not JSON: ") + error.what());
    }
    const Fields fields(json, "the file");
    if (!fields.has("format") || fields.text("format", true) != format)
        refuse("this is no list of measures: 'format' is not \"pcm measures\"");
    if (fields.number("version", true) != 1) refuse("'version' is not 1, the only version supported");
    MeasureList list;
    std::size_t number = 0;
    for (const Json& measure : fields.array("measures", true)) {
        const std::string where = "measure " + std::to_string(++number);
        try {
            list.add(measure_of(measure, where));
        } catch (const Error& error) {
            if (error.code() == ErrorCode::bad_format) throw;
            refuse(where + ": " + error.what());
        }
        list.undone_.clear();
    }
    return list;
}

MeasureList MeasureList::read(const std::filesystem::path& file)
{
    const File input(file, File::Mode::read);
    const std::uint64_t size = input.size();
    if (size > most_bytes)
        throw Error(ErrorCode::bad_format, file,
                    "this is no list of measures: it has " + std::to_string(size) + " bytes, more than 256 MB");
    std::string text(size, '\0');
    input.read_at(text.data(), text.size(), 0);
    try {
        return parse(text);
    } catch (const Error& error) {
        throw Error(error.code(), file, error.what());
    }
}

}  // namespace pcm
