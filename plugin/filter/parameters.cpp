#include "plugin/filter/parameters.h"

#include "pcm/build/builder.h"
#include "pcm/io/reader.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/tree/tree.h"
#include "plugin/meshlab/2020/registry.h"
#include "plugin/scene/text.h"

#include <QDir>
#include <QFileInfo>

namespace pcm::host {

namespace {

constexpr int least_memory_mb = static_cast<int>(least_build_memory >> 20);
constexpr int most_memory_mb = 1 << 24;  // 16 TiB; the library has no upper bound

Error bad_parameter(const std::string& what) { return Error(ErrorCode::invalid_argument, {}, what); }

QString readable_formats()
{
    QStringList names;
    for (const std::string& extension : readable_extensions()) names << QString::fromStdString(extension).toUpper();
    return names.join(", ");
}

}  // namespace

std::filesystem::path absolute_path(const QString& text)
{
    return QDir::cleanPath(QFileInfo(text.trimmed()).absoluteFilePath()).toStdString();
}

std::vector<std::filesystem::path> split_paths(const QString& text)
{
    std::vector<std::filesystem::path> paths;
    for (const QString& part : text.split(';', Qt::SkipEmptyParts))
        if (!part.trimmed().isEmpty()) paths.push_back(absolute_path(part));
    return paths;
}

int in_range(const RichParameterList& parameters, const char* name, const char* label, int least, int most)
{
    const int value = parameters.getInt(name);
    if (value < least || value > most)
        throw bad_parameter(std::string(label) + " is " + std::to_string(value) + "; it must be " +
                            std::to_string(least) + " to " + std::to_string(most));
    return value;
}

void add_work_parameters(RichParameterList& parameters)
{
    parameters.addParam(RichInt(
        "MemoryMB", 1024, "Memory (MB)",
        QString("Memory that the filter may use, in megabytes, at least %1. More memory makes it faster. Default 1024.")
            .arg(least_memory_mb)));
    parameters.addParam(RichInt(
        "Threads", 0, "Threads",
        QString("Number of threads, at most %1. 0, the default: one per processor core.").arg(most_build_threads)));
}

std::uint64_t memory_of(const RichParameterList& parameters)
{
    return std::uint64_t(in_range(parameters, "MemoryMB", "Memory", least_memory_mb, most_memory_mb)) << 20;
}

unsigned threads_of(const RichParameterList& parameters)
{
    return static_cast<unsigned>(in_range(parameters, "Threads", "Threads", 0, int(most_build_threads)));
}

void add_chunk_points_parameter(RichParameterList& parameters)
{
    parameters.addParam(RichInt("ChunkPoints", default_chunk_points, "Points per chunk",
                                QString("Largest number of points in a chunk, the unit that is read and drawn, from %1 "
                                        "to %2. Default %3.")
                                    .arg(least_chunk_points)
                                    .arg(most_chunk_points)
                                    .arg(default_chunk_points)));
}

std::uint32_t chunk_points_of(const RichParameterList& parameters)
{
    return static_cast<std::uint32_t>(
        in_range(parameters, "ChunkPoints", "Points per chunk", least_chunk_points, most_chunk_points));
}

void add_ignore_crs_parameter(RichParameterList& parameters)
{
    parameters.addParam(
        RichBool("IgnoreCrs", false, "Ignore coordinate systems",
                 "Combine clouds whose coordinate systems, units or kinds of GPS time differ, with their numbers as "
                 "they are; the "
                 "first system is kept, and the log names the differences. Default off: such clouds are refused."));
}

bool ignore_crs_of(const RichParameterList& parameters) { return parameters.getBool("IgnoreCrs"); }

void add_inputs_parameter(RichParameterList& parameters, const QString& meaning)
{
    parameters.addParam(RichString("Inputs", "", "Input files",
                                   "Paths of files or of folders, whose files and sub-folders are read, separated by "
                                   "semicolons; " +
                                       meaning + " Formats: " + readable_formats() + ". No default."));
    parameters.addParam(RichBool("SkipBadLines", false, "Skip bad lines",
                                 "In text, PTS and PTX, skip lines that are not points instead of refusing the file. "
                                 "Their number and the first of them are logged. Default off."));
    parameters.addParam(RichBool("SkipBadFiles", false, "Skip bad files",
                                 "Skip files that cannot be opened, and keep the points that could be read of files "
                                 "that fail later. Their number and names are logged. Default off."));
}

std::vector<std::filesystem::path> inputs_of(const RichParameterList& parameters)
{
    auto inputs = split_paths(parameters.getString("Inputs"));
    if (inputs.empty()) throw bad_parameter("no input file is given");
    return inputs;
}

ReadOptions reading_of(const RichParameterList& parameters)
{
    // Scripts of earlier versions do not have the parameters.
    const auto is_on = [&](const char* name) { return parameters.hasParameter(name) && parameters.getBool(name); };
    ReadOptions options;
    options.threads = threads_of(parameters);
    options.skip_bad_lines = is_on("SkipBadLines");
    options.skip_bad_files = is_on("SkipBadFiles");
    return options;
}

void add_largest_coordinate_parameter(RichParameterList& parameters)
{
    parameters.addParam(RichFloat(
        "LargestCoordinate", 0, "Largest coordinate",
        "Points with a coordinate above this or below its negative are left out and counted: no-data values such as "
        "3.4e38, which would leave no precision for the other points. 0, the default: no point is left out."));
}

std::optional<double> largest_coordinate_of(const RichParameterList& parameters)
{
    if (!parameters.hasParameter("LargestCoordinate")) return std::nullopt;  // a script from before it existed
    const auto value = static_cast<double>(parameters.getFloat("LargestCoordinate"));
    if (value == 0) return std::nullopt;
    if (!(value > 0)) throw bad_parameter("Largest coordinate is " + exact(value) + "; it must be positive, or 0");
    return value;
}

void add_tree_parameter(RichParameterList& parameters)
{
    parameters.addParam(RichString("Tree", "", "Tree folder",
                                   "Path of a tree folder, NAME.pct, or of the index.pct in it. Empty, the default: "
                                   "the tree that the current layer shows."));
}

std::filesystem::path tree_of(const RichParameterList& parameters, MeshDocument& document)
{
    const QString given = parameters.getString("Tree");
    return given.trimmed().isEmpty() ? shown_tree(document)->tree()->folder() : tree_folder_of(absolute_path(given));
}

std::shared_ptr<PointCloud> shown_tree(MeshDocument& document)
{
    const MeshModel* layer = document.mm();
    if (!layer) throw bad_parameter("no tree is given, and there is no current layer");
    const auto tree = Registry::instance().find(*layer);
    if (!tree)
        throw bad_parameter("no tree is given, and the current layer '" + layer->label().toStdString() +
                            "' does not show one");
    return tree->cloud;
}

std::filesystem::path as_tree(std::filesystem::path path)
{
    const std::string extension = std::string(".") + tree_extension;
    if (path.extension() != extension && is_point_file_name(path) && !std::filesystem::is_directory(path))
        throw Error(
            ErrorCode::invalid_argument, path,
            "this is the name of a file (" + path.extension().string() + "), and the result is a tree, a folder",
            "name it " + path.stem().string() + extension + ", and export the new layer to the file");
    if (path.extension() != extension) path += extension;
    return path;
}

void log_skipped(const FilterRun& run, std::uint64_t points)
{
    if (points)
        run.log(grouped(points) +
                " points without a finite position, or beyond the largest coordinate, were left out.");
}

void log_warnings(const FilterRun& run, const std::vector<std::string>& warnings)
{
    for (const std::string& warning : warnings) run.warn(warning);
}

void log_notes(const FilterRun& run, const std::vector<std::string>& notes)
{
    for (const std::string& note : notes) run.log("Note: " + note);
}

}  // namespace pcm::host
