// Other answers than the shape of most of the nearest points, where the place lies next to an edge.
#pragma once

#include "pcm/cloud/clip.h"
#include "pcm/place/fit_at.h"
#include "pcm/place/local_fit.h"

#include <functional>
#include <optional>

namespace pcm {

// What follows a shape through the cloud, among the points on that side of its edges if one is given.
using FollowFace = std::function<FittedPrimitive(LocalFit face, const std::optional<Clip>& side)>;

// Keeps references. One object by one thread.
class EdgeAnswers {
public:
    EdgeAnswers(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options, const FollowFace& follow)
        : cloud_(cloud), place_(place), options_(options), follow_(follow)
    {
    }

    // Where no shape of the nearest points is good, or neighbours leave it together as those of two faces do, that of
    // the plate's face which has the place (face_at_place.h). Next to an edge, the plane that has the place
    // (corner_at_place.h). A plane that is good all the same is doubtful where the place may belong to the face next to
    // it. Throws what the fits throw.
    FittedPrimitive best(FittedPrimitive found) const { return or_corner(or_face(std::move(found))); }

private:
    FittedPrimitive or_face(FittedPrimitive found) const;
    FittedPrimitive or_corner(FittedPrimitive found) const;
    bool is_plane(const Primitive& found, const Shape& plane) const;

    const PointCloud& cloud_;
    const Vec3d place_;
    const LocalFitOptions options_;
    const FollowFace& follow_;
};

}  // namespace pcm
