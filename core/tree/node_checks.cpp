#include "pcm/tree/node_checks.h"

#include "pcm/system/error.h"

#include <algorithm>

namespace pcm {

NodeChecks::NodeChecks(const TreeInfo& info, const std::vector<DataFile>& data_files,
                       const std::vector<NodeId>& part_roots, std::size_t nodes, const std::filesystem::path& path)
    : info_(info), data_files_(data_files), part_roots_(part_roots), nodes_(nodes), path_(path)
{
    if ((nodes_ == 0) != (info_.points == 0)) throw Error(ErrorCode::corrupt, path_, "points without nodes");
    if ((nodes_ == 0) != part_roots_.empty()) throw Error(ErrorCode::corrupt, path_, "parts without nodes");
    for (std::size_t i = 0; i < data_files_.size(); ++i)
        if (data_files_[i].generation == 0 || data_files_[i].generation > info_.generation)
            throw Error(ErrorCode::corrupt, path_,
                        "data file " + std::to_string(i) + " is of generation " +
                            std::to_string(data_files_[i].generation) + ", the tree of generation " +
                            std::to_string(info_.generation));
    for (std::size_t part = 0; part < part_roots_.size(); ++part)
        if (part_roots_[part] != no_node)
            parts_by_root_.emplace_back(part_roots_[part], static_cast<std::uint32_t>(part));
    std::sort(parts_by_root_.begin(), parts_by_root_.end());
    check_parts();
}

void NodeChecks::check_parts() const
{
    for (std::size_t i = 0; i < parts_by_root_.size(); ++i) {
        const auto [root, part] = parts_by_root_[i];
        if (root >= nodes_)
            throw Error(ErrorCode::corrupt, path_, "the root of part " + std::to_string(part) + " does not exist");
        if (i > 0 && parts_by_root_[i - 1].first == root) refuse(root, "is the root of two parts");
    }
}

void NodeChecks::refuse(NodeId id, const std::string& what) const
{
    throw Error(ErrorCode::corrupt, path_, "node " + std::to_string(id) + ": " + what);
}

std::uint32_t NodeChecks::part_with_root(NodeId id) const
{
    const auto found = std::lower_bound(parts_by_root_.begin(), parts_by_root_.end(), std::pair(id, std::uint32_t(0)));
    return found != parts_by_root_.end() && found->first == id ? found->second : no_part;
}

void NodeChecks::check(NodeId id, const Node& node, const NodeAt& at) const
{
    check_links(id, node, at);
    check_part(id, node, at);
    check_contents(id, node);
}

void NodeChecks::check_links(NodeId id, const Node& node, const NodeAt& at) const
{
    if ((id == 0) != (node.parent == no_node)) refuse(id, "has no place under the root");
    if (id > 0) {
        if (node.parent >= id) refuse(id, "comes before its parent");
        const Node& parent = at(node.parent);
        if (parent.children[0] != id && parent.children[1] != id) refuse(id, "is not its parent's child");
        if (node.depth != parent.depth + 1) refuse(id, "is not one step below its parent");
        if (!parent.box.contains(node.box.min) || !parent.box.contains(node.box.max))
            refuse(id, "reaches out of its parent's box");
    } else if (node.depth != 0) {
        refuse(id, "is a root whose depth is not 0");
    }
    for (const NodeId child : node.children)
        if (child != no_node && (child <= id || child >= nodes_)) refuse(id, "has a false child");
    if (node.children[0] != no_node && node.children[0] == node.children[1]) refuse(id, "has one child twice");
}

void NodeChecks::check_part(NodeId id, const Node& node, const NodeAt& at) const
{
    const std::uint32_t above = id > 0 ? at(node.parent).part : no_part;
    const std::uint32_t own = part_with_root(id);
    if (own != no_part && above != no_part) refuse(id, "is the root of a part inside another part");
    if (node.part != (own != no_part ? own : above)) refuse(id, "is not in the part of its parent");
    if (node.part == no_part) {
        if (node.points > 0 || node.is_leaf()) refuse(id, "belongs to no part");
    } else if (own == no_part && node.depth - at(part_roots_[node.part]).depth > NodePath::max_depth) {
        refuse(id, "is too deep in its part");
    }
}

void NodeChecks::check_contents(NodeId id, const Node& node) const
{
    if (id == 0 && (node.subtree_points != info_.points || !(node.box == info_.box)))
        throw Error(ErrorCode::corrupt, path_, "the root does not hold the cloud's points");
    if (node.box.empty()) refuse(id, "has no box");
    const Extent& extent = node.extent;
    if ((node.points == 0) != (extent.bytes == 0)) refuse(id, "has points without a chunk");
    if (extent.bytes &&
        (extent.file >= data_files_.size() || extent.offset > data_files_[extent.file].bytes ||
         extent.bytes > data_files_[extent.file].bytes - extent.offset || extent.header_bytes > extent.bytes))
        refuse(id, "has its chunk outside the data files");
    if (!(node.spacing >= 0)) refuse(id, "has no spacing");
    if (node.first_level + node.level_points.size() > info_.levels) refuse(id, "has points of no level");
    std::uint64_t of_levels = 0;
    for (const std::uint32_t points : node.level_points) of_levels += points;
    if (of_levels != node.points) refuse(id, "does not state of which levels its points are");
}

void NodeChecks::check_child(NodeId id, const Node& child) const
{
    if (child.parent != id) refuse(id, "has a false child");
}

void NodeChecks::check_points(NodeId id, const Node& node, const NodeAt& at) const
{
    std::uint64_t below = node.points;
    for (const NodeId child : node.children)
        if (child != no_node) below += at(child).subtree_points;
    if (below != node.subtree_points) refuse(id, "does not hold as many points as it says");
}

}  // namespace pcm
