#include "plugin/tools/measure/look_at.h"

#include "plugin/scene/look_at.h"

#include <algorithm>

namespace pcm::host {

namespace {

constexpr double filled = 0.35;         // share of the view
constexpr double least_spacings = 100;  // the radius of a single point's surroundings

}  // namespace

void look_at(SceneView& view, const std::vector<MeasuredPoint>& points)
{
    Box3d box;
    double spacing = 0;
    for (const MeasuredPoint& point : points) {
        box.extend(point.position);
        spacing = std::max(spacing, point.spacing);
    }
    look_at(view, box, filled, least_spacings * spacing);
}

}  // namespace pcm::host
