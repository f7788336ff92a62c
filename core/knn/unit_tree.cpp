#include "pcm/knn/unit_tree.h"

#include <algorithm>
#include <cmath>

namespace pcm {

// Divides points in the order of the tree's leaves.
template <class C>
class UnitTree<C>::Divider {
public:
    Divider(Point* points, Point* scratch, std::size_t size, const Vec3d& scale)
        : points_(points), scratch_(scratch), size_(size), scale_(scale)
    {
    }

    // The points of the leaves [first, last).
    void divide(std::size_t first, std::size_t last)
    {
        while (last - first > 1) {
            const std::size_t middle = first + (last - first) / 2;
            Point* begin = points_ + first * leaf_points;
            Point* end = points_ + std::min(size_, last * leaf_points);
            Point* cut = points_ + middle * leaf_points;
            switch (longest_axis(begin, end)) {
                case 0:
                    select<0>(begin, cut, end);
                    break;
                case 1:
                    select<1>(begin, cut, end);
                    break;
                default:
                    select<2>(begin, cut, end);
            }
            divide(first, middle);
            first = middle;
        }
    }

private:
    int longest_axis(const Point* begin, const Point* end) const
    {
        C low[3], high[3];
        for (int axis = 0; axis < 3; ++axis) low[axis] = high[axis] = begin->at[axis];
        // A sample of a large set is enough: the axis need not be the very longest.
        const std::ptrdiff_t step = std::max<std::ptrdiff_t>(1, (end - begin) / 512);
        for (const Point* p = begin; end - p > 0; p += step)
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], p->at[axis]);
                high[axis] = std::max(high[axis], p->at[axis]);
            }
        int longest = 0;
        double most = -1;
        for (int axis = 0; axis < 3; ++axis) {
            const double extent = (static_cast<double>(high[axis]) - static_cast<double>(low[axis])) *
                                  scale_[static_cast<std::size_t>(axis)];
            if (extent > most) most = extent, longest = axis;
        }
        return longest;
    }

    // Puts the points in order so that none before `cut` is above *cut along the axis, and none after it is below.
    template <int axis>
    void select(Point* begin, Point* cut, Point* end) const
    {
        for (int pass = 0; end - begin > few_points && pass < most_passes; ++pass) {
            const C pivot = pivot_near<axis>(begin, cut, end);
            Point* middle = part(begin, end, [pivot](const Point& p) { return p.at[axis] < pivot; });
            if (cut < middle) {
                end = middle;
                continue;
            }
            if (begin == middle) {  // the pivot is the lowest
                middle = part(begin, end, [pivot](const Point& p) { return p.at[axis] <= pivot; });
                if (cut < middle) return;
            }
            begin = middle;
        }
        if (begin < end)
            std::nth_element(begin, cut, end, [](const Point& a, const Point& b) { return a.at[axis] < b.at[axis]; });
    }

    // A coordinate such that few points lie between it and that of the cut: out of a sample, a little on the side of
    // the cut on which more points are.
    template <int axis>
    static C pivot_near(const Point* begin, const Point* cut, const Point* end)
    {
        constexpr std::ptrdiff_t most = 255;
        const std::ptrdiff_t size = end - begin, count = size < 1024 ? 15 : (size < 32768 ? 63 : most);
        C sample[most];
        std::uint32_t random = static_cast<std::uint32_t>(size);
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            random = random * 1664525 + 1013904223;
            sample[i] = begin[size * i / count + static_cast<std::ptrdiff_t>((random >> 8) % (size / count))].at[axis];
        }
        const double share = static_cast<double>(cut - begin) / static_cast<double>(size);
        const double rank = share * static_cast<double>(count);
        const double spread = std::sqrt(rank * (1 - share));
        const double wanted = share < 0.6 ? rank + spread : rank - spread;
        const auto at = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(wanted), 0, count - 1);
        std::nth_element(sample, sample + at, sample + count);
        return sample[at];
    }

    // std::partition without branches that depend on the points.
    template <class Before>
    Point* part(Point* begin, Point* end, Before before) const
    {
        Point *middle = begin, *other = scratch_;
        for (const Point* p = begin; p != end; ++p) {
            const Point point = *p;
            const bool first = before(point);
            *middle = point;
            *other = point;
            middle += first;
            other += !first;
        }
        std::copy(static_cast<const Point*>(scratch_), static_cast<const Point*>(other), middle);
        return middle;
    }

    static constexpr std::ptrdiff_t few_points = 96;
    static constexpr int most_passes = 40;

    Point* points_;
    Point* scratch_;  // as many
    std::size_t size_;
    Vec3d scale_;
};

