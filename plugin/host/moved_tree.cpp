#include "plugin/host/moved_tree.h"

#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"
#include "plugin/host/layer.h"
#include "plugin/host/misfit.h"

#include <utility>

namespace pcm::host {

BuildReport write_moved_tree(const std::shared_ptr<const Tree>& tree, const std::vector<Affine>& maps,
                             const std::filesystem::path& output, BuildOptions options)
{
    std::error_code ignored;
    if (std::filesystem::equivalent(tree->folder(), output, ignored))
        throw Error(ErrorCode::invalid_argument, output, "the output is the input tree",
                    "give the new tree another name");
    std::unique_ptr<PointReader> points = std::make_unique<TreeReader>(tree, std::nullopt, Selection());
    for (const Affine& map : maps) points = std::make_unique<TransformedReader>(std::move(points), map);
    options.sampling = tree->info().sampling;
    return build_tree(*points, tree->info().sources, output, options);
}

std::vector<std::string> add_layer_of(MeshDocument& document, const std::filesystem::path& folder)
{
    const auto cloud = Registry::instance().open(folder);
    if (cloud->info().points == 0) return {"The tree has no points, so no layer shows it."};
    std::vector<std::string> lines;
    MeshModel* layer = document.addNewMesh(QString::fromStdString(folder.string()),
                                           QString::fromStdString(folder.filename().string()));
    try {
        for (const Misfit& misfit : misfits(*layer, cloud->info().metadata, cloud->info().bounds()))
            lines.push_back("Warning: " + folder.filename().string() + ": " + misfit.text);
        for (std::string& line : show_tree(*layer, cloud)) lines.push_back(std::move(line));
    } catch (...) {
        document.delMesh(layer);
        throw;
    }
    return lines;
}

}  // namespace pcm::host
