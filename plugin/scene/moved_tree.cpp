#include "plugin/scene/moved_tree.h"

#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"

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

}  // namespace pcm::host
