// Shapes found in parts of a cloud, and the same ones brought together.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/detect/surface_sample.h"
#include "pcm/shapes/shape.h"

#include <cstdint>
#include <vector>

namespace pcm {

struct Hypothesis {
    Shape shape;              // source coordinates
    Box3d box;                // around its points
    std::vector<Vec3d> some;  // an even choice of its points; source coordinates
    double area = 0;          // about, source units squared
    double rms = 0;
    double threshold = 0;   // largest distance of its points, source units
    double reach = 0;       // its points may lie so far outside of the box, source units
    bool thin = false;      // normals of its points show nothing of it (pipe_search.h)
    bool of_strip = false;  // a cylinder along a narrow plane (shape_search.h)
    bool whole = false;     // it was tried whether its points are a piece of something bent: they are not
};
inline constexpr std::size_t hypothesis_points = 256;  // in `some`

// Root mean square of the points' distances; 0 for none.
double rms_distance(const Shape& shape, const std::vector<Vec3d>& points);

// Where points of it may lie, if they may lie at least so far outside of its box.
Box3d reached_box(const Hypothesis& one, double least_reach);

struct ExplainedLimits {
    double threshold = 0;     // distance from a known shape, source units
    double reach = 0;         // from the box of its points, or the reach that it has, source units
    double normal_angle = 0;  // between a point's normal and the shape's, radians
};

// Sets taken[i] = 1 for the points of a sample that a known shape explains.
void mark_explained(const SurfaceSample& sample, const std::vector<Hypothesis>& known, const ExplainedLimits& limits,
                    std::vector<std::uint8_t>& taken);

struct MergeOptions {
    double gap = 0;           // between boxes that touch, source units; or the reach of the larger one
    double normal_angle = 0;  // between two shapes' normals at one place
};

// Brings together shapes of one kind of which one's points lie on the other, as near as on their own, and whose boxes
// touch; each is then fitted to the points of both. Those whose points lie on a larger one of any kind are left out.
// The result depends on the order. O(n log^2 n) for shapes of which each reaches few others; `pairs`, if not null, is
// increased by the number of pairs of shapes that were compared.
std::vector<Hypothesis> merged(std::vector<Hypothesis> all, const MergeOptions& options,
                               std::uint64_t* pairs = nullptr);

}  // namespace pcm
