// The tree that unit_kernel.h searches: its memory, and how it is made.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/knn/unit_kernel.h"

#include <cstdint>
#include <memory>
#include <new>
#include <vector>

namespace pcm {

// Memory for vectors: aligned to 64 bytes, not initialised.
template <class T>
class AlignedArray {
public:
    AlignedArray() = default;
    explicit AlignedArray(std::size_t size) : data_(static_cast<T*>(::operator new(size * sizeof(T), alignment))) {}
    T* data() { return data_.get(); }
    const T* data() const { return data_.get(); }
    T& operator[](std::size_t i) { return data_.get()[i]; }
    const T& operator[](std::size_t i) const { return data_.get()[i]; }

private:
    static constexpr std::align_val_t alignment{64};
    struct Free {
        void operator()(T* p) const { ::operator delete(p, alignment); }
    };
    std::unique_ptr<T, Free> data_;
};

// A position in grid steps, and what it is called outside of the tree.
template <class C>
struct TreePoint {
    C at[3];
    std::uint32_t id;
};

// C: std::int32_t or std::int64_t. It is read by any number of threads.
template <class C>
class UnitTree {
public:
    // At least one point, fewer than 2^32 - 64. The differences of the positions fit C. scale: source units per step.
    // sides: in steps, of a box that holds the points and all queries.
    UnitTree(std::vector<TreePoint<C>> points, const Vec3d& scale, const Vec3d& sides);

    const LeafTree<C>& view() const { return view_; }
    const C* leaf(std::uint32_t leaf) const { return view_.blocks + std::size_t(3) * leaf_points * leaf; }
    std::uint32_t points_in(std::uint32_t leaf) const
    {
        return leaf + 1 < view_.leaves ? leaf_points
                                       : static_cast<std::uint32_t>(view_.points - std::uint64_t(leaf) * leaf_points);
    }

private:
    using Point = TreePoint<C>;
    class Divider;
    void take_leaves(const std::vector<Point>& points);
    void find_boxes(std::uint32_t node, std::uint32_t first, std::uint32_t last);
    void set_units(const Vec3d& scale, const Vec3d& sides);

    AlignedArray<C> blocks_;
    AlignedArray<std::uint32_t> ids_;
    AlignedArray<C> boxes_;
    LeafTree<C> view_;
};

extern template class UnitTree<std::int32_t>;
extern template class UnitTree<std::int64_t>;

}  // namespace pcm
