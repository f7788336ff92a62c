#include "bench/pictures/peers/potree_sizes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace pcm::bench {
namespace {

constexpr std::size_t leaf_points = 10000;
constexpr int most_levels = 20;
constexpr int spacings_a_side = 128, density_cells = 32;

std::size_t cell_of(float place, float corner, float side, int cells)
{
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>((place - corner) / side * static_cast<float>(cells)), 0, cells - 1));
}

}  // namespace

PotreeOctree::PotreeOctree(const std::vector<std::array<float, 3>>& points) : points_(points)
{
    std::array<float, 3> low{}, high{};
    low.fill(std::numeric_limits<float>::max());
    high.fill(std::numeric_limits<float>::lowest());
    std::vector<std::uint32_t> all(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        all[i] = static_cast<std::uint32_t>(i);
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], points[i][a]);
            high[a] = std::max(high[a], points[i][a]);
        }
    }
    float side = 1e-6f;
    for (std::size_t a = 0; a < 3; ++a) side = std::max(side, high[a] - low[a]);
    add(low, side, 0, std::move(all));
}

std::size_t PotreeOctree::octant(const Node& node, std::uint32_t point) const
{
    std::size_t index = 0;
    for (std::size_t a = 0; a < 3; ++a)
        index = 2 * index + (points_[point][a] >= node.corner[a] + 0.5f * node.side ? 1 : 0);
    return index;
}

std::int32_t PotreeOctree::add(const std::array<float, 3>& corner, float side, int level,
                               std::vector<std::uint32_t> points)
{
    const auto index = static_cast<std::int32_t>(nodes_.size());
    Node node;
    node.corner = corner;
    node.side = side;
    node.level = level;
    const bool is_leaf = points.size() <= leaf_points || level == most_levels;
    node.points = is_leaf ? std::move(points) : take_sample(node, points);
    node.offset = density_offset(node);
    nodes_.push_back(node);
    if (is_leaf) return index;
    std::array<std::vector<std::uint32_t>, 8> parts;
    for (const std::uint32_t p : points) parts[octant(node, p)].push_back(p);
    for (std::size_t i = 0; i < 8; ++i) {
        if (parts[i].empty()) continue;
        std::array<float, 3> part_corner = corner;
        for (std::size_t a = 0; a < 3; ++a)
            if (i >> (2 - a) & 1) part_corner[a] += 0.5f * side;
        const std::int32_t child = add(part_corner, 0.5f * side, level + 1, std::move(parts[i]));
        nodes_[static_cast<std::size_t>(index)].children[i] = child;
    }
    return index;
}

std::vector<std::uint32_t> PotreeOctree::take_sample(const Node& node, std::vector<std::uint32_t>& points) const
{
    const float spacing = node.side / spacings_a_side;
    constexpr auto cells = static_cast<std::size_t>(spacings_a_side);
    std::vector<std::int32_t> first(cells * cells * cells, -1), next;  // taken points of each cell of one spacing
    std::vector<std::uint32_t> taken, rest;
    const auto is_free = [&](const std::array<float, 3>& p, const std::array<std::size_t, 3>& cell) {
        const auto low = [](std::size_t c) { return c ? c - 1 : 0; };
        for (std::size_t x = low(cell[0]); x < std::min(cells, cell[0] + 2); ++x)
            for (std::size_t y = low(cell[1]); y < std::min(cells, cell[1] + 2); ++y)
                for (std::size_t z = low(cell[2]); z < std::min(cells, cell[2] + 2); ++z)
                    for (std::int32_t i = first[(x * cells + y) * cells + z]; i >= 0;
                         i = next[static_cast<std::size_t>(i)]) {
                        const auto& q = points_[taken[static_cast<std::size_t>(i)]];
                        float square = 0;
                        for (std::size_t a = 0; a < 3; ++a) square += (p[a] - q[a]) * (p[a] - q[a]);
                        if (square < spacing * spacing) return false;
                    }
        return true;
    };
    // A scan's neighbours in the file are neighbours in space: a stride visits them in a mixed order.
    const std::size_t stride = 7919 % points.size() ? 7919 : 1;
    std::vector<bool> visited(points.size());
    for (std::size_t i = 0, at = 0; i < points.size(); ++i, at = (at + stride) % points.size()) {
        while (visited[at]) at = (at + 1) % points.size();
        visited[at] = true;
        const auto& p = points_[points[at]];
        std::array<std::size_t, 3> cell{};
        for (std::size_t a = 0; a < 3; ++a) cell[a] = cell_of(p[a], node.corner[a], node.side, spacings_a_side);
        if (is_free(p, cell)) {
            auto& head = first[(cell[0] * cells + cell[1]) * cells + cell[2]];
            next.push_back(head);
            head = static_cast<std::int32_t>(taken.size());
            taken.push_back(points[at]);
        } else {
            rest.push_back(points[at]);
        }
    }
    points = std::move(rest);
    return taken;
}

double PotreeOctree::density_offset(const Node& node) const
{
    constexpr auto cells = static_cast<std::size_t>(density_cells);
    std::vector<bool> occupied(cells * cells * cells);
    std::size_t count = 0;
    for (const std::uint32_t p : node.points) {
        std::size_t index = 0;
        for (std::size_t a = 0; a < 3; ++a)
            index = index * cells + cell_of(points_[p][a], node.corner[a], node.side, density_cells);
        if (!occupied[index]) ++count;
        occupied[index] = true;
    }
    const std::size_t density = count ? node.points.size() / count : 1;
    return std::log2(static_cast<double>(density)) / 2 - 1.5;
}

std::vector<float> PotreeOctree::sizes() const
{
    std::vector<float> sizes(points_.size());
    const double spacing = nodes_.front().side / spacings_a_side;
    for (const Node& node : nodes_)
        for (const std::uint32_t p : node.points) {
            const Node* deepest = &node;
            for (std::int32_t child; (child = deepest->children[octant(*deepest, p)]) >= 0;)
                deepest = &nodes_[static_cast<std::size_t>(child)];
            sizes[p] = static_cast<float>(1.7 * spacing / (0.5 * std::exp2(deepest->level + deepest->offset)));
        }
    return sizes;
}

}  // namespace pcm::bench
