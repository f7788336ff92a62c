// How many points of a selection a view shows, estimated from the nodes' boxes. No OpenGL here.
#pragma once

#include "pcm/view/level_of_detail.h"

namespace pcm {

// The points of the wanted nodes, each times the share of its node's box that is in the view and that clips leave,
// estimated from 4 x 4 x 4 places in it: exact for boxes that are wholly inside or outside. Stops counting at `enough`.
// Pure: the same arguments give the same result on any thread.
double seen_points(const std::vector<TreeInView>& trees, const SceneSelection& selection, double enough);

// select_scene() with a floor: where the point budget leaves fewer than `least_seen` points in the view although there
// are more, as it does when few points of coarse nodes are near the eye, it is doubled until they are reached, up to
// `most_points`. Sets limits.point_budget to what was used.
SceneSelection select_scene_seen(const std::vector<TreeInView>& trees, DetailLimits& limits, double least_seen,
                                 std::uint64_t most_points);

}  // namespace pcm
