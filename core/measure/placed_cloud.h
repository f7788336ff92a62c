// A cloud that is measured where an affine map puts it: in plan and along the vertical of that place.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/point_cloud.h"

#include <optional>

namespace pcm {

// Keeps a reference to the cloud. Immutable; as many threads as the cloud takes.
class PlacedCloud {
public:
    // Without a map the cloud is where its source coordinates say. The map may turn, mirror, scale and stretch. Throws
    // Error(invalid_argument) for one that is not finite, and for one that flattens space.
    PlacedCloud(PointCloud& cloud, const std::optional<Affine>& map);

    PointCloud& cloud() const { return cloud_; }
    bool moved() const { return map_.has_value(); }
    Vec3d position(const PointView& view, std::size_t i) const
    {
        return map_ ? (*map_)(view.position(i)) : view.position(i);
    }
    // Contains all points; of a moved cloud, the box around its moved box. Empty for a cloud without points.
    Box3d bounds() const;
    // What the map makes of a length, at most.
    double most_stretch() const { return most_stretch_; }
    // A region of the cloud's own coordinates that contains all points whose positions are in `region`, and perhaps
    // some that rounding leaves outside of it. `region` is a box, an oriented box or convex.
    Region own_region(const Region& region) const;

private:
    Vec3d back(const Vec3d& p) const;

    PointCloud& cloud_;
    std::optional<Affine> map_;
    std::array<Vec3d, 3> inverse_{};  // rows of the inverse of the map's linear part
    double most_stretch_ = 1;
};

}  // namespace pcm
