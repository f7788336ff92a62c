// Points on the bend of a tube between two straight ends.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/piping/pipe_joints.h"

#include <cstddef>
#include <vector>

namespace pcm {

// Arc of a tube that touches two lines from `at`.
struct BendFrame {
    Vec3d at{}, inwards{}, axis{};
    double turn = 0;  // radians
};
BendFrame frame_of(const TubeEnd& a, const TubeEnd& b, const piping::AxesMeeting& meeting);

// Points near a corner, and which of them are on the middle half of an arc that touches both lines `tangent` away from
// it. All such arcs have one plane and one line of symmetry.
class BendPoints {
public:
    // `points`: source coordinates; `tube`: radius across the centre line, `threshold`: largest distance, source units.
    BendPoints(const BendFrame& frame, const std::vector<Vec3d>& points, double tube, double threshold);

    std::size_t count(double tangent) const;
    std::vector<Vec3d> on_arc(double tangent) const;

private:
    struct Placed {
        Vec3d position{};
        double outwards = 0, across = 0, height = 0;  // from the corner
    };
    bool is_on(const Placed& p, double bend) const;

    double half_, secant_, least_cosine_, tube_, threshold_;
    std::vector<Placed> points_;
};

}  // namespace pcm
