// A picture of discs by brute force: every pixel's ray against every disc, in double, by the definition, not by the
// shaders' formulas.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/view/level_of_detail.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace pcm::test {

struct Disc {
    Vec3d centre{};  // relative to the view's origin
    Vec3d normal{};  // any length but 0
    double radius = 0;
};

// The first hit of a ray between the near and the far plane.
struct DiscHit {
    std::int32_t disc = -1;                                      // none
    double depth = std::numeric_limits<double>::infinity();      // along the view, eye units
    double runner_up = std::numeric_limits<double>::infinity();  // depth of the next disc behind
    // Whether every disc is hit or missed equally all around within the margin: no silhouette is near.
    bool certain = true;
};

class DiscOracle {
public:
    // `view` as Frustum::of() accepts it, perspective or orthographic, off-axis too.
    explicit DiscOracle(const Camera& view);

    // At window coordinates (pixel centres are at halves, y upwards). `margin`: pixels; 0: everything is certain.
    DiscHit cast(const std::vector<Disc>& discs, double x, double y, double margin = 0) const;
    // All pixel centres, row by row from the lowest.
    std::vector<DiscHit> picture(const std::vector<Disc>& discs, double margin = 0) const;

private:
    struct Ray {
        Vec3d origin, direction;  // relative to the view's origin; the direction is a depth of 1 long
        double depth;             // depth of the origin
    };
    Ray ray(double x, double y) const;
    // Depth along the ray; infinity for a miss.
    double hit(const Ray& ray, const Disc& disc) const;

    Camera view_;
    bool orthographic_ = false;
    Vec3d eye_{};
    Vec3d columns_[3];  // columns of the inverse modelview's 3x3
    double near_ = 0, far_ = 0;
};

}  // namespace pcm::test
