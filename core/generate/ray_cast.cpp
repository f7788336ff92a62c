#include "pcm/generate/ray_cast.h"

#include "pcm/generate/determinism.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace pcm::scene {
namespace {

constexpr std::uint32_t leaf_shapes = 3;
constexpr double leaves_per_metre = 2.2;  // mean free path in a crown: 1 / this

double area(const Box3d& b)
{
    if (b.empty()) return 0;
    return b.extent(0) * b.extent(1) + b.extent(1) * b.extent(2) + b.extent(2) * b.extent(0);
}

// Distances along the ray at which it enters and leaves the sphere.
bool meet_sphere(const Ray& ray, const Vec3d& centre, double radius, double& enter, double& leave)
{
    const Vec3d to = centre - ray.origin;
    const double along = dot(to, ray.direction);
    const Vec3d aside = to - along * ray.direction;
    const double rest = radius * radius - dot(aside, aside);
    if (rest <= 0) return false;
    const double half = std::sqrt(rest);
    enter = along - half;
    leave = along + half;
    return true;
}

bool meet_cylinder(const Ray& ray, const Shape& s, double nearest, double farthest, double& distance)
{
    const Vec3d from = ray.origin - s.centre;
    const double axial_step = dot(ray.direction, s.n), axial_start = dot(from, s.n);
    const Vec3d step = ray.direction - axial_step * s.n;
    const Vec3d start = from - axial_start * s.n;
    const double a = dot(step, step);
    if (a < 1e-18) return false;
    // Relative to the point of the ray nearest to the axis, so that no large numbers cancel.
    const double middle = -dot(start, step) / a;
    const Vec3d closest = start + middle * step;
    const double rest = s.radius * s.radius - dot(closest, closest);
    if (rest <= 0) return false;
    const double half = std::sqrt(rest / a);
    for (const double t : {middle - half, middle + half})
        if (t > nearest && t < farthest && std::abs(axial_start + t * axial_step) <= s.half_v) {
            distance = t;
            return true;
        }
    return false;
}

bool meet(const Ray& ray, const Shape& s, std::uint64_t index, double nearest, double farthest, double& distance)
{
    switch (s.kind) {
        case Shape::Kind::rectangle:
        case Shape::Kind::disc: {
            const double across = dot(ray.direction, s.n);
            if (across == 0) return false;
            const double t = dot(s.centre - ray.origin, s.n) / across;
            if (!(t > nearest && t < farthest)) return false;
            const Vec3d p = ray.origin + t * ray.direction - s.centre;
            const double a = dot(p, s.u), b = dot(p, s.v);
            if (s.kind == Shape::Kind::disc) {
                if (a * a + b * b > s.radius * s.radius) return false;
            } else if (std::abs(a) > s.half_u || b < -s.half_v ||
                       b > s.half_v + s.gable * (1 - std::abs(a) / s.half_u)) {
                return false;
            }
            distance = t;
            return true;
        }
        case Shape::Kind::cylinder:
            return meet_cylinder(ray, s, nearest, farthest, distance);
        case Shape::Kind::sphere: {
            double enter, leave;
            if (!meet_sphere(ray, s.centre, s.radius, enter, leave)) return false;
            for (const double t : {enter, leave})
                if (t > nearest && t < farthest && ray.origin[2] + t * ray.direction[2] >= s.lowest) {
                    distance = t;
                    return true;
                }
            return false;
        }
        case Shape::Kind::crown: {
            double enter, leave;
            if (!meet_sphere(ray, s.centre, s.radius, enter, leave)) return false;
            const double start = std::max(enter, nearest);
            const double t = start - logarithm(1 - to_unit(hash(ray.key, index))) / leaves_per_metre;
            if (!(t < leave && t < farthest)) return false;
            distance = t;
            return true;
        }
    }
    return false;
}

Vec3d normal_of(const Shape& s, const Vec3d& point, const Ray& ray)
{
    Vec3d normal = s.n;
    if (s.kind == Shape::Kind::cylinder) {
        const Vec3d from = point - s.centre;
        normal = unit(from - dot(from, s.n) * s.n);
    } else if (s.kind == Shape::Kind::sphere) {
        normal = unit(point - s.centre);
    } else if (s.kind == Shape::Kind::crown) {
        normal = -1.0 * ray.direction;
    }
    return dot(normal, ray.direction) > 0 ? -1.0 * normal : normal;
}

// The distance at which the ray enters the box; false when it misses the box or enters it beyond `farthest`.
bool meet_box(const Box3d& box, const Vec3d& origin, const Vec3d& inverse, double farthest, double& enter)
{
    enter = 0;
    double leave = farthest;
    for (std::size_t a = 0; a < 3; ++a) {
        const double one = (box.min[a] - origin[a]) * inverse[a];
        const double other = (box.max[a] - origin[a]) * inverse[a];
        enter = std::max(enter, std::min(one, other));
        leave = std::min(leave, std::max(one, other));
    }
    return enter <= leave;
}

constexpr std::size_t bin_count = 16;
struct Bin {
    Box3d box;
    std::size_t count = 0;
};

// The first bin of the right side of the cut with the minimum cost: sum over both sides of area times shapes.
std::size_t cheapest_cut(const std::array<Bin, bin_count>& bins, std::size_t shapes)
{
    std::array<double, bin_count> cost_above{};  // cost of the bins from here on
    Box3d box;
    std::size_t count = 0;
    for (std::size_t bin = bin_count - 1; bin > 0; --bin) {
        box.extend(bins[bin].box);
        count += bins[bin].count;
        cost_above[bin] = area(box) * static_cast<double>(count);
    }
    box = {};
    count = 0;
    double best_cost = std::numeric_limits<double>::infinity();
    std::size_t best = 1;
    for (std::size_t bin = 1; bin < bin_count; ++bin) {
        box.extend(bins[bin - 1].box);
        count += bins[bin - 1].count;
        const double cost = area(box) * static_cast<double>(count) + cost_above[bin];
        if (count && count < shapes && cost < best_cost) {
            best_cost = cost;
            best = bin;
        }
    }
    return best;
}

}  // namespace

