#include "plugin/filter/operation_filter.h"

#include "pcm/system/error.h"
#include "pcm/system/tree_folder.h"
#include "plugin/filter/operation_parameters.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/result_layer.h"
#include "plugin/scene/text.h"

#include <utility>

namespace pcm::host {

namespace {

// The layers that show trees.
std::vector<ops::Layer> layers_of(const Scene& scene)
{
    std::vector<ops::Layer> layers;
    for (const SceneLayer* layer : scene.layers())
        if (const auto shown = layer->tree())
            layers.push_back({layer->label().toStdString(), shown->cloud->tree()->folder(), layer->placement(),
                              layer->is_visible(), layer == scene.current()});
    return layers;
}

std::string set_matrix(Scene& scene, const std::filesystem::path& tree, const Affine& motion, const std::string& step)
{
    SceneLayer* const layer = scene.current();
    const auto shown = layer ? layer->tree() : std::nullopt;
    if (!shown || !same_tree_folder(shown->cloud->tree()->folder(), tree))
        throw Error(ErrorCode::invalid_argument, tree, "the current layer does not show this tree",
                    "choose its layer, or write a new tree");
    scene.part<LayerMatrices>().set(*layer, matrix_of(motion, shown->origin), QString::fromStdString(step));
    return "the matrix of the layer '" + layer->label().toStdString() +
           "' moves it; rounded to single precision, it moves points by up to " +
           brief(matrix_rounding(motion, shown->origin, shown->cloud->info().bounds())) + " source units more or less";
}

void run_operation(const ops::Row& row, const OperationHooks& hooks, const FilterRun& run)
{
    const auto operation = row.make();
    set_arguments(operation->arguments(), run);
    Operation guard(run.callback);
    ops::Context context;
    context.face = ops::Face::dialog;
    context.progress = guard.progress();
    context.layers = [&] { return layers_of(run.scene); };
    context.set_matrix = [&](const std::filesystem::path& tree, const Affine& motion, const std::string& step) {
        return set_matrix(run.scene, tree, motion, step);
    };
    if (hooks.before) hooks.before(run, *operation, context.window);
    const ops::Result result = operation->run(context);
    for (const std::string& warning : result.outcome.warnings) run.warn(warning);
    for (const std::string& note : result.notes) run.log("Note: " + note);
    for (const std::string& line : ops::all_lines(result)) run.log(line);
    if (hooks.after)
        hooks.after(run, *operation, result);
    else
        show_made(run, result);
    if (run.answer) run.answer(ops::json_of(row.name, result));
}

}  // namespace

void show_afterwards(const FilterRun& run, const std::function<std::vector<std::string>()>& show)
{
    try {
        for (const std::string& line : show()) run.log(line);
    } catch (...) {
        run.warn("the tree was written, but its layer cannot be shown: " + current_error() +
                 " (do not apply the filter again; open the tree)");
    }
}

void show_made(const FilterRun& run, const ops::Result& result)
{
    if (result.makes == ops::Makes::nothing || result.makes == ops::Makes::file) return;
    const std::filesystem::path input = result.input.empty() ? std::string() : result.input.front();
    show_afterwards(run, [&] {
        return show_result(run.scene,
                           result.makes == ops::Makes::changed ? input : std::filesystem::path(result.output), input);
    });
}

Filter operation_filter(const ops::Row& row, OperationHooks hooks)
{
    return {row.title,
            QString::fromStdString(ops::description_of(row)) + " Esc cancels it.",
            row.menus,
            [&row](Parameters& parameters) {
                const auto operation = row.make();
                add_parameters(operation->arguments(), parameters);
            },
            [&row, hooks = std::move(hooks)](const FilterRun& run) { run_operation(row, hooks, run); },
            row.ending};
}

}  // namespace pcm::host
