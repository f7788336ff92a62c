#include "pcm/fit/near_tree.h"

#include "pcm/cloud/numbers.h"

#include <algorithm>

namespace pcm {
namespace {

constexpr std::uint32_t leaf_size = 24;

bool nearer(const NearTree::Near& a, const NearTree::Near& b)
{
    return a.square < b.square || (a.square == b.square && a.index < b.index);
}

}  // namespace

NearTree::NearTree(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z)
    : items_(x.size())
{
    for (std::size_t i = 0; i < x.size(); ++i) items_[i] = {{x[i], y[i], z[i]}, static_cast<std::uint32_t>(i)};
    if (!items_.empty()) build(0, static_cast<std::uint32_t>(items_.size()));
}

void NearTree::build(std::uint32_t first, std::uint32_t last)
{
    const auto at = nodes_.size();
    nodes_.push_back({first, last, 3, 0, 0});
    if (last - first <= leaf_size) return;
    Vec3d low = items_[first].place, high = low;
    for (std::uint32_t i = first; i < last; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], items_[i].place[k]);
            high[k] = std::max(high[k], items_[i].place[k]);
        }
    const Vec3d size = high - low;
    const auto axis = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
    const std::uint32_t half = first + (last - first) / 2;
    std::nth_element(items_.begin() + first, items_.begin() + half, items_.begin() + last,
                     [axis](const Item& a, const Item& b) { return a.place[axis] < b.place[axis]; });
    nodes_[at].axis = static_cast<std::uint32_t>(axis);
    nodes_[at].cut = items_[half].place[axis];
    build(first, half);
    nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
    build(half, last);
}

void NearTree::nearest(const Vec3d& place, std::size_t count, std::vector<Near>& near) const
{
    near.clear();
    count = std::min(count, items_.size());
    if (count == 0) return;
    struct Waiting {
        std::uint32_t node;
        double square;  // lower bound of the squared distance, along one axis
    };
    Waiting waiting[64];
    std::size_t many = 0;
    waiting[many++] = {0, 0};
    double worst = infinity;
    while (many > 0) {
        const Waiting next = waiting[--many];
        if (next.square > worst) continue;
        const Node& node = nodes_[next.node];
        if (node.axis == 3) {
            for (std::uint32_t i = node.first; i < node.last; ++i) {
                const double square = squared_distance(items_[i].place, place);
                if (near.size() == count && square >= worst) continue;
                if (near.size() == count) {
                    std::pop_heap(near.begin(), near.end(), nearer);
                    near.pop_back();
                }
                near.push_back({square, items_[i].index});
                std::push_heap(near.begin(), near.end(), nearer);
                if (near.size() == count) worst = near.front().square;
            }
            continue;
        }
        const double away = place[node.axis] - node.cut, square = std::max(next.square, away * away);
        const std::uint32_t left = next.node + 1, right = node.right;
        waiting[many++] = {away < 0 ? right : left, square};
        waiting[many++] = {away < 0 ? left : right, next.square};
    }
    std::sort_heap(near.begin(), near.end(), nearer);
}

}  // namespace pcm
