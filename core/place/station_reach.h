// How far a station of a scanner sees, for how much it is turned.
//
// A registration by n points with errors of e along each axis leaves a station shifted by about e / sqrt(n), and turned
// by e / (sqrt(n) r) where r is their distance from the axis. The turn is the shift divided by r. Targets and overlaps
// are known to nobody afterwards; they lie at the ends of what a station sees. Points that fill a box are 1 / sqrt(3)
// of its half diagonal from their middle (root mean square).
#pragma once

#include "pcm/cloud/vector.h"

#include <cstdint>
#include <map>

namespace pcm {

// One object by one thread.
class StationReach {
public:
    // `origin`: a place near the points, source coordinates.
    explicit StationReach(const Vec3d& origin) : origin_(origin) {}

    void add(const Vec3d& p, std::uint32_t station);  // p: source coordinates
    // sqrt(3) times how far the points are from the middle of those of their station, root mean square, source units; 0
    // without points.
    double reach() const;

private:
    struct Seen {
        double points = 0, squares = 0;  // squares of the distances from the origin
        Vec3d sum{};
    };
    const Vec3d origin_;
    std::map<std::uint32_t, Seen> seen_;
};

}  // namespace pcm
