#include "pcm/fit/near_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace pcm {
namespace {

constexpr std::uint32_t leaf_size = 12;

bool farther(const NearTree::Near& a, const NearTree::Near& b)
{
    return a.square < b.square || (a.square == b.square && a.index < b.index);
}

}  // namespace

NearTree::NearTree(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z)
{
    std::vector<Vec3d> points(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) points[i] = {x[i], y[i], z[i]};
    order_.resize(points.size());
    std::iota(order_.begin(), order_.end(), 0u);
    if (!points.empty()) build(0, static_cast<std::uint32_t>(points.size()), points);
    places_.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) places_[i] = points[order_[i]];
}

void NearTree::build(std::uint32_t first, std::uint32_t last, const std::vector<Vec3d>& points)
{
    const auto at = nodes_.size();
    nodes_.push_back({first, last, 3, 0, 0});
    if (last - first <= leaf_size) return;
    Vec3d low = points[order_[first]], high = low;
    for (std::uint32_t i = first; i < last; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], points[order_[i]][k]);
            high[k] = std::max(high[k], points[order_[i]][k]);
        }
    const Vec3d size = high - low;
    const auto axis = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
    const std::uint32_t half = first + (last - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + half, order_.begin() + last,
                     [&](std::uint32_t a, std::uint32_t b) { return points[a][axis] < points[b][axis]; });
    nodes_[at].axis = static_cast<std::uint32_t>(axis);
    nodes_[at].cut = points[order_[half]][axis];
    build(first, half, points);
    nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
    build(half, last, points);
}

void NearTree::nearest(const Vec3d& place, std::size_t count, std::vector<Near>& near) const
{
    near.clear();
    count = std::min(count, places_.size());
    if (count == 0) return;
    struct Waiting {
        std::uint32_t node;
        double square;  // at least this far, along one axis
    };
    Waiting waiting[64];
    std::size_t many = 0;
    waiting[many++] = {0, 0};
    double worst = std::numeric_limits<double>::infinity();
    while (many > 0) {
        const Waiting next = waiting[--many];
        if (next.square > worst) continue;
        const Node& node = nodes_[next.node];
        if (node.axis == 3) {
            for (std::uint32_t i = node.first; i < node.last; ++i) {
                const double square = squared_distance(places_[i], place);
                if (near.size() == count && square >= worst) continue;
                if (near.size() == count) {
                    std::pop_heap(near.begin(), near.end(), farther);
                    near.pop_back();
                }
                near.push_back({square, order_[i]});
                std::push_heap(near.begin(), near.end(), farther);
                if (near.size() == count) worst = near.front().square;
            }
            continue;
        }
        const double away = place[node.axis] - node.cut, square = std::max(next.square, away * away);
        const std::uint32_t left = next.node + 1, right = node.right;
        waiting[many++] = {away < 0 ? right : left, square};
        waiting[many++] = {away < 0 ? left : right, next.square};
    }
    std::sort_heap(near.begin(), near.end(), farther);
}

}  // namespace pcm
