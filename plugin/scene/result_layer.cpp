#include "plugin/scene/result_layer.h"

#include "pcm/system/tree_folder.h"
#include "plugin/scene/layer_visibility.h"
#include "plugin/scene/scene_state.h"

#include <utility>

namespace pcm::host {

namespace {

bool shows(const SceneLayer& layer, const std::filesystem::path& folder)
{
    const auto tree = layer.tree();
    return tree && same_tree_folder(tree->cloud->tree()->folder(), folder);
}

void hide(SceneLayer& layer)
{
    SoloLayers& solo = layer.scene().part<SoloLayers>();
    if (solo.is_solo(layer)) solo.set(layer, false);
    layer.show(false);
}

}  // namespace

std::vector<std::string> add_layer_of(Scene& scene, const std::filesystem::path& folder, const SceneLayer* like)
{
    std::vector<std::string> lines;
    scene.add_tree(folder, like, lines);
    return lines;
}

SceneLayer* layer_showing(Scene& scene, const std::filesystem::path& folder)
{
    SceneLayer* found = nullptr;
    for (SceneLayer* layer : scene.layers()) {
        if (!shows(*layer, folder)) continue;
        if (layer == scene.current()) return layer;
        if (!found || (layer->is_visible() && !found->is_visible())) found = layer;
    }
    return found;
}

std::vector<std::string> show_result(Scene& scene, const TreeResult& result)
{
    std::vector<std::string> lines;
    const bool has_place = result.same_place && !result.replaced.empty();
    SceneLayer* const added = scene.add_tree(result.folder, has_place ? result.replaced.front() : nullptr, lines);
    if (!added) return lines;
    for (SceneLayer* layer : result.replaced) {
        SoloLayers& solo = scene.part<SoloLayers>();
        if (solo.is_solo(*layer)) solo.set(*added, true);
        SceneState& state = scene.part<SceneState>();
        if (state.selection(*layer)) state.select(*layer, nullptr, "cleared: " + added->label() + " was made");
        if (layer->is_visible())
            lines.push_back("The layer " + layer->label().toStdString() + " is hidden; " +
                            added->label().toStdString() + " is shown in its place.");
        hide(*layer);
    }
    return lines;
}

std::vector<std::string> show_result(Scene& scene, const std::filesystem::path& folder,
                                     const std::filesystem::path& made_of)
{
    std::error_code ignored;
    if (std::filesystem::equivalent(folder, made_of, ignored)) return scene.reload(folder);
    SceneLayer* const former = layer_showing(scene, made_of);
    return show_result(
        scene, TreeResult{folder, former ? std::vector<SceneLayer*>{former} : std::vector<SceneLayer*>(), true});
}

}  // namespace pcm::host
