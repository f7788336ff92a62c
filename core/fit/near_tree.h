// The nearest neighbours of points in memory: a k-d tree over coordinates of any unit.
#pragma once

#include "pcm/cloud/vector.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

class NearTree {
public:
    // Keeps copies. All coordinates are finite.
    NearTree(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z);

    struct Near {
        double square = 0;  // squared distance
        std::uint32_t index = 0;
    };
    // The nearest `count` points of a place, nearest first, a point there included; `near` is reused.
    void nearest(const Vec3d& place, std::size_t count, std::vector<Near>& near) const;

private:
    struct Node {
        std::uint32_t first = 0, last = 0;  // range in items_
        std::uint32_t axis = 3;             // 3: a leaf
        double cut = 0;
        std::uint32_t right = 0;  // the left child is the next node
    };
    struct Item {
        Vec3d place{};
        std::uint32_t index = 0;
    };
    void build(std::uint32_t first, std::uint32_t last);

    std::vector<Node> nodes_;
    std::vector<Item> items_;
};

}  // namespace pcm
