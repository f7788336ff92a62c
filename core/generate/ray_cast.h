// Ray casting: the first surface of the site that a ray hits.
#pragma once

#include "pcm/generate/site.h"

#include <cstdint>
#include <vector>

namespace pcm::scene {

struct Ray {
    Vec3d origin;
    Vec3d direction;        // unit length
    std::uint64_t key = 0;  // decides at which depth of a crown the ray hits a leaf
};

struct Hit {
    double distance = 0;
    std::int64_t shape = -1;  // index into the site's shapes; -1: the ground
    Vec3d normal{};           // unit, towards the scanner
};

// Immutable after construction: threads may cast rays concurrently. The site must outlive it.
class RayCaster {
public:
    explicit RayCaster(const Site& site);

    // False when the ray hits nothing between `nearest` and `farthest` metres.
    bool cast(const Ray& ray, double nearest, double farthest, Hit& hit) const;

private:
    // A leaf's shapes are order_[first, first + count). In an inner node count is 0, and first and first + 1 are its
    // children.
    struct Node {
        Box3d box;
        std::uint32_t first = 0;
        std::uint32_t count = 0;
    };

    void split(std::uint32_t node, std::vector<Box3d>& boxes);
    bool meet_ground(const Ray& ray, double nearest, double farthest, double& distance) const;

    const Site& site_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_;
    std::vector<Shape> shapes_;  // in the order of order_: neighbours in space are neighbours in memory
};

}  // namespace pcm::scene
