#include "plugin/filter/tree_target.h"

#include "pcm/system/error.h"
#include "plugin/filter/parameters.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/layer.h"
#include "plugin/scene/result_layer.h"
#include "plugin/scene/text.h"

#include <utility>

namespace pcm::host {

void add_target_parameters(RichParameterList& parameters)
{
    parameters.addParam(RichString(
        "Output", "", "Output folder",
        "The tree folder to write, NAME.pct. It shares unchanged data with the original tree, so it takes "
        "little time and space. Ignored when 'In place' is on. A dialog proposes a name; scripts have no default."));
    parameters.addParam(RichBool("InPlace", false, "In place",
                                 "Change the tree itself. The change is atomic: until it is complete, the old tree is "
                                 "on disk. Default off."));
}

TargetChoice target_of(const RichParameterList& parameters)
{
    if (parameters.getBool("InPlace")) return {{}, true};
    const QString output = parameters.getString("Output");
    if (output.trimmed().isEmpty())
        throw Error(ErrorCode::invalid_argument, {}, "no output is given",
                    "name the tree to write as Output folder, or switch on 'In place'");
    return {as_tree(absolute_path(output)), false};
}

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
