#include "plugin/scene/scene_bounds.h"

#include "plugin/scene/scene_view.h"

namespace pcm::host {

namespace {

Box3d moved(const Box3d& box, const SceneLayer& layer)
{
    const auto tree = layer.drawn();
    const auto placement = tree ? layer.placement() : std::nullopt;
    if (!placement || box.empty()) return box;
    Box3d result;
    for (int corner = 0; corner < 8; ++corner)
        result.extend(
            (*placement)({(corner & 1) != 0 ? box.max[0] : box.min[0], (corner & 2) != 0 ? box.max[1] : box.min[1],
                          (corner & 4) != 0 ? box.max[2] : box.min[2]}));
    return result;
}

}  // namespace

Box3d bounds_of(const SceneLayer& layer)
{
    const auto tree = layer.drawn();
    return tree ? moved(tree->cloud->info().bounds(), layer) : Box3d();
}

Box3d bounds_of_shown(SceneView& view)
{
    Box3d bounds;
    for (const SceneLayer* layer : view.scene().layers())
        if (view.is_shown(*layer)) bounds.extend(bounds_of(*layer));
    return bounds;
}

Box3d bounds_in_picture(SceneView& view)
{
    Box3d bounds;
    for (const SceneLayer* layer : view.scene().layers()) {
        if (!view.is_shown(*layer) || !layer->drawn()) continue;
        if (const auto seen = view.seen_box(*layer)) bounds.extend(moved(*seen, *layer));
    }
    return bounds;
}

double grid_step_of_shown(const SceneView& view)
{
    double step = 0;
    for (const SceneLayer* layer : view.scene().layers()) {
        const auto tree = view.is_shown(*layer) ? layer->drawn() : std::nullopt;
        if (!tree) continue;
        for (const double scale : tree->cloud->info().grid.scale)
            if (scale > 0 && (step == 0 || scale < step)) step = scale;
    }
    return step;
}

}  // namespace pcm::host
