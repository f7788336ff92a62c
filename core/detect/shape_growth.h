// How a shape grows in a sample, from point to point.
#pragma once

#include "pcm/detect/surface_sample.h"
#include "pcm/shapes/shape.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

struct FoundShape {
    Shape shape;                        // relative to the sample's origin
    std::vector<std::uint32_t> points;  // numbers of points of the sample
    double rms = 0;                     // rms of their distances
    double threshold = 0;               // maximum of their distances, source units
    bool thin = false;                  // normals of its points show nothing of it
    bool of_strip = false;              // a cylinder along a narrow plane
};

// Which points belong to a growing shape.
struct GrowthLimits {
    double threshold = 0;    // distance, source units
    double cos_angle = -1;   // minimum cosine between the normals of the point and of the shape; -1: any
    std::size_t least = 20;  // minimum number of points
};

// Whether a point fits: distance and normal.
bool fits(const SurfaceSample& sample, std::size_t point, const Shape& shape, double threshold, double cos_angle);

// One thread.
class ShapeGrowth {
public:
    // `taken`: for each point, whether it belongs to something already. Both must outlive it.
    ShapeGrowth(const SurfaceSample& sample, std::vector<std::uint8_t>& taken)
        : sample_(sample), taken_(taken), seen_(sample.size(), 0)
    {
    }

    bool is_free(std::uint32_t i) const { return !taken_[i]; }

    // Up to `most` free points around the seed in the order of edges, whose normals are within this cosine of the
    // seed's; -1: any.
    std::vector<std::uint32_t> patch(std::uint32_t seed, std::size_t most, double cos_angle);

    // All free points that edges reach from `from` through points that fit; the shape is fitted again each time that
    // it has twice the points, and three times at the end. Fewer than limits.least points where it has none.
    FoundShape grow(Shape shape, const std::vector<std::uint32_t>& from, const GrowthLimits& limits);

    // A cylinder grown from all free points near it between its ends: edges do not lead around a pipe whose sides are
    // seen by different scanners, or past what is in front of it.
    FoundShape grow_around(const FoundShape& pipe, const GrowthLimits& limits);

    // Takes a shape's points, and those next to it that noise may have put there: they are not a shape of their own.
    void take(const FoundShape& found, const GrowthLimits& limits);

private:
    bool refit(Shape& shape, const std::vector<std::uint32_t>& points, double threshold) const;
    std::vector<std::uint32_t> reach(Shape& shape, const std::vector<std::uint32_t>& from, const GrowthLimits& limits,
                                     bool refits);

    const SurfaceSample& sample_;
    std::vector<std::uint8_t>& taken_;
    std::vector<std::uint32_t> seen_;
    std::uint32_t stamp_ = 0;
};

}  // namespace pcm
