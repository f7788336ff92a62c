// Every invariant that tree.h states for nodes. A tree that passes can be walked without further checks. All members
// throw Error(corrupt), naming the index and the node.
#pragma once

#include "pcm/tree/tree.h"

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace pcm {

// Keeps references to what it is given.
class NodeChecks {
public:
    // Checks the parts and the data files; `nodes` is the number of nodes.
    NodeChecks(const TreeInfo& info, const std::vector<DataFile>& data_files, const std::vector<NodeId>& part_roots,
               std::size_t nodes, const std::filesystem::path& path);

    using NodeAt = std::function<const Node&(NodeId)>;

    // A node by itself, under its parent and in its part. `at` is called for nodes above this one that are checked
    // already.
    void check(NodeId id, const Node& node, const NodeAt& at) const;
    // That a node's child knows the node.
    void check_child(NodeId id, const Node& child) const;
    // A node's children, for all of which check_child() has passed: that their points are those below the node.
    void check_points(NodeId id, const Node& node, const NodeAt& at) const;

    // Throws Error(corrupt) about a node.
    [[noreturn]] void refuse(NodeId id, const std::string& what) const;

private:
    void check_parts() const;
    void check_links(NodeId id, const Node& node, const NodeAt& at) const;
    void check_part(NodeId id, const Node& node, const NodeAt& at) const;
    void check_contents(NodeId id, const Node& node) const;
    // The part whose root is the node; no_part when it is not a root.
    std::uint32_t part_with_root(NodeId id) const;

    const TreeInfo& info_;
    const std::vector<DataFile>& data_files_;
    const std::vector<NodeId>& part_roots_;
    const std::size_t nodes_;
    const std::filesystem::path path_;
    std::vector<std::pair<NodeId, std::uint32_t>> parts_by_root_;  // root and part, ascending
};

}  // namespace pcm
