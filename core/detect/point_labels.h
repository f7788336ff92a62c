// A number for each point of a tree, in a scratch file: which primitive it belongs to.
#pragma once

#include "pcm/system/file.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <vector>

namespace pcm {

// A new file without a name in the system's folder for temporary files. Throws what creating a file throws.
File scratch_file(const char* name);

// The file lies in the system's folder for temporary files and has no name: nothing is left when the process ends. Any
// number of threads may call, for different points. Four bytes per point.
class PointLabels {
public:
    // All are 0. Throws what creating a file throws.
    explicit PointLabels(const Tree& tree);

    // Sets those of the points `numbers` (ascending) of a node. Throws Error(no_space | io).
    void set(NodeId node, const std::vector<std::uint32_t>& numbers, const std::uint32_t* labels);
    // Sets those of all points of the node.
    void set_all(NodeId node, const std::vector<std::uint32_t>& labels);
    std::vector<std::uint32_t> get(NodeId node) const;

private:
    File file_;
    std::vector<std::uint64_t> first_;  // number of each node's first point, and of all points
};

}  // namespace pcm
