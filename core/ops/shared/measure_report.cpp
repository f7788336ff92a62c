#include "pcm/ops/shared/measure_report.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_group.h"

#include <algorithm>

namespace pcm::ops {
namespace {

std::vector<Vec3d> grouped_points(const std::vector<double>& numbers, const std::string& called, std::size_t size,
                                  double z)
{
    if (numbers.empty() || numbers.size() % size)
        throw ArgumentError(called + " takes " + (size == 3 ? "x y z" : "x y") + " of each point, not " +
                            std::to_string(numbers.size()) + " numbers");
    std::vector<Vec3d> points;
    for (std::size_t i = 0; i < numbers.size(); i += size)
        points.push_back({numbers[i], numbers[i + 1], size == 3 ? numbers[i + 2] : z});
    return points;
}

}  // namespace

std::vector<Vec3d> points_of(const std::vector<double>& numbers, const std::string& called)
{
    return grouped_points(numbers, called, 3, 0);
}

std::vector<Vec3d> plan_points_of(const std::vector<double>& numbers, const std::string& called, double z)
{
    return grouped_points(numbers, called, 2, z);
}

std::optional<CoordinateSystem> system_of(const PointCloud& cloud)
{
    return coordinate_system_of(cloud.info().metadata);
}

Json json_of(const Measure& measure, const std::string& length_unit)
{
    Json json{{"name", measure.name}, {"kind", name_of(measure.kind)}, {"values", Json::object()}};
    try {
        for (const MeasureValue& value : values_of(measure)) {
            const bool is_length = value.unit.empty() || value.unit[0] == '^';
            json["values"][value.name] = {{"value", value.value},
                                          {"uncertainty", value.uncertainty},
                                          {"unit", is_length ? length_unit + value.unit : value.unit}};
        }
    } catch (const Error& error) {
        json["error"] = error.what();
    }
    for (const MeasuredPoint& point : measure.points) json["points"].push_back(point.position);
    return json;
}

Accuracy accuracy_of(const Measure& measure, const std::string& length_unit)
{
    try {
        const MeasureValue value = values_of(measure).front();
        const bool is_length = value.unit.empty() || value.unit[0] == '^';
        const std::string length = length_unit.empty() ? "source units" : length_unit;
        return from_deviation(value.uncertainty, is_length ? length + value.unit : value.unit, value.name);
    } catch (const Error&) {  // the measure says what is wrong with it
        return exact_answer();
    }
}

void put_lines(Result& result, const Measure& measure, const std::string& length_unit)
{
    result.line(measure.name + " (" + name_of(measure.kind) + ")");
    try {
        for (const MeasureValue& value : values_of(measure)) {
            std::string name = value.name;
            name.resize(std::max<std::size_t>(name.size(), 18), ' ');
            result.line("  " + name + " " + text_of(value, length_unit));
        }
    } catch (const Error& error) {
        result.line(std::string("  ") + error.what());
    }
}

void MeasureFiles::declare(Arguments& arguments)
{
    arguments.add("output", outputs)
        .letter('o')
        .as(ValueKind::outputs)
        .script("OutputFile")
        .label("Output file")
        .help(
            std::string("File to write the measures to, in source coordinates: .json (a list to be read again), .csv") +
            (writes_dxf() ? ", .geojson or .dxf" : " or .geojson") + "; may be given several times")
        .without("no file");
    arguments.add("overwrite", overwrite).label("Overwrite").help("Replace existing output files");
}

void MeasureFiles::check() const
{
    for (const std::string& output : outputs) {
        const auto is_known = [&](const char* known) { return lower_extension(output) == known; };
        if (std::none_of(std::begin(measure_extensions), std::end(measure_extensions), is_known))
            throw Error(ErrorCode::invalid_argument, output, "the extension says no format of measures",
                        writes_dxf() ? "use .json, .csv, .geojson or .dxf" : "use .json, .csv or .geojson");
        check_output(output, overwrite);
    }
}

void MeasureFiles::write(const MeasureList& list, const std::optional<CoordinateSystem>& system) const
{
    MeasureFileOptions options;
    options.overwrite = overwrite;
    options.system = system;
    OutputGroup group;
    for (const std::string& output : outputs) write_measures(list, output, options);
    group.put_in_place();
}

void MeasureFiles::describe(Result& result, const std::string& content) const
{
    result.values["files"] = outputs;
    if (outputs.empty()) return;
    result.output = outputs.front();
    result.makes = Makes::file;
    for (const std::string& output : outputs) result.line(output + (content.empty() ? " written" : ": " + content));
}

}  // namespace pcm::ops
