#include "pcm/update/part_nodes.h"

#include "pcm/tree/node_order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <tuple>

namespace pcm {
namespace {

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

// A node with its links.
struct Entry {
    const PartNode* given = nullptr;  // null for a missing inner node that was added
    std::uint32_t part = 0;
    NodePath path;
    std::array<std::size_t, 2> children{none, none};
    double spacing = 0;
    std::uint64_t points = 0;  // number of points of the subtree
    Box3i box;                 // box of the subtree
};

NodePath parent_of(const NodePath& path)
{
    NodePath parent = path;
    --parent.depth;
    parent.bits[parent.depth / 64] &= ~(std::uint64_t(1) << (parent.depth % 64));
    return parent;
}

unsigned side_of(const NodePath& path) { return path.bits[(path.depth - 1) / 64] >> ((path.depth - 1) % 64) & 1; }

class Joiner {
public:
    Joiner(const std::vector<double>& spacings, const Vec3d& scale)
        : scale_(scale), top_spacing_(spacings.empty() ? 0 : 2 * spacings[0])
    {
    }

    NodeVector run(const std::vector<PartNode>& nodes)
    {
        place(nodes);
        NodeVector result;
        std::vector<std::size_t> roots;
        for (const auto& [part, root] : roots_)
            if (entries_[root].points) roots.push_back(root);
        if (roots.empty()) return result;
        result.part_roots.assign(entries_[roots.back()].part + std::size_t(1), no_node);
        const std::size_t parts_end = entries_.size();  // entries that join parts follow
        const std::size_t top = join(roots.data(), roots.data() + roots.size());

        const auto order = order_nodes<std::size_t>(
            top, none, [&](std::size_t entry, unsigned side) { return entries_[entry].children[side]; });
        result.nodes = linked_nodes(order);
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Entry& entry = entries_[order[i].item];
            const bool in_part = order[i].item < parts_end;
            if (in_part && entry.path.depth == 0) result.part_roots[entry.part] = static_cast<NodeId>(i);
            Node& node = result.nodes[i];
            node.part = in_part ? entry.part : no_part;
            node.subtree_points = entry.points;
            node.box = entry.box;
            const bool has_points = entry.given && entry.given->points > 0;
            // A leaf's chunk says how far its points are apart where the chunks below it are lost, else 0.
            node.spacing = !node.is_leaf() ? entry.spacing : has_points ? entry.given->spacing : 0;
            if (!has_points) continue;
            node.points = entry.given->points;
            node.first_level = entry.given->first_level;
            node.level_points = entry.given->level_points;
            node.extent = entry.given->extent;
        }
        return result;
    }

private:
    using Key = std::tuple<std::uint32_t, std::uint16_t, std::uint64_t,
                           std::uint64_t>;  // part, depth, path: parents before children

    // Makes linked entries for all nodes and for missing inner ones, sums up the subtrees, and unlinks those without
    // points.
    void place(const std::vector<PartNode>& nodes)
    {
        std::map<Key, std::size_t> at;
        const auto entry_of = [&](std::uint32_t part, const NodePath& path) {
            const auto [found, is_new] =
                at.try_emplace({part, path.depth, path.bits[0], path.bits[1]}, entries_.size());
            if (is_new) {
                entries_.emplace_back();
                entries_.back().part = part;
                entries_.back().path = path;
            }
            return std::pair(found->second, is_new);
        };
        for (const PartNode& node : nodes) entries_[entry_of(node.part, node.path).first].given = &node;
        for (const PartNode& node : nodes) {
            NodePath path = node.path;
            while (path.depth > 0) {
                path = parent_of(path);
                if (!entry_of(node.part, path).second) break;
            }
        }
        for (auto it = at.rbegin(); it != at.rend(); ++it) {
            Entry& entry = entries_[it->second];
            if (entry.given) {
                entry.points += entry.given->points;
                entry.box.extend(entry.given->box);
            }
            if (entry.path.depth == 0) {
                roots_.emplace(entry.part, it->second);
                continue;
            }
            if (entry.points == 0) continue;
            Entry& parent = entries_[entry_of(entry.part, parent_of(entry.path)).first];
            parent.children[side_of(entry.path)] = it->second;
            parent.points += entry.points;
            parent.box.extend(entry.box);
        }
        for (const auto& [key, number] : at) {
            Entry& entry = entries_[number];
            if (entry.given && entry.given->spacing > 0)
                entry.spacing = entry.given->spacing;
            else if (entry.path.depth == 0)
                entry.spacing = top_spacing_;
            else {
                const NodePath above = parent_of(entry.path);
                entry.spacing = entries_[at.at({std::get<0>(key), above.depth, above.bits[0], above.bits[1]})].spacing;
            }
        }
    }

    // Makes the entry above the parts whose roots are [first, last).
    std::size_t join(std::size_t* first, std::size_t* last)
    {
        if (last - first == 1) return *first;
        const auto middle_of = [&](std::size_t root, std::size_t a) {
            const Box3i& box = entries_[root].box;
            return (static_cast<double>(box.min[a]) / 2 + static_cast<double>(box.max[a]) / 2) * scale_[a];
        };
        std::size_t axis = 0;
        double widest = -1;
        for (std::size_t a = 0; a < 3; ++a) {
            double low = middle_of(*first, a), high = low;
            for (const std::size_t* root = first; root != last; ++root) {
                low = std::min(low, middle_of(*root, a));
                high = std::max(high, middle_of(*root, a));
            }
            if (high - low > widest) {
                widest = high - low;
                axis = a;
            }
        }
        std::sort(first, last, [&](std::size_t p, std::size_t q) {
            const double a = middle_of(p, axis), b = middle_of(q, axis);
            return a != b ? a < b : entries_[p].part < entries_[q].part;
        });
        std::size_t* middle = first + (last - first) / 2;
        Entry entry;
        entry.children = {join(first, middle), join(middle, last)};
        entry.spacing = top_spacing_;
        for (const std::size_t child : entry.children) {
            entry.points += entries_[child].points;
            entry.box.extend(entries_[child].box);
        }
        entries_.push_back(entry);
        return entries_.size() - 1;
    }

    const Vec3d scale_;
    const double top_spacing_;
    std::vector<Entry> entries_;
    std::map<std::uint32_t, std::size_t> roots_;  // root of each part
};

}  // namespace

std::vector<PartNode> part_nodes(const Tree& tree)
{
    std::vector<PartNode> nodes;
    for (NodeId id = 0; id < tree.nodes().size(); ++id) {
        const Node& from = tree.node(id);
        if (from.part == no_part) continue;
        PartNode node;
        node.id = id;
        node.part = from.part;
        node.path = tree.identity(id).path;
        node.points = from.points;
        node.first_level = from.first_level;
        node.level_points = from.level_points;
        node.spacing = from.spacing;
        node.box = from.box;
        node.extent = from.extent;
        nodes.push_back(std::move(node));
    }
    return nodes;
}

NodeVector join_parts(const std::vector<PartNode>& nodes, const std::vector<double>& spacings, const Vec3d& scale)
{
    return Joiner(spacings, scale).run(nodes);
}

}  // namespace pcm
