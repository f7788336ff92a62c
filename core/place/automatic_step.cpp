#include "pcm/cloud/numbers.h"
#include "pcm/place/fit_at.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcm {

double automatic_step(const std::vector<Vec3d>& inliers)
{
    // The tree of least length that joins the points (Prim); its edges in the order of their lengths join them into
    // ever larger groups.
    constexpr std::size_t most = 4000;
    const std::size_t count = std::min(inliers.size(), most);
    struct Edge {
        double square;
        std::size_t from, to;
    };
    if (count < 2) return 0;
    std::vector<Edge> nearest(count, {infinity, 0, 0}), edges;
    std::vector<bool> joined(count, false);
    for (std::size_t last = 0;;) {
        joined[last] = true;
        std::size_t next = count;
        for (std::size_t i = 0; i < count; ++i) {
            if (joined[i]) continue;
            const double square = squared_distance(inliers[i], inliers[last]);
            if (square < nearest[i].square) nearest[i] = {square, last, i};
            if (next == count || nearest[i].square < nearest[next].square) next = i;
        }
        if (next == count) break;
        edges.push_back(nearest[next]);
        last = next;
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.square < b.square; });
    std::vector<std::size_t> group(count), size(count, 1);
    std::iota(group.begin(), group.end(), std::size_t(0));
    const auto group_of = [&](std::size_t i) {
        while (group[i] != i) i = group[i] = group[group[i]];
        return i;
    };
    for (const Edge& edge : edges) {
        const std::size_t a = group_of(edge.from), b = group_of(edge.to);
        group[a] = b;
        size[b] += size[a];
        if (edge.square > 0 && 10 * size[b] >= 9 * count) return 4 * std::sqrt(edge.square);
    }
    return 0;
}

}  // namespace pcm
