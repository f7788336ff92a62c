#include "pcm/shapes/triangulation.h"

#include <utility>

namespace pcm {

__extension__ using Int128 = __int128;

Triangulation::Triangulation(const FlatPoints& points) : points_(points)
{
    if (points.size() < 2) return;
    next_.reserve(12 * points.size());
    origin_.reserve(6 * points.size());
    on_hull_ = triangulate(0, static_cast<std::uint32_t>(points.size() - 1)).left;
}

Triangulation::Edge Triangulation::make_edge(std::uint32_t from, std::uint32_t to)
{
    Edge e;
    if (free_.empty()) {
        e = static_cast<Edge>(next_.size());
        next_.resize(next_.size() + 4);
        origin_.resize(origin_.size() + 2);
    } else {
        e = free_.back();
        free_.pop_back();
    }
    next_[e] = e;
    next_[e + 1] = e + 3;
    next_[e + 2] = e + 2;
    next_[e + 3] = e + 1;
    origin_[e >> 1] = from;
    origin_[(e >> 1) + 1] = to;
    return e;
}

void Triangulation::splice(Edge a, Edge b)
{
    const Edge alpha = turned(next_[a]), beta = turned(next_[b]);
    std::swap(next_[a], next_[b]);
    std::swap(next_[alpha], next_[beta]);
}

// From the target of a to the origin of b, with the same face to the left of all three.
Triangulation::Edge Triangulation::connect(Edge a, Edge b)
{
    const Edge e = make_edge(target(a), origin(b));
    splice(e, around_left(a));
    splice(opposite(e), b);
    return e;
}

void Triangulation::remove(Edge e)
{
    splice(e, before_at_origin(e));
    splice(opposite(e), before_at_origin(opposite(e)));
    e &= ~3u;
    origin_[e >> 1] = origin_[(e >> 1) + 1] = 0;
    free_.push_back(e);
}

std::int64_t Triangulation::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const
{
    return turn_of(points_[a], points_[b], points_[c]);
}

// Whether d is inside of the circle through a, b, c, which turn counter-clockwise.
bool Triangulation::in_circle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const
{
    struct Lifted {
        std::int64_t x, y, square;
    };
    const auto lifted = [&](std::uint32_t i) {
        const std::int64_t x = std::int64_t{points_[i].x} - points_[d].x, y = std::int64_t{points_[i].y} - points_[d].y;
        return Lifted{x, y, x * x + y * y};
    };
    const Lifted p = lifted(a), q = lifted(b), r = lifted(c);
    const auto minor = [](const Lifted& s, const Lifted& t) { return s.x * t.y - s.y * t.x; };
    return Int128{p.square} * minor(q, r) + Int128{q.square} * minor(r, p) + Int128{r.square} * minor(p, q) > 0;
}

Triangulation::Ends Triangulation::triangulate_few(std::uint32_t first, std::uint32_t last)
{
    const Edge a = make_edge(first, first + 1);
    if (last - first == 1) return {a, opposite(a)};
    const Edge b = make_edge(first + 1, last);
    splice(opposite(a), b);
    const std::int64_t side = turn(first, first + 1, last);
    if (side == 0) return {a, opposite(b)};
    const Edge c = connect(b, a);
    if (side > 0) return {a, opposite(b)};
    return {opposite(c), c};
}

// Joins two halves by the edge below both.
Triangulation::Edge Triangulation::lower_tangent(Ends& low, Ends& high)
{
    for (;;) {
        if (is_left_of(origin(high.left), low.right))
            low.right = around_left(low.right);
        else if (is_right_of(origin(low.right), high.left))
            high.left = next_[opposite(high.left)];
        else
            break;
    }
    return connect(opposite(high.left), low.right);
}

Triangulation::Edge Triangulation::left_candidate(Edge base)
{
    Edge candidate = next_[opposite(base)];
    if (!is_right_of(target(candidate), base)) return candidate;
    while (in_circle(target(base), origin(base), target(candidate), target(next_[candidate]))) {
        const Edge after = next_[candidate];
        remove(candidate);
        candidate = after;
    }
    return candidate;
}

Triangulation::Edge Triangulation::right_candidate(Edge base)
{
    Edge candidate = before_at_origin(base);
    if (!is_right_of(target(candidate), base)) return candidate;
    while (in_circle(target(base), origin(base), target(candidate), target(before_at_origin(candidate)))) {
        const Edge after = before_at_origin(candidate);
        remove(candidate);
        candidate = after;
    }
    return candidate;
}

// The cross edges above the first one, upwards.
void Triangulation::merge(Edge base)
{
    for (;;) {
        const Edge left = left_candidate(base), right = right_candidate(base);
        const bool left_is_above = is_right_of(target(left), base), right_is_above = is_right_of(target(right), base);
        if (!left_is_above && !right_is_above) return;
        if (!left_is_above || (right_is_above && in_circle(target(left), origin(left), origin(right), target(right))))
            base = connect(right, opposite(base));
        else
            base = connect(opposite(base), opposite(left));
    }
}

Triangulation::Ends Triangulation::triangulate(std::uint32_t first, std::uint32_t last)
{
    if (last - first < 3) return triangulate_few(first, last);
    const std::uint32_t middle = first + (last - first) / 2;
    Ends low = triangulate(first, middle), high = triangulate(middle + 1, last);
    const Ends outer{low.left, high.right};
    const Edge base = lower_tangent(low, high);
    Ends ends = outer;
    if (origin(low.right) == origin(outer.left)) ends.left = opposite(base);
    if (origin(high.left) == origin(outer.right)) ends.right = base;
    merge(base);
    return ends;
}

std::vector<Triangulation::Edge> Triangulation::hull() const
{
    std::vector<Edge> hull;
    if (next_.empty()) return hull;
    Edge e = on_hull_;
    do {
        hull.push_back(e);
        e = next_[opposite(e)];
    } while (e != on_hull_);
    return hull;
}

}  // namespace pcm
