#include "plugin/scene/scene_state.h"

#include "pcm/cloud/vector.h"
#include "plugin/scene/annotations.h"

#include <utility>

namespace pcm::host {

// The planes of the box, pulled back: n . (L (p - pivot) + target - centre) + h = (L^T n) . (p - pivot) + n . (target -
// centre) + h.
Clip ClipBox::clip(const std::optional<Affine>& placement) const
{
    if (!placement) return {Region::oriented_box(centre, axes, half), outside};
    std::vector<Region::Plane> planes;
    for (std::size_t k = 0; k < 3; ++k)
        for (const double sign : {1.0, -1.0}) {
            const Vec3d n = sign * axes[k];
            Region::Plane plane;
            for (std::size_t row = 0; row < 3; ++row) plane.normal = plane.normal + n[row] * placement->linear[row];
            plane.offset = dot(n, placement->target - centre) + half[k];
            planes.push_back(plane);
        }
    return {Region::convex(placement->pivot, planes), outside};
}

std::optional<Clip> clip_of(const SceneLayer& layer)
{
    const auto& clip = layer.scene().part<SceneState>().clip();
    const auto tree = layer.drawn();
    if (!clip || !clip->enabled || !tree) return std::nullopt;
    return clip->clip(layer.placement());
}

SceneState::SceneState(Scene& scene) : QObject(&scene), scene_(scene)
{
    connect(&scene, &Scene::layer_removed, this, [this](int layer_id) { selections_.erase(layer_id); });
}

void SceneState::set_clip(std::optional<ClipBox> clip)
{
    clip_ = std::move(clip);
    scene_.repaint();
    emit clip_changed();
}

std::shared_ptr<const PointSet> SceneState::selection(const SceneLayer& layer) const
{
    const auto found = selections_.find(layer.id());
    if (found == selections_.end() || found->second.done == 0) return nullptr;
    const auto& points = found->second.steps[found->second.done - 1].points;
    const auto tree = layer.drawn();
    if (!points || points->empty() || !tree || !points->belongs_to(*tree->cloud->tree())) return nullptr;
    return points;
}

void SceneState::select(const SceneLayer& layer, std::shared_ptr<const PointSet> points, const QString& words)
{
    History& history = selections_[layer.id()];
    history.steps.resize(history.done);
    history.steps.push_back({std::move(points), words});
    history.done = history.steps.size();
    changed(layer);
}

QString SceneState::undo_words(const SceneLayer& layer) const
{
    const auto found = selections_.find(layer.id());
    return found == selections_.end() || found->second.done == 0 ? QString()
                                                                 : found->second.steps[found->second.done - 1].words;
}

QString SceneState::redo_words(const SceneLayer& layer) const
{
    const auto found = selections_.find(layer.id());
    return found == selections_.end() || found->second.done == found->second.steps.size()
               ? QString()
               : found->second.steps[found->second.done].words;
}

void SceneState::undo(const SceneLayer& layer)
{
    if (undo_words(layer).isNull()) return;
    --selections_[layer.id()].done;
    changed(layer);
}

void SceneState::redo(const SceneLayer& layer)
{
    if (redo_words(layer).isNull()) return;
    ++selections_[layer.id()].done;
    changed(layer);
}

void SceneState::changed(const SceneLayer& layer)
{
    scene_.repaint();
    emit selection_changed(layer.id());
}

}  // namespace pcm::host
