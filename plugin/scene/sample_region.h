// The part of space that a user means by deleting some vertices of a sample.
#pragma once

#include "pcm/cloud/matrix.h"
#include "pcm/cloud/region.h"
#include "plugin/scene/proxy.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

struct SampleRegion {
    Region region;      // source coordinates
    std::string words;  // for a question: "the box ... to ...", "a rectangle of this view, at any depth"
};

// A region with all vertices of `chosen` (indices, ascending) and no other vertex of the sample: a box along the axes;
// else what a rectangle or a convex polygon of the view covers. Between the chosen vertices and the others its faces
// lie halfway, but no further from the chosen ones than the sample's spacing and the rounding of its floats. None if
// there is no such region. `view` maps the sample's positions to clip coordinates (column-major; absent: there is no
// view); `aspect` is width / height.
std::optional<SampleRegion> region_of(const Proxy& sample, const std::vector<std::uint32_t>& chosen,
                                      const Vec3d& origin, const std::optional<Matrix4d>& view, double aspect);

}  // namespace pcm::host
