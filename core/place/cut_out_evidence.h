// Whether a shape's points are a cut-out of another surface, which the threshold cuts: a ring of a pipe that a sphere
// touches, a strip of it that a plane touches.
//
// The points of a cut-out end where the cloud's surface leaves the threshold next to them rather than above them (its
// overshoot), and their distances from the shape are those of the other surface: larger than the noise, or shared by
// neighbours. Points of a true shape end where the surface ends, or turns off; noise, clutter and walls are above
// points of it. If points are near a shape by chance, as many are next to it.
#pragma once

#include "pcm/shapes/shape.h"

#include <vector>

namespace pcm {

struct CutOutEvidence {
    // Points up to `around_thresholds` that continue the surface next to the points within the threshold, per point
    // within it.
    double overshoot = 0;
    // Share of the squared distances within the threshold that is left in means of 17 neighbours; 1/17 for noise.
    double bend = 0;
    // Expected number of chance points within the threshold, per point within it: from the median of the numbers of
    // points next to it, in bands of half a threshold on both sides. Another surface there is in some of the bands.
    double chance = 0;
    // Number of points in the fuller one of the two bands next to the threshold, relative to the fullest band: near 1
    // where another surface crosses the shape, near 0 where it runs along it, as the other face of a plate does.
    double crossing = 0;

    // `noise`: the fit's noise, in units of that of the surface near the place; 0: unknown.
    bool is_cut_out(double noise) const;
    bool is_by_chance() const;
    bool is_crossed() const;
};

// `points`: up to around_thresholds (grow_shape.h) * threshold from the shape, connected, about as dense everywhere;
// source coordinates. `threshold` > 0, source units. One thread; memory: some 150 bytes per point.
CutOutEvidence cut_out_evidence(const Shape& shape, double threshold, const std::vector<Vec3d>& points);

}  // namespace pcm
