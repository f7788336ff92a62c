// One number for each point of a tree, in a scratch file: more than fits in memory.
#pragma once

#include "pcm/system/file.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace pcm {

// The file lies in the tree's folder and has no name, or one of an update's scratch files until it is open: nothing is
// left when the process ends. The tree has to be locked for writing, or `folder` be another one. Any number of threads
// may call, for different points.
class ValueFile {
public:
    // Throws what creating a file throws.
    ValueFile(const Tree& tree, const std::filesystem::path& folder);

    // Sets values[i] for the point indices[i] (ascending) of a node. Each point is to be set once; others are 0. Throws
    // Error(no_space | io).
    void set(NodeId node, const std::vector<std::uint32_t>& indices, const double* values);
    // The values of all points of a node.
    std::vector<double> get(NodeId node) const;
    // Calls `see` with all values, some at a time, in the order of the nodes and of the points in them.
    void for_each(const std::function<void(const double* values, std::size_t count)>& see) const;
    std::uint64_t size() const { return first_.back(); }

private:
    File file_;
    std::vector<std::uint64_t> first_;  // number of each node's first point, and of all points
};

}  // namespace pcm
