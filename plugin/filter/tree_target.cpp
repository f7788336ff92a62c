#include "plugin/filter/tree_target.h"

#include "pcm/system/error.h"
#include "plugin/filter/parameters.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/layer.h"
#include "plugin/scene/result_layer.h"
#include "plugin/scene/text.h"

#include <utility>

namespace pcm::host {

void add_tree_layer(const FilterRun& run, const std::filesystem::path& folder, const SceneLayer* like)
{
    for (const std::string& line : add_layer_of(scene_of(run.document), folder, like)) run.log(line);
}

void show_afterwards(const FilterRun& run, const std::function<void()>& show)
{
    try {
        show();
    } catch (...) {
        run.warn("the tree was written, but its layer cannot be shown: " + current_error() +
                 " (do not apply the filter again; open the tree)");
    }
}

void show_result(const FilterRun& run, const std::filesystem::path& made_of, const TargetChoice& target)
{
    show_afterwards(run, [&] {
        const std::filesystem::path& folder = target.in_place ? made_of : target.copy;
        for (const std::string& line : host::show_result(scene_of(run.document), folder, made_of)) run.log(line);
    });
}

void show_moved_result(const FilterRun& run, const std::filesystem::path& folder, std::vector<SceneLayer*> replaced)
{
    show_afterwards(run, [&] {
        for (const std::string& line :
             host::show_result(scene_of(run.document), TreeResult{folder, std::move(replaced), false}))
            run.log(line);
    });
}

}  // namespace pcm::host
