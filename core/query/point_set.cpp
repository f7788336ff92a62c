#include "pcm/query/point_set.h"

#include "pcm/system/error.h"

#include <string>
#include <utility>

namespace pcm {
namespace {

std::uint32_t ones(std::uint64_t word) { return static_cast<std::uint32_t>(__builtin_popcountll(word)); }

}  // namespace

PointSet::PointSet(std::shared_ptr<const Tree> tree) : tree_(std::move(tree)), nodes_(tree_->nodes().size()) {}

PointSet PointSet::all_of(std::shared_ptr<const Tree> tree)
{
    PointSet set(std::move(tree));
    set.invert();
    return set;
}

bool PointSet::belongs_to(const Tree& tree) const
{
    return tree_->folder() == tree.folder() && tree_->info().generation == tree.info().generation &&
           tree_->info().content_hash == tree.info().content_hash && tree_->nodes().size() == tree.nodes().size();
}

bool PointSet::contains(NodeId node, std::uint32_t point) const
{
    const Part& part = nodes_[node];
    if (!part.bits) return part.count > 0 && point < part.count;
    return point / 64 < part.bits->size() && ((*part.bits)[point / 64] >> (point % 64) & 1);
}

std::vector<std::uint32_t> PointSet::points(NodeId node) const
{
    const Part& part = nodes_[node];
    std::vector<std::uint32_t> points;
    points.reserve(part.count);
    if (!part.bits) {
        for (std::uint32_t i = 0; i < part.count; ++i) points.push_back(i);
        return points;
    }
    for (std::uint32_t w = 0; w < part.bits->size(); ++w)
        for (std::uint64_t word = (*part.bits)[w]; word != 0; word &= word - 1)
            points.push_back(w * 64 + static_cast<std::uint32_t>(__builtin_ctzll(word)));
    return points;
}

std::vector<std::uint8_t> PointSet::flags(NodeId node) const
{
    const Part& part = nodes_[node];
    std::vector<std::uint8_t> flags(tree_->node(node).points, part.bits || part.count == 0 ? 0 : 1);
    if (part.bits)
        for (std::uint32_t i = 0; i < flags.size(); ++i) flags[i] = (*part.bits)[i / 64] >> (i % 64) & 1;
    return flags;
}

PointSet::Bits PointSet::bits_of(NodeId node) const
{
    const Part& part = nodes_[node];
    if (part.bits) return *part.bits;
    const std::uint32_t points = tree_->node(node).points;
    Bits bits((points + 63) / 64, part.count == 0 ? 0 : ~std::uint64_t(0));
    if (part.count > 0 && points % 64 != 0) bits.back() = (std::uint64_t(1) << (points % 64)) - 1;
    return bits;
}

void PointSet::put(NodeId node, Bits bits)
{
    Part part;
    for (const std::uint64_t word : bits) part.count += ones(word);
    if (part.count > 0 && part.count < tree_->node(node).points)
        part.bits = std::make_shared<const Bits>(std::move(bits));
    size_ += part.count;
    size_ -= nodes_[node].count;
    nodes_[node] = std::move(part);
}

PointSet::Bits PointSet::bits_for(NodeId node, const std::vector<std::uint32_t>& points) const
{
    const std::uint32_t count = tree_->node(node).points;
    Bits bits((count + 63) / 64, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i] >= count || (i > 0 && points[i] <= points[i - 1]))
            throw Error(ErrorCode::invalid_argument, tree_->folder(),
                        "point " + std::to_string(points[i]) + " of node " + std::to_string(node) +
                            " cannot be in a set: the node has " + std::to_string(count) + " points",
                        "give ascending numbers of points that the node has");
        bits[points[i] / 64] |= std::uint64_t(1) << (points[i] % 64);
    }
    return bits;
}

void PointSet::set(NodeId node, const std::vector<std::uint32_t>& points) { put(node, bits_for(node, points)); }

void PointSet::set_all(NodeId node)
{
    const std::uint32_t points = tree_->node(node).points;
    size_ += points - nodes_[node].count;
    nodes_[node] = {points, nullptr};
}

void PointSet::invert()
{
    for (NodeId node = 0; node < nodes_.size(); ++node) {
        if (nodes_[node].count == 0) {
            set_all(node);
        } else if (!nodes_[node].bits) {
            size_ -= nodes_[node].count;
            nodes_[node] = {};
        } else {
            Bits bits = bits_of(node);
            for (std::uint64_t& word : bits) word = ~word;
            const std::uint32_t rest = tree_->node(node).points % 64;
            if (rest != 0) bits.back() &= (std::uint64_t(1) << rest) - 1;
            put(node, std::move(bits));
        }
    }
}

void PointSet::combine(SetOperation operation, const PointSet& other)
{
    if (!belongs_to(*other.tree_))
        throw Error(ErrorCode::invalid_argument, other.tree_->folder(),
                    "sets of points of two trees, or of a tree before and after a change, cannot be combined",
                    "select again");
    if (operation == SetOperation::replace) {
        *this = other;
        return;
    }
    for (NodeId node = 0; node < nodes_.size(); ++node) {
        const Part& theirs = other.nodes_[node];
        // Most nodes are full or empty: no bit is looked at.
        const bool none = theirs.count == 0, all = !none && !theirs.bits;
        if (operation == SetOperation::add) {
            if (none || has_all(node)) continue;
            if (all || nodes_[node].count == 0)
                replace(node, theirs);
            else
                merge(operation, node, *theirs.bits);
        } else if (operation == SetOperation::subtract) {
            if (none || nodes_[node].count == 0) continue;
            if (all)
                replace(node, {});
            else
                merge(operation, node, *theirs.bits);
        } else {
            if (all || nodes_[node].count == 0) continue;
            if (none || has_all(node))
                replace(node, theirs);
            else
                merge(operation, node, *theirs.bits);
        }
    }
}

void PointSet::replace(NodeId node, Part part)
{
    size_ += part.count;
    size_ -= nodes_[node].count;
    nodes_[node] = std::move(part);
}

void PointSet::merge(SetOperation operation, NodeId node, const Bits& theirs)
{
    Bits bits = bits_of(node);
    for (std::size_t w = 0; w < bits.size(); ++w)
        bits[w] = operation == SetOperation::replace    ? theirs[w]
                  : operation == SetOperation::add      ? bits[w] | theirs[w]
                  : operation == SetOperation::subtract ? bits[w] & ~theirs[w]
                                                        : bits[w] & theirs[w];
    put(node, std::move(bits));
}

void PointSet::combine(SetOperation operation, NodeId node, const std::vector<std::uint32_t>& points)
{
    merge(operation, node, bits_for(node, points));
}

std::size_t PointSet::bytes() const
{
    std::size_t bytes = nodes_.size() * sizeof(Part);
    for (const Part& part : nodes_)
        if (part.bits) bytes += part.bits->size() * sizeof(std::uint64_t);
    return bytes;
}

bool PointSet::operator==(const PointSet& other) const
{
    if (size_ != other.size_ || !belongs_to(*other.tree_)) return false;
    for (NodeId node = 0; node < nodes_.size(); ++node)
        if (nodes_[node].count != other.nodes_[node].count || bits_of(node) != other.bits_of(node)) return false;
    return true;
}

}  // namespace pcm
