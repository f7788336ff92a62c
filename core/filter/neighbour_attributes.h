// Attributes of points that are computed from their nearest neighbours, in one pass over all neighbourhoods: radii,
// normals, curvature, a normal's confidence, mean distances.
//
//     UpdateTarget target(tree, choice);  // a copy, or the tree itself
//     target.update([&](const auto& folder) { return compute_neighbour_attributes(folder, options); });
//
// What is written, by name:
//     radius             f32      source units
//     normal             f32 x 3  unit length; (0, 0, 0) where it is undefined, which splats draw facing the eye
//     curvature          f32      0 to 1/3
//     normal_confidence  u8       NormalConfidence
//     mean_distance      f32      source units
// An attribute of that name and type is overwritten. Values are never NaN: point_values.h says what a point without
// enough neighbours gets.
#pragma once

#include "pcm/filter/filter_report.h"
#include "pcm/filter/normal_orientation.h"
#include "pcm/filter/point_values.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/system/progress.h"

#include <cstdint>
#include <filesystem>
#include <limits>

namespace pcm {

// What radii of discs are computed with by default: WantedValues::radius_neighbours, and
// NeighbourAttributeOptions::radius_limit.
inline constexpr std::uint32_t usual_radius_neighbours = 6;
inline constexpr double usual_radius_limit = 2.5;

struct NeighbourAttributeOptions {
    // At least one of them. When radii are wanted without normals and the tree has an attribute "normal" with 3
    // components, radii are measured across those.
    WantedValues wanted;
    std::size_t neighbours = 16;                                    // k, 1 to most_neighbours
    double max_distance = std::numeric_limits<double>::infinity();  // distance of a neighbour, source units; positive
    // A radius is at most this many times the size that its chunk has for the point (tree/point_size.h), which hardly
    // grows where a point stands alone; 0, and for points without a size: no limit.
    double radius_limit = 0;
    NormalOrientation orientation;  // for the normals that are computed
    // Values of attributes named curvature, mean_distance and normal_confidence that this filter did not make may be
    // lost (filter/result_attributes.h). Normals and radii of any origin are replaced.
    bool overwrite = false;
    // For the whole process; from least_attribute_memory on it is kept to where the allocator returns large blocks
    // (see peak_memory_bytes). Neither it nor the number of threads changes the result.
    std::uint64_t memory_bytes = std::uint64_t(512) << 20;
    unsigned threads = 0;                           // 0: one per processor
    std::uint64_t unit_points = usual_unit_points;  // NeighbourhoodOptions::unit_points; what is a guess depends on it
    NeighbourBackend backend = NeighbourBackend::own;
    ProgressFunction progress;
};

struct NeighbourAttributeReport : FilterReport {
    // Points by NormalConfidence; 0 when no normals are wanted.
    std::uint64_t lines = 0, blobs = 0, too_few = 0, two_surfaces = 0;
    bool used_known_normals = false;  // radii were measured across normals that the tree had
    std::uint64_t limited = 0;        // radii that the limit made smaller
    std::uint64_t flipped = 0;        // normals that the orientation turned around
};

// In place and atomic: whatever ends it early, also a crash, a cancelled progress or a full disk, leaves the tree as it
// was. Open readers keep reading the old tree. Throws Error(invalid_argument) for options out of range and for an
// attribute that exists with another type or origin, Error(exists) when another process or thread changes the tree, and
// what reading and writing throw. What fails after the tree is changed is a warning of the outcome.
NeighbourAttributeReport compute_neighbour_attributes(const std::filesystem::path& tree,
                                                      const NeighbourAttributeOptions& options);

// "normals and radii", for outcome_text().
std::string noun_of(const WantedValues& wanted);

}  // namespace pcm
