#include "plugin/host/scene_state.h"

#include "pcm/cloud/vector.h"
#include "plugin/host/annotations.h"
#include "plugin/host/placement.h"

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

std::optional<Clip> clip_of(const MeshModel& layer)
{
    const auto& clip = SceneState::of(*layer.parent).clip();
    const auto tree = Registry::instance().drawn(layer);
    if (!clip || !clip->enabled || !tree) return std::nullopt;
    return clip->clip(placement_of(layer, *tree));
}

SceneState::SceneState(MeshDocument& document) : QObject(&document), document_(document)
{
    connect(&document, &MeshDocument::meshRemoved, this, [this](int mesh_id) { selections_.erase(mesh_id); });
}

SceneState& SceneState::of(MeshDocument& document)
{
    auto* found = document.findChild<SceneState*>(QString(), Qt::FindDirectChildrenOnly);
    return found ? *found : *new SceneState(document);
}

void SceneState::set_clip(std::optional<ClipBox> clip)
{
    clip_ = std::move(clip);
    repaint_views(document_);
    emit clip_changed();
}

std::shared_ptr<const PointSet> SceneState::selection(const MeshModel& layer) const
{
    const auto found = selections_.find(layer.id());
    if (found == selections_.end() || found->second.done == 0) return nullptr;
    const auto& points = found->second.steps[found->second.done - 1].points;
    const auto tree = Registry::instance().drawn(layer);
    if (!points || points->empty() || !tree || !points->belongs_to(*tree->cloud->tree())) return nullptr;
    return points;
}

void SceneState::select(const MeshModel& layer, std::shared_ptr<const PointSet> points, const QString& words)
{
    History& history = selections_[layer.id()];
    history.steps.resize(history.done);
    history.steps.push_back({std::move(points), words});
    history.done = history.steps.size();
    changed(layer);
}

QString SceneState::undo_words(const MeshModel& layer) const
{
    const auto found = selections_.find(layer.id());
    return found == selections_.end() || found->second.done == 0 ? QString()
                                                                 : found->second.steps[found->second.done - 1].words;
}

QString SceneState::redo_words(const MeshModel& layer) const
{
    const auto found = selections_.find(layer.id());
    return found == selections_.end() || found->second.done == found->second.steps.size()
               ? QString()
               : found->second.steps[found->second.done].words;
}

void SceneState::undo(const MeshModel& layer)
{
    if (undo_words(layer).isNull()) return;
    --selections_[layer.id()].done;
    changed(layer);
}

void SceneState::redo(const MeshModel& layer)
{
    if (redo_words(layer).isNull()) return;
    ++selections_[layer.id()].done;
    changed(layer);
}

void SceneState::changed(const MeshModel& layer)
{
    repaint_views(document_);
    emit selection_changed(layer.id());
}

}  // namespace pcm::host
