// Which of many boxes touch a box, while boxes are added.
#pragma once

#include "pcm/cloud/box_tree.h"

#include <cstdint>
#include <vector>

namespace pcm {

// Boxes of numbered things. Trees of 1, 2, 4 ... boxes, of which two of one size become one (Bentley and Saxe 1980):
// n boxes take O(n log^2 n) to add. One thread at a time.
class GrowingBoxTree {
public:
    // A number may have several boxes: one that has grown is added again.
    void add(const Box3d& box, std::uint32_t number);

    // Numbers with a box that intersects `box`, ascending, each once.
    std::vector<std::uint32_t> touching(const Box3d& box) const;

private:
    struct Part {
        std::vector<Box3d> boxes;
        std::vector<std::uint32_t> numbers;
        BoxTree tree;
    };
    std::vector<Part> parts_;  // each with more boxes than the next one
};

}  // namespace pcm