template <class C>
UnitTree<C>::UnitTree(std::vector<TreePoint<C>> points, const Vec3d& scale, const Vec3d& sides)
{
    const std::size_t size = points.size();
    view_.points = size;
    view_.leaves = static_cast<std::uint32_t>((size + leaf_points - 1) / leaf_points);
    {
        AlignedArray<Point> scratch(size);
        Divider(points.data(), scratch.data(), size, scale).divide(0, view_.leaves);
    }
    take_leaves(points);
    boxes_ = AlignedArray<C>(6 * (std::size_t(2) * view_.leaves - 1));
    find_boxes(0, 0, view_.leaves);
    view_.boxes = boxes_.data();
    set_units(scale, sides);
}

template <class C>
void UnitTree<C>::take_leaves(const std::vector<Point>& points)
{
    const std::size_t slots = std::size_t(view_.leaves) * leaf_points;
    blocks_ = AlignedArray<C>(3 * slots);
    ids_ = AlignedArray<std::uint32_t>(slots);
    for (std::size_t i = 0; i < slots; ++i) {
        const Point& point = points[std::min(i, points.size() - 1)];
        C* block = blocks_.data() + i / leaf_points * (3 * leaf_points) + i % leaf_points;
        for (std::size_t axis = 0; axis < 3; ++axis) block[axis * leaf_points] = point.at[axis];
        ids_[i] = point.id;
    }
    view_.blocks = blocks_.data();
    view_.ids = ids_.data();
}

template <class C>
void UnitTree<C>::find_boxes(std::uint32_t node, std::uint32_t first, std::uint32_t last)
{
    C* box = boxes_.data() + std::size_t(6) * node;
    if (last - first == 1) {
        const C* block = leaf(first);
        for (int axis = 0; axis < 3; ++axis, block += leaf_points) {
            box[axis] = *std::min_element(block, block + leaf_points);
            box[axis + 3] = *std::max_element(block, block + leaf_points);
        }
        return;
    }
    const std::uint32_t half = (last - first) / 2;
    find_boxes(node + 1, first, first + half);
    find_boxes(node + 2 * half, first + half, last);
    const C* left = box + 6;
    const C* right = boxes_.data() + std::size_t(6) * (node + 2 * half);
    for (int axis = 0; axis < 3; ++axis) {
        box[axis] = std::min(left[axis], right[axis]);
        box[axis + 3] = std::max(left[axis + 3], right[axis + 3]);
    }
}

// Where the scales differ the working unit is such that the longest side of the box is 2^60 of them: single precision
// then holds the squares of all distances down to 2^-120 of it.
template <class C>
void UnitTree<C>::set_units(const Vec3d& scale, const Vec3d& sides)
{
    view_.equal_scales = scale[0] == scale[1] && scale[1] == scale[2];
    double longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) longest = std::max(longest, sides[axis] * scale[axis]);
    if (view_.equal_scales || longest == 0)
        view_.working_unit = scale[0];
    else
        view_.working_unit = std::ldexp(longest, -60);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        view_.scale[axis] = scale[axis];
        // All offsets along a side of length 0 are 0; the quotient might be infinite.
        if (!view_.equal_scales)
            view_.ratio[axis] = sides[axis] > 0 ? static_cast<float>(scale[axis] / view_.working_unit) : 0;
    }
}

template class UnitTree<std::int32_t>;
template class UnitTree<std::int64_t>;

}  // namespace pcm
