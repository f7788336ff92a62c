// One pass of sampling: to the points that are chosen already, further ones are added until every point of a bin has one
// nearer than the spacing, while no two are nearer than it: a maximal Poisson-disk sample that contains a given one.
//
// The method is that of dart throwing on a background grid (Cook 1986; Ebeida et al. 2011 for maximality), with points for
// darts and Morton order for their order: a cell's diagonal is the spacing, so a cell holds at most one chosen point, and one
// that does holds no uncovered point; of any other cell the first uncovered point in Morton order is chosen. Cells are told
// covered as a whole, or halved, where a ball around a chosen point contains them.
//
// Covered means squared_distance < spacing², evaluated in double; so the distances of a sample are exact, not nearly right.
#pragma once

#include "tree/sorted_points.h"

#include <cstdint>
#include <vector>

namespace pcm {

template <class Coord>
class PoissonPass {
public:
    // `chosen`: every point chosen so far that is nearer than the spacing to some point of the bin (others do no harm).
    PoissonPass(typename SortedPoints<Coord>::Reader& points, const Lattice& lattice, int size,
                const std::vector<Point<Coord>>& chosen);

    // Indices of the points that are chosen now, rising. Where `barred` is not empty it says of each point the smallest size
    // that may not choose it, as may no larger one: such points are left out, covered or not.
    std::vector<std::uint32_t> run(const std::vector<std::uint8_t>& barred);

    // Instead of run(): sets to this size what the points that are covered have in `barred`.
    void mark(std::vector<std::uint8_t>& barred);

private:
    static constexpr std::uint32_t none = 0xffffffffu;
    struct Bucket {  // 4 x 4 x 4 cells
        Point<Coord> at{};
        std::uint32_t head = none;  // its chosen points, a list; none: the bucket is not in use
        std::uint64_t taken = 0;    // cells that hold one
    };
    struct Chosen {
        Point<Coord> point;
        std::uint32_t next;
    };
    struct Near {  // a chosen point, relative to the bucket at hand, in grid steps
        Vec3d at;
        std::uint32_t chosen;
    };

    std::size_t slot(const Point<Coord>& bucket) const;
    Point<Coord> bucket_of(const Point<Coord>& p) const;
    std::uint64_t bit_of(const Point<Coord>& p) const;
    void add(const Point<Coord>& p);
    void grow();
    Vec3d relative(const Point<Coord>& p) const;
    Near near(std::uint32_t chosen) const { return {relative(chosen_[chosen].point), chosen}; }
    void gather(const Point<Coord>& bucket);
    bool covered(const Point<Coord>& p, const Vec3d& at, const Near* from, std::size_t count) const;
    // The first point of [i, end), all of one cell of `size`, that none of near_[from .. from + count) covers; `end` if none.
    std::size_t first_free(std::size_t i, std::size_t end) const;
    std::size_t first_uncovered(std::size_t i, std::size_t end, int size, std::size_t from, std::size_t count);

    typename SortedPoints<Coord>::Reader& points_;
    const Lattice& lattice_;
    const int size_;
    Vec3d squared_scale_;
    double squared_spacing_;
    std::array<int, 3> cell_, bucket_;
    bool exact_;  // coordinates relative to a bucket are exact in double
    std::vector<Chosen> chosen_;
    int table_bits_ = 6;
    std::vector<Bucket> table_;  // 2^table_bits_
    std::size_t used_ = 0;
    Point<Coord> origin_{};
    std::vector<Near> near_;
    const std::uint8_t* barred_ = nullptr;
};

// Whether the bin has points in the bucket of a point or in one beside it, which is where all are that are nearer than the
// spacing.
template <class Coord>
class PointsNear {
public:
    PointsNear(typename SortedPoints<Coord>::Reader& points, const Lattice& lattice, int size);
    bool operator()(const Point<Coord>& p) const;

private:
    std::array<int, 3> bucket_;
    std::vector<Point<Coord>> buckets_;  // in Morton order
};

extern template class PoissonPass<std::uint32_t>;
extern template class PoissonPass<std::uint64_t>;
extern template class PointsNear<std::uint32_t>;
extern template class PointsNear<std::uint64_t>;

}  // namespace pcm
