#include "tree/poisson_pass.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

// Bounds of boxes are computed with rounding; they decide only where they do so by more than this.
constexpr double margin = 1e-9;
constexpr std::size_t few_points = 6;  // tested one by one

// As ==, which calls memcmp.
template <class Coord>
bool same(const Point<Coord>& p, const Point<Coord>& q)
{
    return !((p[0] ^ q[0]) | (p[1] ^ q[1]) | (p[2] ^ q[2]));
}

}  // namespace

template <class Coord>
PoissonPass<Coord>::PoissonPass(typename SortedPoints<Coord>::Reader& points, const Lattice& lattice, int size,
                                const std::vector<Point<Coord>>& chosen)
    : points_(points), lattice_(lattice), size_(size), cell_(lattice.shifts(size)), bucket_(lattice.shifts(size + 2)),
      table_(std::size_t(1) << table_bits_)
{
    const double spacing = lattice.spacing(size);
    squared_spacing_ = spacing * spacing;
    for (std::size_t a = 0; a < 3; ++a) squared_scale_[a] = lattice.scale[a] * lattice.scale[a];
    exact_ = sizeof(Coord) == 4 || *std::max_element(bucket_.begin(), bucket_.end()) <= 50;
    for (const Point<Coord>& p : chosen) add(p);
}

template <class Coord>
Point<Coord> PoissonPass<Coord>::bucket_of(const Point<Coord>& p) const
{
    Point<Coord> bucket;
    for (std::size_t a = 0; a < 3; ++a) bucket[a] = static_cast<Coord>(static_cast<std::uint64_t>(p[a]) >> bucket_[a]);
    return bucket;
}

template <class Coord>
std::uint64_t PoissonPass<Coord>::bit_of(const Point<Coord>& p) const
{
    std::uint64_t cell = 0;
    for (std::size_t a = 0; a < 3; ++a) cell |= (static_cast<std::uint64_t>(p[a]) >> cell_[a] & 3) << (2 * a);
    return std::uint64_t(1) << cell;
}

template <class Coord>
std::size_t PoissonPass<Coord>::slot(const Point<Coord>& bucket) const
{
    // Odd multipliers from the digits of the golden ratio's and the plastic number's powers.
    const std::uint64_t hash = static_cast<std::uint64_t>(bucket[0]) * 0x9E3779B97F4A7C15u +
                               static_cast<std::uint64_t>(bucket[1]) * 0xC2B2AE3D27D4EB4Fu +
                               static_cast<std::uint64_t>(bucket[2]) * 0x165667B19E3779F9u;
    std::size_t i = (hash ^ hash >> 29) * 0x9E3779B97F4A7C15u >> (64 - table_bits_);
    while (table_[i].head != none && !same(table_[i].at, bucket)) i = (i + 1) & (table_.size() - 1);
    return i;
}

template <class Coord>
void PoissonPass<Coord>::grow()
{
    std::vector<Bucket> old(table_.size() * 2);
    old.swap(table_);
    ++table_bits_;
    for (const Bucket& bucket : old)
        if (bucket.head != none) table_[slot(bucket.at)] = bucket;
}

template <class Coord>
void PoissonPass<Coord>::add(const Point<Coord>& p)
{
    const Point<Coord> at = bucket_of(p);
    std::size_t i = slot(at);
    if (table_[i].head == none) {
        if (2 * ++used_ > table_.size()) {
            grow();
            i = slot(at);
        }
        table_[i].at = at;
    }
    table_[i].taken |= bit_of(p);
    chosen_.push_back({p, table_[i].head});
    table_[i].head = static_cast<std::uint32_t>(chosen_.size() - 1);
}

template <class Coord>
Vec3d PoissonPass<Coord>::relative(const Point<Coord>& p) const
{
    Vec3d at;
    for (std::size_t a = 0; a < 3; ++a)
        at[a] = p[a] >= origin_[a] ? static_cast<double>(p[a] - origin_[a]) : -static_cast<double>(origin_[a] - p[a]);
    return at;
}

template <class Coord>
void PoissonPass<Coord>::gather(const Point<Coord>& bucket)
{
    near_.clear();
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                const Point<Coord> at{static_cast<Coord>(bucket[0] + static_cast<Coord>(x)),
                                      static_cast<Coord>(bucket[1] + static_cast<Coord>(y)),
                                      static_cast<Coord>(bucket[2] + static_cast<Coord>(z))};
                for (std::uint32_t n = table_[slot(at)].head; n != none; n = chosen_[n].next) near_.push_back(near(n));
            }
}

template <class Coord>
bool PoissonPass<Coord>::covered(const Point<Coord>& p, const Vec3d& at, const Near* from, std::size_t count) const
{
    for (std::size_t n = 0; n < count; ++n) {
        if (!exact_) {
            if (squared_distance(p, chosen_[from[n].chosen].point, squared_scale_) < squared_spacing_) return true;
            continue;
        }
        // Differences of exact numbers: the same value as squared_distance().
        const double x = at[0] - from[n].at[0], y = at[1] - from[n].at[1], z = at[2] - from[n].at[2];
        if (x * x * squared_scale_[0] + y * y * squared_scale_[1] + z * z * squared_scale_[2] < squared_spacing_) return true;
    }
    return false;
}

template <class Coord>
std::size_t PoissonPass<Coord>::first_free(std::size_t i, std::size_t end) const
{
    if (barred_)
        while (i < end && barred_[i] <= size_) ++i;
    return i;
}