RayCaster::RayCaster(const Site& site) : site_(site), order_(site.shapes.size())
{
    std::iota(order_.begin(), order_.end(), 0u);
    std::vector<Box3d> boxes;
    boxes.reserve(site.shapes.size());
    Node root;
    for (const Shape& shape : site.shapes) {
        boxes.push_back(shape.box());
        root.box.extend(boxes.back());
    }
    root.count = static_cast<std::uint32_t>(site.shapes.size());
    nodes_.push_back(root);
    if (root.count) split(0, boxes);
    shapes_.reserve(order_.size());
    for (const std::uint32_t i : order_) shapes_.push_back(site.shapes[i]);
}

// Surface area heuristic over equal bins of the longest axis (Wald 2007, On fast construction of SAH-based bounding
// volume hierarchies).
void RayCaster::split(std::uint32_t index, std::vector<Box3d>& boxes)
{
    const Node node = nodes_[index];
    if (node.count <= leaf_shapes) return;
    const auto begin = order_.begin() + node.first;
    const auto end = begin + node.count;

    Box3d centres;
    for (auto i = begin; i != end; ++i) centres.extend(boxes[*i].centre());
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (centres.extent(a) > centres.extent(axis)) axis = a;
    if (!(centres.extent(axis) > 1e-9)) return;  // all in one place: it stays a leaf
    const auto bin_of = [&](std::uint32_t i) {
        const double place = (boxes[i].centre()[axis] - centres.min[axis]) / centres.extent(axis);
        return std::min(bin_count - 1, static_cast<std::size_t>(place * bin_count));
    };
    std::array<Bin, bin_count> bins;
    for (auto i = begin; i != end; ++i) {
        Bin& bin = bins[bin_of(*i)];
        bin.box.extend(boxes[*i]);
        ++bin.count;
    }

    const std::size_t best = cheapest_cut(bins, node.count);
    const auto middle = std::stable_partition(begin, end, [&](std::uint32_t i) { return bin_of(i) < best; });
    const auto left = static_cast<std::uint32_t>(middle - begin);
    std::array<Node, 2> children;
    children[0].first = node.first;
    children[0].count = left;
    children[1].first = node.first + left;
    children[1].count = node.count - left;
    for (Node& child : children)
        for (std::uint32_t i = 0; i < child.count; ++i) child.box.extend(boxes[order_[child.first + i]]);
    const auto first_child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.insert(nodes_.end(), children.begin(), children.end());
    nodes_[index].first = first_child;
    nodes_[index].count = 0;
    split(first_child, boxes);
    split(first_child + 1, boxes);
}

