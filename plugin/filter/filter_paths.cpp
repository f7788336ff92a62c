#include "plugin/filter/filter_paths.h"

#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/tree/tree.h"

#include <QDir>
#include <QFileInfo>

namespace pcm::host {

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

std::filesystem::path tree_of(const Parameters& parameters, const Scene& scene)
{
    const QString given = parameters.has("Tree") ? parameters.text("Tree") : QString();
    if (!given.trimmed().isEmpty()) return tree_folder_of(absolute_path(given));
    const SceneLayer* const layer = scene.current();
    if (!layer) throw Error(ErrorCode::invalid_argument, {}, "no tree is given, and there is no current layer");
    const auto shown = layer->tree();
    if (!shown)
        throw Error(ErrorCode::invalid_argument, {},
                    "no tree is given, and the current layer '" + layer->label().toStdString() + "' does not show one");
    return shown->cloud->tree()->folder();
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

}  // namespace pcm::host
