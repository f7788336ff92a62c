// Shapes among the points of a sample in memory.
#pragma once

#include "pcm/detect/shape_growth.h"
#include "pcm/shapes/shape.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

struct ShapeSearchOptions {
    std::vector<ShapeKind> kinds;
    double threshold = 0;          // source units
    double normal_angle = 0;       // radians
    bool pipes_of_strips = false;  // whether cylinders along narrow planes are tried, whatever `kinds` says
    double least_sagitta = 0;      // minimum sagitta of curved shapes, source units (sagitta.h)
    std::size_t least = 20;        // points of the sample
    std::uint64_t seed = 1;
    std::function<void()> check;  // called now and then; may throw
};

// Shapes that have at least `least` connected points, none of them in two shapes. `taken`: for each point, whether it
// belongs to something already; those that are found are added. One thread.
//
// From points of which the surroundings are smooth, in an order that the seed decides: a paraboloid is fitted to
// patches of growing size, the shapes that curve as it does are grown along edges from point to point, fitted again
// each time that they have twice the points, and the one with the maximum of points is taken; a curved one only if the
// plane has fewer by detect.search.curved_gain. Where that is a plane longer than wide that bends across, the cylinder
// along it is tried, too: patches as wide as a pipe of few spacings do not show its curvature.
std::vector<FoundShape> search_shapes(const SurfaceSample& sample, const ShapeSearchOptions& options,
                                      std::vector<std::uint8_t>& taken);

}  // namespace pcm
