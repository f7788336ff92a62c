#include "filter/filter_plugin.h"

#include "filter/tree_information.h"
#include "host/layer.h"
#include "host/operation.h"
#include "host/text.h"
#include "tree/builder.h"

#include <QDir>
#include <QFileInfo>

using namespace pcm;
using namespace pcm::host;

namespace {

std::filesystem::path absolute_path(const QString& text)
{
    return QDir::cleanPath(QFileInfo(text.trimmed()).absoluteFilePath()).toStdString();
}

Error bad_parameter(const std::string& what) { return Error(ErrorCode::invalid_argument, {}, what); }

int in_range(const RichParameterList& parameters, const char* name, const char* label, int least, int most)
{
    const int value = parameters.getInt(name);
    if (value < least || value > most)
        throw bad_parameter(std::string(label) + " is " + std::to_string(value) + "; it must be " +
                            std::to_string(least) + " to " + std::to_string(most));
    return value;
}

std::vector<std::filesystem::path> split_paths(const QString& text)
{
    std::vector<std::filesystem::path> paths;
    for (const QString& part : text.split(';', Qt::SkipEmptyParts))
        if (!part.trimmed().isEmpty()) paths.push_back(absolute_path(part));
    return paths;
}

QString readable_formats()
{
    QStringList names;
    for (const std::string& extension : readable_extensions()) names << QString::fromStdString(extension).toUpper();
    return names.join(", ");
}

// The output's name ends in .pct, which is how MeshLab recognises it.
std::filesystem::path output_path(const QString& text, const std::filesystem::path& first_input)
{
    const std::string extension = std::string(".") + tree_extension;
    if (text.trimmed().isEmpty()) {
        std::filesystem::path output = first_input;
        return std::filesystem::is_directory(first_input) ? output += extension : output.replace_extension(extension);
    }
    std::filesystem::path output = absolute_path(text);
    if (output.extension() != extension) output += extension;
    return output;
}

}  // namespace

PointCloudFilters::PointCloudFilters()
{
    typeList << build_tree_filter << tree_information_filter;
    for (const FilterIDType filter : types()) {
        auto* action = new QAction(filterName(filter), this);
        // Without a layer MeshLab disables what is in the menu of our other class.
        connect(action, &QAction::changed, action, [action] { action->setEnabled(true); });
        actionList << action;
    }
}

QString PointCloudFilters::filterName(FilterIDType filter) const
{
    switch (filter) {
        case build_tree_filter:
            return "Build Point Cloud Tree";
        case tree_information_filter:
            return "Point Cloud Tree Information";
    }
    return {};
}

QString PointCloudFilters::filterInfo(FilterIDType filter) const
{
    switch (filter) {
        case build_tree_filter:
            return "Reads one or more point cloud files, of any size, and writes a <b>point cloud tree</b>: a folder "
                   "of chunks "
                   "at several levels of detail that MeshLab opens in moments and draws without ever loading all of "
                   "it.<br>"
                   "All points are kept, with all their attributes. The build works in bounded memory; Esc cancels it.";
        case tree_information_filter:
            return "Writes to the log what a point cloud tree holds: points, bounds in source coordinates, attributes, "
                   "levels "
                   "with their spacing, size, and the largest error of a position.";
    }
    return {};
}

MeshFilterInterface::FilterClass PointCloudFilters::getClass(QAction* action)
{
    // MeshLab offers only filters of the class MeshCreation when there is no layer. It also resets the view after them,
    // which giving information should not do; but the menus are made before any filter is applied.
    if (ID(action) == build_tree_filter) return FilterClass(MeshCreation | PointSet);
    return information_given_ ? Measure : FilterClass(MeshCreation | Measure);
}

