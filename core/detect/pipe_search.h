// Thin pipes among the points of a sample: so thin, relative to the distance of points, that normals of points show
// nothing of them.
#pragma once

#include "pcm/detect/shape_growth.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

struct PipeSearchOptions {
    double threshold = 0;    // the largest of a pipe, source units
    double noise = 0;        // standard deviation of the points, source units
    std::size_t least = 20;  // points of the sample
    std::uint64_t seed = 1;
    std::function<void()> check;  // called now and then; may throw
};

// Cylinders with at least `least` connected points, none of them in two. `taken`: for each point, whether it belongs to
// something already; those that are found are added. One thread.
//
// Patches of points that edges connect and that are longer than wide give an axis, points across it a circle (Kasa's
// algebraic fit, 1976), least squares the cylinder, which grows along edges from point to point whatever the points'
// normals. Its threshold is at most what its sagitta allows (detect.search.sagitta_thresholds), and no less than the
// noise does. It must be longer than wide, seen from one side at least, and alone: few other free points are as near.
std::vector<FoundShape> search_pipes(const SurfaceSample& sample, const PipeSearchOptions& options,
                                     std::vector<std::uint8_t>& taken);

}  // namespace pcm
