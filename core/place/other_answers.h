// Other answers than the shape of most of the nearest points: where the place lies next to an edge, or on a pipe that
// is thin relative to the distances of points.
#pragma once

#include "pcm/cloud/clip.h"
#include "pcm/place/fit_at.h"
#include "pcm/place/local_fit.h"

#include <functional>
#include <optional>

namespace pcm {

// What follows a shape through the cloud, among the points on that side of its edges if one is given.
using FollowShape = std::function<FittedPrimitive(LocalFit local, const std::optional<Clip>& side)>;

// Keeps references. One object by one thread.
class OtherAnswers {
public:
    // `smooth_noise`: one standard deviation of points on smooth surfaces around, source units; 0: unknown.
    OtherAnswers(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options, double smooth_noise,
                 const FollowShape& follow)
        : cloud_(cloud), place_(place), options_(options), smooth_noise_(smooth_noise), follow_(follow)
    {
    }

    // Where the shape of the nearest points is not good, or has more than twice the noise, the thin pipe at the place
    // (thin_pipe.h). Where no shape of the nearest points is good, or neighbours leave it together as those of two
    // faces do, that of the plate's face which has the place (face_at_place.h). Next to an edge, the plane that has the
    // place (corner_at_place.h). A plane that is good all the same is doubtful where the place may belong to the face
    // next to it. Throws what the fits throw.
    FittedPrimitive best(FittedPrimitive found) const { return or_corner(or_face(or_thin_pipe(std::move(found)))); }

private:
    FittedPrimitive or_thin_pipe(FittedPrimitive found) const;
    FittedPrimitive or_face(FittedPrimitive found) const;
    FittedPrimitive or_corner(FittedPrimitive found) const;
    bool is_plane(const Primitive& found, const Shape& plane) const;

    const PointCloud& cloud_;
    const Vec3d place_;
    const LocalFitOptions options_;
    const double smooth_noise_;
    const FollowShape& follow_;
};

}  // namespace pcm
