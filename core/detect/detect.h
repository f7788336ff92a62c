// Finds all planes, cylinders and spheres of a cloud: the shapes of the kinds that detected_kinds() names.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/shapes/primitive.h"
#include "pcm/system/progress.h"
#include "pcm/tree/tree.h"
#include "pcm/update/target.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

class PointLabels;

// Those whose shapes are found: the kinds whose models say what bends as they do (fit/models/shape_model.h).
std::vector<ShapeKind> detected_kinds();

struct DetectOptions {
    std::vector<ShapeKind> kinds = detected_kinds();  // no others
    double threshold = 0;              // largest distance of a point from its surface, source units; 0: from the noise
    std::uint64_t least_points = 500;  // minimum points of a primitive
    double normal_angle = pi / 9;      // largest angle between a point's normal and the surface's, radians
    // Points farther apart are not of one primitive, source units, at most 128 cells of the sample (some 60 spacings);
    // 0: as the spacing around each allows, and parts of a plane with gaps of up to some 40 spacings are one.
    double step = 0;
    // Whether pieces of surfaces that bend away from the shape, cut out by the threshold, are primitives too, doubtful
    // ones: most of the ground, and floors and walls that are not even. Else a note says how many there were.
    bool pieces = false;
    std::uint64_t seed = 1;
    // Standard deviation of how far a station of the scanner is shifted along each axis: contained in the errors.
    // Millimetres; source units are metres where the cloud does not state their unit. 0: unknown.
    double registration = 0;
    Selection limit;
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    unsigned threads = 0;  // 0: one per processor; fewer run where the memory does not suffice for all
    ProgressFunction progress;
};

struct DetectReport {
    Outcome outcome;                    // in: points that the selection chooses; out: points that belong to a primitive
    std::vector<Primitive> primitives;  // most points first; label = place in the list + 1
    // Values used; step 0: as the spacing allows. Where a part of the cloud has far less noise and no threshold was
    // given, those of the rest; a note says the part's. A primitive may have a larger threshold of its own
    // (Primitive::fit.threshold), up to eight times, where its surface is rougher than the cloud's noise, and half and
    // less where it was found by the second search.
    double threshold = 0, step = 0;
    double spacing = 0, noise = 0;  // those of the cloud, source units, estimated at a few places
    double sample = 0;              // shapes are searched in one point for each cell of this size, source units
    std::vector<std::string> notes;
    // One for each primitive: by how much its errors are enlarged because neighbouring points share errors, within a
    // station where stations are known; at least 1.
    std::vector<double> agreement;
    std::shared_ptr<const PointLabels> labels;  // label of each point, or 0
};

// In bounded memory; four bytes per point in a scratch file, in the system's folder for temporary files. Every point
// with a label is within its primitive's threshold (fit.threshold) of its shape. Where the threshold is found, curved
// shapes with a sagitta below three thresholds and planes narrower than six are not primitives, floors, walls and
// vessels that bend by more than the threshold are doubtful ones; what cones explain better is left out. Where points
// name their stations, the two faces of plates that are thinner than the threshold are two. The points that are left,
// and those of narrow planes that may be several surfaces (FinalFit::contested), are searched again at half the
// threshold, for pipes down to four spacings across and narrow planes. Where the threshold is found, shapes that others
// explain are doubtful (shared_points.h). The errors contain how far stations are apart, where points say from which
// they are or options.registration does, and what errors along their rays may have left of their bias
// (errors_of_stations.h); points that are turned away from their stations are not used (turned_points.h). Elbows of the
// pipes are added by add_elbows(), levels of depth cameras are doubted by doubt_level() (place/depth_levels.h). The
// result depends on the seed, neither on threads nor on memory. Throws Error(invalid_argument) for options out of
// range, steps that reach too many points, and kinds that are not searched for, Error(unsupported) for more than 2^31
// parts of surfaces, what Selector throws, Error(cancelled), and what reading and the scratch file throw.
DetectReport detect_primitives(const std::shared_ptr<const Tree>& tree, const DetectOptions& options);

struct LabelOptions {
    TargetChoice target;                  // in place or into a copy
    std::string attribute = "primitive";  // u32, made when absent: the label, or 0
    bool overwrite = false;               // values that are not labels of primitives may be lost
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    unsigned threads = 0;
    ProgressFunction progress;
};
// Throws what label_primitives() would because of the attribute's name: before the search, not after it. See
// filter/result_attributes.h.
void check_label_attribute(const Tree& tree, const LabelOptions& options);

struct LabelReport {
    Outcome outcome;             // in: points of the tree; out: points whose value was changed
    std::filesystem::path tree;  // the one that was changed or written
};

// Writes which primitive each point belongs to, as detect_primitives() found. Atomic. Throws Error(invalid_argument)
// when the tree was changed since, and for an attribute of that name and another type; what UpdateTarget, reading and
// writing throw.
LabelReport label_primitives(const std::shared_ptr<const Tree>& tree, const DetectReport& found,
                             const LabelOptions& options);

}  // namespace pcm
