// The steps in which a depth camera measures. Along its view, the coordinates of a cloud in the camera's own axes take
// few values, the farther away the fewer, so that a wall is a heap of flat patches which lie a step apart. That relief
// is not the wall's, and is not shaded (shaders/composite.frag). No OpenGL here.
//
// It is found when points are loaded, in each level of a node by itself. Coordinates along an axis are steps when
//   - they have at least three values, and at most an eighth as many as there are points;
//   - of the gaps between neighbouring values three quarters are regular, which is as large as the one before or after,
//     to within a fifth: heights of floors, tables and roofs are not;
//   - the steps are at least one and a half times as large as the points are apart: the cells of a grid are not;
//   - of the points that are neighbours across the axis at least one in 25 lies on another step than the one before:
//   the
//     treads of stairs are not mixed like that, the patches of a wall are.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/geometry.h"

#include <cstdint>
#include <vector>

namespace pcm {

// The step at each point, source units: the largest of the regular gaps around its coordinates, 0 where there are no
// steps. Empty where there are none at all. `level_points`: how many of the points, in order, each level has.
std::vector<float> find_depth_steps(const ChunkPositions& positions, const Vec3d& scale,
                                    const std::vector<std::uint32_t>& level_points);

}  // namespace pcm
