#include "pcm/measure/measure_export.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/measure/polygon.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_file.h"
#include "pcm/system/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace pcm {
namespace {

using Json = nlohmann::ordered_json;

enum class Geometry { points, line, ring };

Geometry geometry_of(MeasureKind kind)
{
    switch (kind) {
        case MeasureKind::point:
        case MeasureKind::plane:
        case MeasureKind::surface:
            return Geometry::points;
        case MeasureKind::area:
        case MeasureKind::volume:
            return Geometry::ring;
        default:
            return Geometry::line;
    }
}

// The points, and for a ring the first one once more at its end, counter-clockwise in plan.
std::vector<Vec3d> vertices_of(const Measure& measure)
{
    std::vector<Vec3d> vertices;
    for (const MeasuredPoint& point : measure.points) vertices.push_back(point.position);
    if (geometry_of(measure.kind) == Geometry::ring && !vertices.empty()) {
        if (vector_area(vertices)[2] < 0) std::reverse(vertices.begin() + 1, vertices.end());
        vertices.push_back(vertices.front());
    }
    return vertices;
}

const char* wkt_word(const Measure& measure)
{
    switch (geometry_of(measure.kind)) {
        case Geometry::points:
            return measure.points.size() == 1 ? "POINT Z (" : "MULTIPOINT Z (";
        case Geometry::ring:
            return "POLYGON Z ((";
        case Geometry::line:
            break;
    }
    return "LINESTRING Z (";
}

std::string wkt_of(const Measure& measure)
{
    if (measure.points.empty()) return {};
    std::string text = wkt_word(measure);
    const bool several = geometry_of(measure.kind) == Geometry::points && measure.points.size() > 1;
    const std::vector<Vec3d> vertices = vertices_of(measure);
    for (std::size_t i = 0; i < vertices.size(); ++i)
        text += (i ? ", " : "") + (several ? "(" + exact(vertices[i]) + ")" : exact(vertices[i]));
    return text + (geometry_of(measure.kind) == Geometry::ring ? "))" : ")");
}

// "m", "m^2": empty where the unit of lengths is not known.
std::string unit_name(const std::string& unit, const std::string& length_unit)
{
    if (unit == "deg" || unit == "%") return unit;
    return length_unit.empty() ? unit : length_unit + unit;
}

struct Numbers {
    std::vector<MeasureValue> values;
    std::string note;  // why there are none
};

Numbers numbers_of(const Measure& measure)
{
    try {
        return {values_of(measure), {}};
    } catch (const Error& error) {
        return {{}, error.what()};
    }
}

std::string csv_of(const MeasureList& list, const std::string& length_unit)
{
    std::string text = "name,kind,quantity,value,uncertainty,unit,geometry,note\r\n";
    for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string head = csv_field(list[i].name) + "," + name_of(list[i].kind) + ",";
        const std::string geometry = csv_field(wkt_of(list[i]));
        const Numbers numbers = numbers_of(list[i]);
        for (const MeasureValue& value : numbers.values)
            text += head + csv_field(value.name) + "," + exact(value.value) + "," + exact(value.uncertainty) + "," +
                    csv_field(unit_name(value.unit, length_unit)) + "," + geometry + ",\r\n";
        if (numbers.values.empty()) text += head + ",,,," + geometry + "," + csv_field(numbers.note) + "\r\n";
    }
    return text;
}

Json geometry_json(const Measure& measure)
{
    if (measure.points.empty()) return nullptr;
    const std::vector<Vec3d> vertices = vertices_of(measure);
    switch (geometry_of(measure.kind)) {
        case Geometry::points:
            if (vertices.size() == 1) return {{"type", "Point"}, {"coordinates", vertices[0]}};
            return {{"type", "MultiPoint"}, {"coordinates", vertices}};
        case Geometry::ring:
            return {{"type", "Polygon"}, {"coordinates", Json::array({vertices})}};
        case Geometry::line:
            break;
    }
    return {{"type", "LineString"}, {"coordinates", vertices}};
}

