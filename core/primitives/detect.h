// Finds all planes, cylinders, spheres (cones, tori) of a cloud.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/fit/primitive.h"
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

struct DetectOptions {
    std::vector<ShapeKind> kinds{ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere};
    double threshold = 0;              // largest distance of a point from its surface, source units; 0: from the noise
    std::uint64_t least_points = 500;  // of a primitive
    double normal_angle = 0.35;        // largest angle between a point's normal and the surface's, radians
    double step = 0;            // points farther apart are not of one primitive, source units; 0: from the spacing
    double probability = 0.99;  // that a primitive of the least size is not overlooked
    std::uint64_t seed = 1;
    Selection limit;
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    unsigned threads = 0;  // 0: one per processor
    ProgressFunction progress;
};

struct DetectReport {
    Outcome outcome;                    // in: points looked at; out: points that belong to a primitive
    std::vector<Primitive> primitives;  // by points, descending; label = place in the list + 1
    double threshold = 0, step = 0;     // that were used
    std::vector<std::string> notes;
};

// In bounded memory. The result depends on the seed, not on threads. Throws Error(invalid_argument) for options out of
// range, what Selector throws, Error(cancelled), and what reading throws.
DetectReport detect_primitives(const std::shared_ptr<const Tree>& tree, const DetectOptions& options);

struct LabelOptions {
    TargetChoice target;                  // in place or into a copy
    std::string attribute = "primitive";  // u32, made when absent: the label, or 0
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;
    unsigned threads = 0;
    ProgressFunction progress;
};

// Writes which primitive each point belongs to, as detect_primitives() decided. Atomic.
std::filesystem::path label_primitives(const std::shared_ptr<const Tree>& tree, const DetectReport& found,
                                       const DetectOptions& options, const LabelOptions& labels);

}  // namespace pcm
