// Potree's adaptive point sizes, re-made from its published source (version 1.8: pointcloud.vs, PotreeRenderer.js and
// DecoderWorker.js; Schuetz 2016, Potree: Rendering large point clouds in web browsers; no line of it is here).
//
// Points are in an octree over a cube. A node of level l holds a Poisson-disk sample of what is in its cube with the
// spacing s / 2^l, where s = side / 128 is that of the root; what is left goes to its eight children, and a node of at
// most 10,000 points holds them all. The side of a point's square is
//     w = 1.7 s / (0.5 * 2^(l + o))
// of the deepest node that is shown where the point lies: l its level, and o = log2(d) / 2 - 1.5 for d points in each
// occupied cell of 32^3, as whole numbers. On the screen it is at least 2 and at most 50 pixels.
#pragma once

#include "pcm/cloud/geometry.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcm::bench {

inline constexpr float potree_least_px = 2, potree_most_px = 50;

class PotreeOctree {
public:
    // Points in any unit, relative to a place near them.
    explicit PotreeOctree(const std::vector<std::array<float, 3>>& points);

    // The side of each point's square in the points' unit, with all nodes shown.
    std::vector<float> sizes() const;

private:
    struct Node {
        std::array<float, 3> corner{};
        float side = 0;
        int level = 0;
        double offset = 0;  // o
        std::array<std::int32_t, 8> children{-1, -1, -1, -1, -1, -1, -1, -1};
        std::vector<std::uint32_t> points;
    };

    std::int32_t add(const std::array<float, 3>& corner, float side, int level, std::vector<std::uint32_t> points);
    // The Poisson-disk sample of `points`, which are then the others.
    std::vector<std::uint32_t> take_sample(const Node& node, std::vector<std::uint32_t>& points) const;
    double density_offset(const Node& node) const;
    std::size_t octant(const Node& node, std::uint32_t point) const;

    const std::vector<std::array<float, 3>>& points_;
    std::vector<Node> nodes_;  // the root first
};

}  // namespace pcm::bench