Json feature_of(const Measure& measure, const std::string& length_unit)
{
    Json properties{{"name", measure.name}, {"kind", name_of(measure.kind)}};
    const Numbers numbers = numbers_of(measure);
    for (const MeasureValue& value : numbers.values) {
        std::string key = value.name;
        std::replace(key.begin(), key.end(), ' ', '_');
        properties[key] = value.value;
        properties[key + "_uncertainty"] = value.uncertainty;
        if (const std::string unit = unit_name(value.unit, length_unit); !unit.empty())
            properties[key + "_unit"] = unit;
    }
    if (!numbers.note.empty()) properties["note"] = numbers.note;
    if (measure.hidden) properties["hidden"] = true;
    return {{"type", "Feature"}, {"properties", properties}, {"geometry", geometry_json(measure)}};
}

std::string geojson_of(const MeasureList& list, const std::optional<CoordinateSystem>& system)
{
    Json json{{"type", "FeatureCollection"}};
    if (system) {
        const CrsPart& part = system->horizontal;
        if (part.code && !part.authority.empty())
            json["crs"] = {
                {"type", "name"},
                {"properties", {{"name", "urn:ogc:def:crs:" + part.authority + "::" + std::to_string(part.code)}}}};
        json["coordinate_system"] = describe(*system);
    }
    json["features"] = Json::array();
    for (std::size_t i = 0; i < list.size(); ++i)
        json["features"].push_back(feature_of(list[i], length_unit_of(system)));
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string layer_of(const Measure& measure) { return std::string("pcm_") + name_of(measure.kind); }

void draw(DxfFile& dxf, const Measure& measure, double text_height, const std::string& length_unit)
{
    const std::string layer = layer_of(measure);
    const std::vector<Vec3d> vertices = vertices_of(measure);
    if (geometry_of(measure.kind) == Geometry::points) {
        for (const Vec3d& p : vertices) dxf.point(layer, p);
    } else if (geometry_of(measure.kind) == Geometry::ring) {
        dxf.polyline(layer, {vertices.begin(), vertices.end() - 1}, true);
    } else if (vertices.size() > 1) {
        dxf.polyline(layer, vertices, false);
    }
    dxf.text(layer, vertices[0], text_height, measure.name + ": " + label_of(measure, length_unit));
}

void write_drawing(const MeasureList& list, const std::filesystem::path& file, const MeasureFileOptions& options)
{
    std::vector<const Measure*> shown;
    std::set<std::string> layers;
    Box3d box;
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (list[i].hidden || list[i].points.empty()) continue;
        shown.push_back(&list[i]);
        layers.insert(layer_of(list[i]));
        for (const MeasuredPoint& point : list[i].points) box.extend(point.position);
    }
    double height = options.text_height > 0 ? options.text_height : box.diagonal() / 100;
    if (!(height > 0)) height = 1;
    std::vector<DxfLayer> table;
    for (const std::string& name : layers) table.push_back({name, static_cast<int>(1 + table.size() % 6)});
    DxfFile dxf(file, table);
    for (const Measure* measure : shown) draw(dxf, *measure, height, length_unit_of(options.system));
    dxf.finish();
}

}  // namespace

std::string length_unit_of(const std::optional<CoordinateSystem>& system)
{
    if (!system || system->kind == CrsKind::geographic || !system->horizontal.unit.is_known()) return {};
    const CrsUnit& unit = system->horizontal.unit;
    return unit.per_unit == 1 ? "m" : unit.name;
}

std::string caution_of(const std::optional<CoordinateSystem>& system)
{
    if (!system || system->kind != CrsKind::geographic) return {};
    return "the coordinates are longitude and latitude: lengths, areas and volumes mix degrees with the unit of "
           "heights; "
           "convert the cloud to a projected system to measure it";
}

void write_measures(const MeasureList& list, const std::filesystem::path& file, const MeasureFileOptions& options)
{
    const std::string extension = lower_extension(file);
    const auto known = [&](const char* other) { return extension == other; };
    if (std::none_of(std::begin(measure_extensions), std::end(measure_extensions), known))
        throw Error(ErrorCode::invalid_argument, file, "the extension says no format of measures",
                    "use .json, .csv, .geojson or .dxf");
    check_output(file, options.overwrite);
    if (extension == ".dxf") {
        write_drawing(list, file, options);
        return;
    }
    const std::string text = extension == ".json"  ? list.text()
                             : extension == ".csv" ? csv_of(list, length_unit_of(options.system))
                                                   : geojson_of(list, options.system);
    OutputFile output(file);
    output.append(text);
    output.finish();
}

}  // namespace pcm
