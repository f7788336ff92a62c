// A set of points of a tree.
//
// A point is its node and its number in the node's chunk. A node of which all points are in the set, or none, costs
// nothing; of another the set keeps a bit per point, so that a set of a billion points takes 125 MB at most. Copies
// share the bits until one of them changes: keeping former sets, to undo, is cheap.
//
// A set belongs to one generation of a tree: numbers of points mean nothing in another.
#pragma once

#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

enum class SetOperation : std::uint8_t { replace, add, subtract, intersect };

// Different objects may be used by different threads; one object by any number of threads that do not change it.
class PointSet {
public:
    explicit PointSet(std::shared_ptr<const Tree> tree);  // empty
    static PointSet all_of(std::shared_ptr<const Tree> tree);

    const Tree& tree() const { return *tree_; }
    const std::shared_ptr<const Tree>& shared_tree() const { return tree_; }
    // Whether this is a set of the points of that tree: the same folder, and no update in between.
    bool belongs_to(const Tree& tree) const;

    std::uint64_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    std::uint32_t count(NodeId node) const { return nodes_[node].count; }
    bool has_all(NodeId node) const { return nodes_[node].count == tree_->node(node).points; }
    bool contains(NodeId node, std::uint32_t point) const;
    // The numbers of the node's points that are in the set, ascending.
    std::vector<std::uint32_t> points(NodeId node) const;
    // One byte per point of the node: 1 in the set, else 0.
    std::vector<std::uint8_t> flags(NodeId node) const;

    // Makes `points`, ascending numbers, the node's points of the set. Throws Error(invalid_argument) for numbers that
    // the node does not have, or which do not ascend.
    void set(NodeId node, const std::vector<std::uint32_t>& points);
    void set_all(NodeId node);
    // All points of the tree that are not in the set.
    void invert();
    // Throws Error(invalid_argument) when `other` belongs to another tree or generation.
    void combine(SetOperation operation, const PointSet& other);
    // The same for the points of one node.
    void combine(SetOperation operation, NodeId node, const std::vector<std::uint32_t>& points);

    std::size_t bytes() const;  // memory, shared bits included
    bool operator==(const PointSet& other) const;

private:
    using Bits = std::vector<std::uint64_t>;
    struct Part {
        std::uint32_t count = 0;
        std::shared_ptr<const Bits> bits;  // null: all points or none
    };
    Bits bits_of(NodeId node) const;
    Bits bits_for(NodeId node, const std::vector<std::uint32_t>& points) const;
    void replace(NodeId node, Part part);
    void merge(SetOperation operation, NodeId node, const Bits& theirs);
    void put(NodeId node, Bits bits);

    std::shared_ptr<const Tree> tree_;
    std::vector<Part> nodes_;
    std::uint64_t size_ = 0;
};

}  // namespace pcm
