#include "plugin/filter/result_parameters.h"

#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "plugin/filter/parameters.h"
#include "plugin/scene/text.h"

#include <QRegularExpression>

namespace pcm::host {

namespace {

Error bad_parameter(const std::string& what) { return Error(ErrorCode::invalid_argument, {}, what); }

}  // namespace

void add_result_parameters(RichParameterList& parameters, bool in_place)
{
    parameters.addParam(
        RichString("Output", "", "Output folder",
                   QString("The tree folder to write, NAME.pct.%1 A dialog proposes a name; scripts have no default.")
                       .arg(in_place ? " Ignored when 'In place' is on." : "")));
    if (in_place)
        parameters.addParam(RichBool("InPlace", false, "In place",
                                     "Replace the tree by the result. Until that is complete, the old tree is on disk. "
                                     "Default off."));
    parameters.addParam(RichBool("Overwrite", false, "Overwrite",
                                 "Replace an existing tree of the output's name. Only a tree is ever replaced. Default "
                                 "off."));
    add_work_parameters(parameters);
}

ResultOptions result_options_of(const RichParameterList& parameters)
{
    ResultOptions options;
    const QString output = parameters.getString("Output");
    options.target.in_place = parameters.hasParameter("InPlace") && parameters.getBool("InPlace");
    if (!options.target.in_place) {
        if (output.trimmed().isEmpty()) throw bad_parameter("no output folder is given");
        options.target.copy = as_tree(absolute_path(output));
    }
    options.overwrite = parameters.getBool("Overwrite");
    options.memory_bytes = memory_of(parameters);
    options.threads = threads_of(parameters);
    return options;
}

double decimal_of(const RichParameterList& parameters, const char* name)
{
    // The fewest digits that read back as the float are what was typed; nine always do.
    const float value = parameters.getFloat(name);
    for (int digits = 1; digits < 9; ++digits)
        if (const QString text = QString::number(static_cast<double>(value), 'g', digits); text.toFloat() == value)
            return text.toDouble();
    return static_cast<double>(value);
}

std::optional<std::vector<double>> numbers_of(const RichParameterList& parameters, const char* name, const char* label,
                                              std::size_t count)
{
    static const QRegularExpression separators("[\\s,;]+");
    const QStringList words = parameters.getString(name).split(separators, Qt::SkipEmptyParts);
    if (words.isEmpty()) return std::nullopt;
    std::vector<double> numbers;
    for (const QString& word : words) {
        bool good = false;
        numbers.push_back(word.toDouble(&good));
        if (!good) throw bad_parameter(std::string(label) + ": '" + word.toStdString() + "' is not a number");
    }
    if (numbers.size() != count)
        throw bad_parameter(std::string(label) + " has " + std::to_string(numbers.size()) + " numbers; it takes " +
                            std::to_string(count));
    return numbers;
}

std::vector<std::string> names_of(const RichParameterList& parameters, const char* name)
{
    static const QRegularExpression separators("[,;]");
    std::vector<std::string> names;
    for (const QString& part : parameters.getString(name).split(separators, Qt::SkipEmptyParts))
        if (!part.trimmed().isEmpty()) names.push_back(part.trimmed().toStdString());
    return names;
}

void log_result(const FilterRun& run, const std::string& what, const BuildReport& report)
{
    const Outcome& outcome = report.outcome;
    run.log(what + ": " + grouped(outcome.points_out) + " of " + grouped(outcome.points_in) + " points in " +
            brief(outcome.seconds) + " s, " + bytes_text(report.bytes) + "; peak memory of the program " +
            bytes_text(peak_memory_bytes()) + ".");
    log_notes(run, report.notes);
    log_warnings(run, outcome.warnings);
}

}  // namespace pcm::host
