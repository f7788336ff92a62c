// Cylinders that are pieces of elbows: as far as the threshold hides its bend, an elbow is a cylinder, and a wide one
// is several.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/point_cloud.h"
#include "pcm/shapes/primitive.h"

#include <cstddef>
#include <map>
#include <vector>

namespace pcm {

// Keeps references. One object by one thread.
class ElbowPieces {
public:
    // `primitives`: planes, cylinders, spheres in any order; their ends may be changed.
    ElbowPieces(const PointCloud& cloud, const std::vector<Primitive>& primitives, const Selection& limit)
        : cloud_(cloud), primitives_(primitives), limit_(limit)
    {
    }

    // Whether it is a cylinder as short as pieces of elbows are; `index` in the list.
    bool may_be(std::size_t index) const;
    // Whether it is one: its points are nearer to the torus than to itself. The first call for each cylinder reads
    // them.
    bool is_of(std::size_t index, const Primitive& torus);

private:
    const std::vector<Vec3d>& points_of(std::size_t index);

    const PointCloud& cloud_;
    const std::vector<Primitive>& primitives_;
    const Selection& limit_;
    std::map<std::size_t, std::vector<Vec3d>> points_;  // keyed by index
};

}  // namespace pcm
