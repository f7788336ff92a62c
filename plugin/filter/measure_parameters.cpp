#include "plugin/filter/measure_parameters.h"

#include "pcm/system/error.h"
#include "plugin/filter/parameters.h"
#include "plugin/scene/selection_text.h"

#include <QRegularExpression>

namespace pcm::host {

std::vector<Vec3d> points_parameter(const RichParameterList& parameters, const char* name, const char* label,
                                    std::size_t size, double z)
{
    static const QRegularExpression separators("[\\s,;]+");
    std::vector<double> numbers;
    for (const QString& word : parameters.getString(name).split(separators, Qt::SkipEmptyParts)) {
        bool good = false;
        numbers.push_back(word.toDouble(&good));
        if (!good)
            throw Error(ErrorCode::invalid_argument, {},
                        std::string(label) + ": '" + word.toStdString() + "' is not a number");
    }
    if (numbers.size() % size)
        throw Error(ErrorCode::invalid_argument, {},
                    std::string(label) + " has " + std::to_string(numbers.size()) + " numbers; it takes " +
                        std::to_string(size) + " for each point");
    std::vector<Vec3d> points;
    for (std::size_t i = 0; i < numbers.size(); i += size)
        points.push_back({numbers[i], numbers[i + 1], size == 3 ? numbers[i + 2] : z});
    return points;
}

void add_output_file_parameters(RichParameterList& parameters, const QString& formats)
{
    parameters.addParam(RichString("OutputFile", "", "Output file",
                                   "File to write the result to, in source coordinates: " + formats +
                                       ". Empty, the default: the result is only written to the log."));
    parameters.addParam(RichBool("Overwrite", false, "Overwrite",
                                 "Replace the output file if it exists; otherwise that is an error. Default off."));
}

std::filesystem::path output_file_of(const RichParameterList& parameters)
{
    const QString text = parameters.getString("OutputFile").trimmed();
    return text.isEmpty() ? std::filesystem::path() : absolute_path(text);
}

bool overwrite_of(const RichParameterList& parameters) { return parameters.getBool("Overwrite"); }

void add_part_parameters(RichParameterList& parameters)
{
    parameters.addParam(RichInt("Level", -1, "Level",
                                "Read only the cloud at this level of detail, 0 or more: quicker, with the error that "
                                "the log says. -1, the default: all points."));
    parameters.addParam(
        RichString("Where", "", "Where",
                   "Read only points that meet these conditions on attributes, separated by semicolons. Example: "
                   "classification = 2; intensity >= 100. Empty, the default: all points."));
}

std::optional<std::uint16_t> level_of(const RichParameterList& parameters, const PointCloud& cloud)
{
    const int levels = cloud.info().levels;
    const int level = in_range(parameters, "Level", "Level", -1, std::max(0, levels - 1));
    if (level < 0) return std::nullopt;
    return static_cast<std::uint16_t>(level);
}

std::vector<Condition> where_of(const RichParameterList& parameters)
{
    return parse_selection("", parameters.getString("Where")).where;
}

void log_measure(const FilterRun& run, const Measure& measure, const std::string& length_unit)
{
    run.log(measure.name + " (" + name_of(measure.kind) + "):");
    for (const MeasureValue& value : values_of(measure))
        run.log("  " + value.name + ": " + text_of(value, length_unit));
}

}  // namespace pcm::host
