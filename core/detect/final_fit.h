// Primitives out of the parts that points were assigned to.
#pragma once

#include "pcm/detect/assign_points.h"
#include "pcm/detect/station_shifts.h"
#include "pcm/shapes/primitive.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

struct FinalFitOptions {
    std::uint64_t least_points = 0;
    bool keep_pieces = false;  // as doubtful ones
    // Whether the thresholds come from the cloud's noise, source units: then primitives are doubted whose points are
    // not those of one surface of that shape.
    bool is_automatic = false;
    double noise = 0;
    // Points are taken to be where their stations most probably were when shapes are doubted.
    StationShifts shifts;
    bool only_good = false;  // doubtful ones are left out, but for thin pipes
    double cell = 0;         // cell of the sample that the parts come from, source units
    unsigned threads = 1;
    std::function<void(double)> progress;  // 0 to 1; may throw
};

struct FinalFit {
    std::vector<Primitive> primitives;  // most points first
    // One for each primitive: whether it is a narrow plane that may be several surfaces within one threshold, pipes
    // side by side or a step: it has more noise than the cloud, or points at both ends of the threshold.
    std::vector<bool> contested;
    std::vector<double> agreement;  // see DetectReport
    // Parts that were left out, or would have been: pieces of surfaces that bend away from the shape (ground, say), cut
    // out by the threshold.
    std::uint64_t pieces = 0, piece_points = 0;
    // Doubtful primitives that were left out because another kind explains their points better: pieces of cones, say.
    std::uint64_t other_kinds = 0, other_points = 0;
    std::uint64_t unbounded = 0;  // primitives without bounds, because their points are on one line
};

// Fits each part of at least least_points points to all of them, and makes `labels` those of the primitives: place in
// the list + 1, or 0. Does not depend on threads. Throws what reading and `labels` throw.
FinalFit fit_parts(const ChosenPoints& points, const std::vector<Hypothesis>& hypotheses,
                   const AssignedPoints& assigned, PointLabels& labels, const FinalFitOptions& options);

}  // namespace pcm
