#include "pcm/shapes/concave_outline.h"

#include "pcm/shapes/triangulation.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace pcm {
namespace {

using Edge = Triangulation::Edge;

class Digger {
public:
    Digger(const FlatPoints& points, double edge)
        : points_(points), triangles_(points), on_border_(points.size()), after_(points.size())
    {
        const double steps = edge > 0 ? edge / points.step() : 3 * median_of_longest_sides();
        limit_ = steps * steps;
    }

    std::vector<std::uint32_t> dig()
    {
        const std::vector<Edge> hull = triangles_.hull();
        for (const Edge e : hull) on_border_[triangles_.origin(e)] = true;
        for (const Edge e : hull) add(e);
        while (!queue_.empty()) {
            const Edge e = queue_.top().second;
            queue_.pop();
            const Edge next = triangles_.around_left(e);
            const std::uint32_t apex = triangles_.target(next);
            if (on_border_[apex]) continue;
            on_border_[apex] = true;
            add(Triangulation::opposite(triangles_.around_left(next)));
            add(Triangulation::opposite(next));
        }
        std::vector<std::uint32_t> outline;
        const std::uint32_t first = triangles_.origin(hull.front());
        std::uint32_t place = first;
        do {
            outline.push_back(place);
            place = after_[place];
        } while (place != first);
        return outline;
    }

private:
    double squared(Edge e) const
    {
        const FlatPoint &a = points_[triangles_.origin(e)], &b = points_[triangles_.target(e)];
        const double x = static_cast<double>(b.x) - a.x, y = static_cast<double>(b.y) - a.y;
        return x * x + y * y;
    }
    void add(Edge e)
    {
        after_[triangles_.origin(e)] = triangles_.target(e);
        if (squared(e) > limit_) queue_.emplace(squared(e), e);
    }
    double median_of_longest_sides() const
    {
        std::vector<double> longest;
        for (std::size_t i = 0; i < triangles_.edges(); ++i) {
            const Edge a = triangles_.edge(i), b = triangles_.around_left(a), c = triangles_.around_left(b);
            if (a > b || a > c || triangles_.around_left(c) != a) continue;
            if (turn_of(points_[triangles_.origin(a)], points_[triangles_.origin(b)], points_[triangles_.origin(c)]) <=
                0)
                continue;
            longest.push_back(std::max({squared(a), squared(b), squared(c)}));
        }
        const auto middle = longest.begin() + static_cast<std::ptrdiff_t>(longest.size() / 2);
        std::nth_element(longest.begin(), middle, longest.end());
        return std::sqrt(*middle);
    }

    const FlatPoints& points_;
    const Triangulation triangles_;
    std::vector<bool> on_border_;
    std::vector<std::uint32_t> after_;  // along the border
    std::priority_queue<std::pair<double, Edge>> queue_;
    double limit_ = 0;
};

}  // namespace

std::vector<std::uint32_t> concave_outline(const FlatPoints& points, double edge) { return Digger(points, edge).dig(); }

}  // namespace pcm