// Marches along the ray in steps that cannot cross the ground: f(t), the height over the ground, decreases no faster
// than `approach`, and f(t + s) >= f + f' s - bend s^2 / 2, by the bounds Ground::steepest() and most_curved().
bool RayCaster::meet_ground(const Ray& ray, double nearest, double farthest, double& distance) const
{
    const double flat2 = ray.direction[0] * ray.direction[0] + ray.direction[1] * ray.direction[1];
    const double approach = site_.ground.steepest() * std::sqrt(flat2) - ray.direction[2];
    if (approach <= 0) return false;
    const double bend = site_.ground.most_curved() * flat2;
    double t = 0;
    for (int step = 0; step < 400; ++step) {
        const double x = ray.origin[0] + t * ray.direction[0], y = ray.origin[1] + t * ray.direction[1];
        if (x < 0 || y < 0 || x > site_.side || y > site_.side || t > farthest) return false;
        double slope_x, slope_y;
        const double above = ray.origin[2] + t * ray.direction[2] - site_.ground.height(x, y, slope_x, slope_y);
        const double sinking = slope_x * ray.direction[0] + slope_y * ray.direction[1] - ray.direction[2];
        if (above < 1e-4) {
            if (sinking > 0.01) t += above / sinking;  // a last Newton step, unless the ray grazes the ground
            if (t <= nearest || t >= farthest) return false;
            distance = t;
            return true;
        }
        const double root = std::sqrt(sinking * sinking + 2 * bend * above);
        const double curved_step = sinking > 0 ? 2 * above / (sinking + root) : (root - sinking) / (bend + 1e-12);
        t += std::max(curved_step, above / approach);
    }
    return false;  // grazes the ground
}

bool RayCaster::cast(const Ray& ray, double nearest, double farthest, Hit& hit) const
{
    double best = farthest;
    std::int64_t found = -1;
    bool any = meet_ground(ray, nearest, farthest, best);

    const Vec3d inverse{1 / ray.direction[0], 1 / ray.direction[1], 1 / ray.direction[2]};
    struct Waiting {
        std::uint32_t node;
        double enter;
    };
    std::array<Waiting, 128> stack;  // deeper trees would need more than 2^64 shapes or bins of one shape each
    std::size_t waiting = 0;
    double enter;
    if (meet_box(nodes_[0].box, ray.origin, inverse, best, enter)) stack[waiting++] = {0, enter};
    while (waiting) {
        const Waiting top = stack[--waiting];
        if (top.enter > best) continue;
        const Node& node = nodes_[top.node];
        if (node.count) {
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                double distance;
                if (meet(ray, shapes_[i], order_[i], nearest, best, distance)) {
                    best = distance;
                    found = i;
                    any = true;
                }
            }
            continue;
        }
        double enter_left, enter_right;
        const bool left = meet_box(nodes_[node.first].box, ray.origin, inverse, best, enter_left);
        const bool right = meet_box(nodes_[node.first + 1].box, ray.origin, inverse, best, enter_right);
        // The nearer child on top.
        if (left && right && enter_left < enter_right) {
            stack[waiting++] = {node.first + 1, enter_right};
            stack[waiting++] = {node.first, enter_left};
        } else {
            if (left) stack[waiting++] = {node.first, enter_left};
            if (right) stack[waiting++] = {node.first + 1, enter_right};
        }
    }
    if (!any) return false;
    hit.distance = best;
    const Vec3d point = ray.origin + best * ray.direction;
    if (found >= 0) {
        hit.shape = order_[static_cast<std::size_t>(found)];
        hit.normal = normal_of(shapes_[static_cast<std::size_t>(found)], point, ray);
    } else {
        hit.shape = -1;
        double slope_x, slope_y;
        site_.ground.height(point[0], point[1], slope_x, slope_y);
        hit.normal = unit({-slope_x, -slope_y, 1});
    }
    return true;
}

}  // namespace pcm::scene
