// Gives each point of a cloud to the surface that it lies on.
#pragma once

#include "pcm/detect/hypotheses.h"
#include "pcm/detect/point_labels.h"
#include "pcm/detect/surface_sample.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace pcm {

// Connected points of one surface.
struct SurfacePart {
    std::uint32_t hypothesis = 0;
    std::uint64_t points = 0;
    std::uint64_t sampled = 0;    // number of the sample's points in it
    std::uint64_t edge = 0;       // number of these with a neighbour outside of the part
    std::uint64_t continued = 0;  // number of these next to which the surface continues smoothly, but not on the shape
    // Number of these next to which most points within the threshold belong to no surface: in trees nearly all.
    std::uint64_t mixed = 0;
    // Sums over the sample's other points, inside: of squared distances from the shape, and of squared means of the
    // distances of a point and its neighbours, which are what noise leaves over.
    double squares = 0, smooth_squares = 0;
    Box3d box;
    std::vector<Vec3d> some;  // points of the sample, see AssignOptions::some_from; source coordinates
};

// Whether the part is a piece of a surface that bends away from the shape: its edge is often where the surface
// continues, and its distances from the shape fill the threshold, as those of their neighbours do.
bool is_piece(const SurfacePart& part, double threshold);

struct AssignOptions {
    SampleSettings sample;
    double normal_angle = 0, reach = 0;  // reach: how far beyond a hypothesis' box its points may lie
    std::uint64_t least_points = 0;      // parts with fewer are of no interest
    std::uint64_t least_sampled = 0;     // nor those with fewer of the sample's points
    // Up to 256 points of each unit's parts are kept, of hypotheses from this one on; by default of none.
    std::uint32_t some_from = 0xffffffffu;
    std::size_t most_some = 4096;  // maximum number of points that a part of several units keeps
    unsigned threads = 1;
    std::function<void(double)> progress;  // 0 to 1; may throw
};

// Where the points are that an assignment looks at for one hypothesis: its own, those next to them that show whether
// the surface continues, and all neighbours of both. With such places in sample.only the hypothesis' parts stay the
// same.
Vicinity vicinity_of(const Hypothesis& one, const AssignOptions& options);

inline constexpr std::uint32_t interior_label = 0x80000000u;  // set where all neighbours have the same label

struct AssignedPoints {
    std::vector<SurfacePart> parts;
    // Labels less 1, ascending, and which of the parts their points have: of parts of interest only.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> numbers;
    std::uint32_t next_number = 0;  // all labels less 1 are below
    std::uint64_t looked_at = 0;    // points; only with labels
    static constexpr std::uint32_t no_part = 0xffffffffu;
    // The place in `parts` of a label above 0, the bit interior_label taken off, or no_part.
    std::uint32_t part_of(std::uint32_t label) const;
};

// A point belongs to the nearest of the surfaces within whose threshold it is and whose normal agrees, in units of
// their thresholds. Parts are connected by the edges of the samples of the units. The parts do not depend on threads,
// the labels do; `labels` may be null. Memory: a sample per thread, and per part of interest or at the border of a unit
// 32 bytes, per part of interest of all units some 150 more, up to 24 bytes for each of most_some with some_from; the
// rest lies in scratch files. Throws what reading and `labels` throw, what options.progress throws, soon, and
// Error(unsupported) where there are more than 2^31 parts.
AssignedPoints assign_points(const ChosenPoints& points, const std::vector<Box3i>& units,
                             const std::vector<Hypothesis>& hypotheses, const AssignOptions& options,
                             PointLabels* labels);

}  // namespace pcm
