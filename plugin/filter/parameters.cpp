#include "plugin/filter/parameters.h"

#include "pcm/build/builder.h"
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

void log_warnings(const FilterRun& run, const std::vector<std::string>& warnings)
{
    for (const std::string& warning : warnings) run.warn(warning);
}

void log_notes(const FilterRun& run, const std::vector<std::string>& notes)
{
    for (const std::string& note : notes) run.log("Note: " + note);
}

}  // namespace pcm::host
