// Which of many boxes touch a box.
#pragma once

#include "pcm/cloud/geometry.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// A tree of boxes around boxes. Immutable: any number of threads. O(n log n) to make, 64 bytes per box.
class BoxTree {
public:
    BoxTree() = default;
    explicit BoxTree(std::vector<Box3d> boxes);

    // Indices of the boxes that intersect `box`, ascending.
    std::vector<std::uint32_t> touching(const Box3d& box) const;

    // Some of the boxes of a tree, which must outlive it. One thread at a time.
    class Subset {
    public:
        explicit Subset(const BoxTree& tree);
        void add(std::uint32_t index);
        // Indices of the boxes of the subset that intersect `box`, ascending.
        std::vector<std::uint32_t> touching(const Box3d& box) const;

    private:
        const BoxTree* tree_;
        std::vector<std::uint32_t> place_;  // index in order_, keyed by box
        std::vector<std::uint8_t> has_;     // keyed by index in order_
        std::vector<std::uint8_t> below_;   // keyed by node: it holds any of the subset
    };

private:
    struct Node {
        Box3d around;
        std::uint32_t first = 0, last = 0;  // range in order_
        std::uint32_t right = 0;            // the left child is the next node; 0: a leaf
    };
    void build(std::uint32_t first, std::uint32_t last);
    template <class NodeHas, class PlaceHas>
    std::vector<std::uint32_t> find(const Box3d& box, const NodeHas& node_has, const PlaceHas& place_has) const;

    std::vector<Box3d> boxes_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace pcm