void PointCloudFilters::initParameterSet(QAction* action, MeshDocument&, RichParameterList& parameters)
{
    switch (ID(action)) {
        case build_tree_filter:
            parameters.addParam(RichString("Inputs", "", "Input files",
                                           "Paths of files, or of folders of files, separated by semicolons; together "
                                           "they become one cloud. Readable: " +
                                               readable_formats() + "."));
            parameters.addParam(
                RichString("Output", "", "Output folder",
                           "The tree folder to write, NAME.pct. Default: beside the first input, named like it."));
            parameters.addParam(
                RichInt("MemoryMB", 1024, "Memory (MB)",
                        "Memory that the build may use, in megabytes, at least 64. More is faster. Default 1024."));
            parameters.addParam(
                RichInt("Threads", 0, "Threads", "Threads of the build. 0, the default: one a processor."));
            parameters.addParam(
                RichInt("ChunkPoints", 100000, "Points per chunk",
                        "Most points of a chunk, the unit that is read and drawn, from 1000. Default 100000."));
            parameters.addParam(
                RichBool("Fast", false, "Fast levels",
                         "Choose the points of each level by a grid: about twice as quick a build, and less even a picture from "
                         "afar. All points are kept either way. Default off: every level is a Poisson-disk sample."));
            parameters.addParam(
                RichBool("Overwrite", false, "Overwrite",
                         "Replace an existing tree of this name. Nothing but a tree is ever replaced. Default off."));
            parameters.addParam(
                RichBool("Open", true, "Open when done", "Add a layer that shows the new tree. Default on."));
            break;
        case tree_information_filter:
            parameters.addParam(
                RichString("Tree", "", "Tree folder",
                           "Path of a tree folder, NAME.pct. Empty, the default: the tree of the current layer."));
            break;
    }
}

bool PointCloudFilters::applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                                    vcg::CallBackPos* callback)
{
    errorMessage.clear();
    try {
        switch (ID(action)) {
            case build_tree_filter:
                build(document, parameters, callback);
                break;
            case tree_information_filter:
                information_given_ = true;
                information(document, parameters);
                break;
        }
        return true;
    } catch (...) {
        // Whatever escapes from here would leave the document busy for ever. meshlabserver prints the log only.
        const std::string error = current_error();
        errorMessage = QString::fromStdString(error);
        Log(GLLogStream::WARNING, filterName(ID(action)).toStdString() + ": " + error);
        return false;
    }
}

void PointCloudFilters::build(MeshDocument& document, const RichParameterList& parameters, vcg::CallBackPos* callback)
{
    const auto inputs = split_paths(parameters.getString("Inputs"));
    if (inputs.empty()) throw bad_parameter("no input file is given");
    const std::filesystem::path output = output_path(parameters.getString("Output"), inputs.front());
    BuildOptions options;
    options.memory_bytes = std::uint64_t(in_range(parameters, "MemoryMB", "Memory", 64, 1 << 24)) << 20;
    options.threads = static_cast<unsigned>(in_range(parameters, "Threads", "Threads", 0, 1024));
    options.chunk_points =
        static_cast<std::uint32_t>(in_range(parameters, "ChunkPoints", "Points per chunk", 1000, 100'000'000));
    options.sampling = parameters.getBool("Fast") ? Sampling::grid : Sampling::poisson;
    options.overwrite = parameters.getBool("Overwrite");

    Operation operation(callback);
    options.progress = operation.progress();
    const BuildReport report = build_tree(inputs, output, options);
    const Outcome& outcome = report.outcome;
    say("Built " + output.string() + ": " + grouped(outcome.points_out) + " points in " + brief(outcome.seconds) +
        " s" +
        (outcome.seconds > 0
             ? " (" + brief(static_cast<double>(outcome.points_out) / outcome.seconds / 1e6) + " M points/s)"
             : std::string()) +
        ", " + grouped(report.nodes) + " chunks on " + std::to_string(report.levels) + " levels, " +
        bytes_text(report.bytes) + ".");
    say("Largest position error: " + exact(outcome.error) + " source units.");
    if (report.points_skipped) say(grouped(report.points_skipped) + " points without a finite position were left out.");
    for (const std::string& note : report.notes) say("Note: " + note);

    if (!parameters.getBool("Open")) return;
    const auto cloud = Registry::instance().open(output);
    MeshModel* layer = document.addNewMesh(QString::fromStdString(output.string()),
                                           QString::fromStdString(output.filename().string()));
    try {
        for (const std::string& line : show_tree(*layer, cloud)) say(line);
    } catch (...) {
        document.delMesh(layer);
        throw;
    }
}

void PointCloudFilters::information(MeshDocument& document, const RichParameterList& parameters)
{
    const QString given = parameters.getString("Tree");
    if (!given.trimmed().isEmpty()) {
        for (const std::string& line : tree_information(*Tree::open(absolute_path(given)))) say(line);
        return;
    }
    const MeshModel* layer = document.mm();
    if (!layer) throw bad_parameter("no tree is given, and there is no current layer");
    const auto tree = Registry::instance().find(*layer);
    if (!tree)
        throw bad_parameter("no tree is given, and the current layer '" + layer->label().toStdString() +
                            "' does not show one");
    for (const std::string& line : tree_information(*tree->cloud->tree())) say(line);
}
