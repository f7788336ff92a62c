// From the shape of a neighbourhood to one that was followed through the whole cloud, and judged.
#pragma once

#include "pcm/place/fit_at.h"
#include "pcm/place/local_fit.h"
#include "pcm/place/stations_around.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Whether the noise of a neighbourhood is that of its nearest points (even), it is the narrower neighbourhood for which
// that holds (narrow), or there is such a narrower one (uneven). Then the noise of the surface, if it is one, differs
// from place to place, and growth may raise the threshold.
enum class NoiseNear { even, narrow, uneven };

// What the verdict on a shape says beyond it (FollowedVerdict).
struct FollowedFacts {
    double agreement = 1;  // GrownShape::agreement
    std::optional<Vec3d> place_on_bend;
    std::vector<std::uint32_t> stations_at_place;
};

struct FollowedLocal {
    FittedPrimitive found;
    std::optional<ShapeFit> other_kind;  // FollowedVerdict::other_kind(), with other_doubt()
    std::string other_doubt;
    bool cuts_noise = false;             // whether the threshold cut the noise of the points reached
    std::optional<FollowedFacts> facts;  // where growth did not leave the surface
};

// Keeps references. One object by one thread.
class LocalFollower {
public:
    // `limit`: which points are looked at; may change between two calls.
    LocalFollower(const PointCloud& cloud, const std::vector<Vec3d>& places, const FitAtOptions& options,
                  const Selection& limit, StationsAround& around);

    // The shape of a neighbourhood and its points there.
    FittedPrimitive at_places(LocalFit local) const;
    // The same shape, followed where options.grow asks for it. Throws what grow_shape() throws.
    FollowedLocal follow(LocalFit local, NoiseNear noise, const ProgressFunction& progress) const;
    // The angle of TurnedSurface that is used, radians.
    double turned_angle(NoiseNear noise) const;

private:
    const PointCloud& cloud_;
    const std::shared_ptr<const Tree> tree_;
    const std::vector<Vec3d>& places_;
    const FitAtOptions& options_;
    const Selection& limit_;
    StationsAround& around_;
};

}  // namespace pcm
