// Which node of a tree a chunk belongs to.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pcm {

// The path from the root to a node: bit i of the 128 is the side of the child at depth i.
struct NodePath {
    static constexpr std::uint16_t max_depth = 128;
    std::uint16_t depth = 0;
    std::array<std::uint64_t, 2> bits{0, 0};

    NodePath child(unsigned side) const
    {
        NodePath path = *this;
        if (side) path.bits[depth / 64] |= std::uint64_t(1) << (depth % 64);
        ++path.depth;
        return path;
    }
    bool operator==(const NodePath& o) const { return depth == o.depth && bits == o.bits; }
};

// The identity of a tree's chunk, which allows the tree to be rebuilt from its chunks alone.
struct ChunkIdentity {
    NodePath path;                  // from the root of its part
    std::uint32_t part = 0;         // 0: made by the build; each append adds a part
    std::uint32_t generation = 1;   // tree's when the chunk was written: 1 for the build, one more for each update
    std::uint16_t first_level = 0;  // first level of its points
    std::vector<std::uint32_t> level_points;  // number of points of first_level, of the next, ...
    double spacing = 0;                       // as Node::spacing

    bool operator==(const ChunkIdentity& o) const
    {
        return path == o.path && part == o.part && generation == o.generation && first_level == o.first_level &&
               level_points == o.level_points && spacing == o.spacing;
    }
};

}  // namespace pcm