template <class Coord>
std::size_t PoissonPass<Coord>::first_uncovered(std::size_t i, std::size_t end, int size, std::size_t from, std::size_t count)
{
    if (count == 0) return first_free(i, end);
    if (end - i <= few_points || size == 0) {
        Point<Coord> last{};
        bool tested = false;
        for (; i < end; ++i) {
            const Point<Coord>& p = points_[i];
            if (tested && same(p, last)) continue;
            if (barred_ && barred_[i] <= size_) continue;
            if (!covered(p, relative(p), near_.data() + from, count)) return i;
            last = p;
            tested = true;
        }
        return end;
    }
    // The cell's box; of a chosen point, how near and how far its points can be.
    std::array<int, 3> shifts = lattice_.shifts(size);
    Point<Coord> corner = points_[i];
    for (std::size_t a = 0; a < 3; ++a)
        corner[a] = static_cast<Coord>(static_cast<std::uint64_t>(corner[a]) >> shifts[a] << shifts[a]);
    const Vec3d low = relative(corner);
    Vec3d high;
    for (std::size_t a = 0; a < 3; ++a) high[a] = low[a] + std::ldexp(1.0, shifts[a]) - 1;
    const std::size_t kept = near_.size();
    for (std::size_t n = from; n < from + count; ++n) {
        double nearest = 0, farthest = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const double below = low[a] - near_[n].at[a], above = near_[n].at[a] - high[a];
            const double gap = std::max(0.0, std::max(below, above));
            const double reach = std::max(std::fabs(below), std::fabs(above));
            nearest += gap * gap * squared_scale_[a];
            farthest += reach * reach * squared_scale_[a];
        }
        if (farthest * (1 + margin) < squared_spacing_) {
            near_.resize(kept);
            return end;
        }
        if (nearest * (1 - margin) < squared_spacing_) {
            const Near keep = near_[n];
            near_.push_back(keep);
        }
    }
    const std::size_t left = near_.size() - kept;
    std::size_t found = end;
    if (left == 0) {
        found = first_free(i, end);
    } else {
        shifts = lattice_.shifts(size - 1);
        while (i < end) {
            const std::size_t part = points_.end_of_cell(i, end, shifts);
            found = first_uncovered(i, part, size - 1, kept, left);
            if (found < part) break;
            i = part;
            found = end;
        }
    }
    near_.resize(kept);
    return found;
}

template <class Coord>
std::vector<std::uint32_t> PoissonPass<Coord>::run(const std::vector<std::uint8_t>& barred)
{
    barred_ = barred.empty() ? nullptr : barred.data();
    std::vector<std::uint32_t> found;
    const std::size_t count = points_.size();
    for (std::size_t i = 0; i < count;) {
        const std::size_t end = points_.end_of_cell(i, count, bucket_);
        const Point<Coord> bucket = bucket_of(points_[i]);
        const std::size_t at = slot(bucket);
        std::uint64_t taken = table_[at].head == none ? 0 : table_[at].taken;
        bool gathered = false;
        while (i < end) {
            const Point<Coord> p = points_[i];
            const std::size_t next = points_.end_of_cell(i, end, cell_);
            if (!(taken & bit_of(p))) {
                if (!gathered) {
                    for (std::size_t a = 0; a < 3; ++a)
                        origin_[a] = static_cast<Coord>(static_cast<std::uint64_t>(p[a]) >> bucket_[a] << bucket_[a]);
                    gather(bucket);
                    gathered = true;
                }
                const std::size_t first = first_uncovered(i, next, size_, 0, near_.size());
                if (first < next) {
                    found.push_back(static_cast<std::uint32_t>(first));
                    taken |= bit_of(p);
                    add(points_[first]);
                    near_.push_back(near(static_cast<std::uint32_t>(chosen_.size() - 1)));
                }
            }
            i = next;
        }
    }
    return found;
}

template <class Coord>
void PoissonPass<Coord>::mark(std::vector<std::uint8_t>& barred)
{
    const std::size_t count = points_.size();
    for (std::size_t i = 0; i < count;) {
        const std::size_t end = points_.end_of_cell(i, count, bucket_);
        for (std::size_t a = 0; a < 3; ++a)
            origin_[a] = static_cast<Coord>(static_cast<std::uint64_t>(points_[i][a]) >> bucket_[a] << bucket_[a]);
        gather(bucket_of(points_[i]));
        if (!near_.empty())
            for (; i < end; ++i)
                if (covered(points_[i], relative(points_[i]), near_.data(), near_.size())) barred[i] = static_cast<std::uint8_t>(size_);
        i = end;
    }
}

template <class Coord>
PointsNear<Coord>::PointsNear(typename SortedPoints<Coord>::Reader& points, const Lattice& lattice, int size)
    : bucket_(lattice.shifts(size + 2))
{
    for (std::size_t i = 0; i < points.size(); i = points.end_of_cell(i, points.size(), bucket_)) {
        Point<Coord> at = points[i];
        for (std::size_t a = 0; a < 3; ++a) at[a] = static_cast<Coord>(static_cast<std::uint64_t>(at[a]) >> bucket_[a]);
        buckets_.push_back(at);
    }
}

template <class Coord>
bool PointsNear<Coord>::operator()(const Point<Coord>& p) const
{
    for (int n = 0; n < 27; ++n) {
        const std::array<int, 3> step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        Point<Coord> at = p;
        for (std::size_t a = 0; a < 3; ++a)
            at[a] = static_cast<Coord>((static_cast<std::uint64_t>(at[a]) >> bucket_[a]) + static_cast<std::uint64_t>(step[a]));
        if (std::binary_search(buckets_.begin(), buckets_.end(), at,
                               [](const auto& a, const auto& b) { return morton_before(a, b, AxisShift{0, 0, 0}); }))
            return true;
    }
    return false;
}

template class PoissonPass<std::uint32_t>;
template class PoissonPass<std::uint64_t>;
template class PointsNear<std::uint32_t>;
template class PointsNear<std::uint64_t>;

}  // namespace pcm
