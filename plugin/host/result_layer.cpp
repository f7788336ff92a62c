#include "plugin/host/result_layer.h"

#include "plugin/host/annotations.h"
#include "plugin/host/layer.h"
#include "plugin/host/layer_visibility.h"
#include "plugin/host/misfit.h"
#include "plugin/host/scene_state.h"

#include <utility>

namespace pcm::host {

namespace {

bool shows(const MeshModel& layer, const std::filesystem::path& folder)
{
    const auto tree = Registry::instance().find(layer);
    std::error_code ignored;
    return tree && std::filesystem::equivalent(tree->cloud->tree()->folder(), folder, ignored);
}

// The new layer; null where the tree has no points.
MeshModel* add_layer(MeshDocument& document, const std::filesystem::path& folder, const MeshModel* like,
                     std::vector<std::string>& lines)
{
    const auto cloud = Registry::instance().open(folder);
    if (cloud->info().points == 0) {
        lines.push_back(folder.string() + " has no points, so no layer shows it.");
        return nullptr;
    }
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
    if (like) layer->cm.Tr = like->cm.Tr;
    repaint_views(document);
    return layer;
}

void hide(MeshModel& layer)
{
    SoloLayers& solo = SoloLayers::of(*layer.parent);
    if (solo.is_solo(layer)) solo.set(layer, false);
    show_layer(layer, false);
}

}  // namespace

std::vector<std::string> add_layer_of(MeshDocument& document, const std::filesystem::path& folder,
                                      const MeshModel* like)
{
    std::vector<std::string> lines;
    add_layer(document, folder, like, lines);
    return lines;
}

MeshModel* layer_showing(MeshDocument& document, const std::filesystem::path& folder)
{
    MeshModel* found = nullptr;
    for (MeshModel* layer : document.meshList) {
        if (!layer || !shows(*layer, folder)) continue;
        if (layer == document.mm()) return layer;
        if (!found || (layer->visible && !found->visible)) found = layer;
    }
    return found;
}

std::vector<std::string> show_result(MeshDocument& document, const TreeResult& result)
{
    std::vector<std::string> lines;
    const bool has_place = result.same_place && !result.replaced.empty();
    MeshModel* const added = add_layer(document, result.folder, has_place ? result.replaced.front() : nullptr, lines);
    if (!added) return lines;
    for (MeshModel* layer : result.replaced) {
        SoloLayers& solo = SoloLayers::of(document);
        if (solo.is_solo(*layer)) solo.set(*added, true);
        SceneState& scene = SceneState::of(document);
        if (scene.selection(*layer)) scene.select(*layer, nullptr, "cleared: " + added->label() + " was made");
        if (layer->visible)
            lines.push_back("The layer " + layer->label().toStdString() + " is hidden; " +
                            added->label().toStdString() + " is shown in its place.");
        hide(*layer);
    }
    return lines;
}

std::vector<std::string> show_result(MeshDocument& document, const std::filesystem::path& folder,
                                     const std::filesystem::path& made_of)
{
    std::error_code ignored;
    if (std::filesystem::equivalent(folder, made_of, ignored)) return reload_layers(document, folder);
    MeshModel* const former = layer_showing(document, made_of);
    return show_result(document,
                       TreeResult{folder, former ? std::vector<MeshModel*>{former} : std::vector<MeshModel*>(), true});
}

}  // namespace pcm::host
