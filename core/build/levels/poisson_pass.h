// One pass of sampling: adds points to those already chosen until every point of a bin has a chosen one nearer than the
// spacing, while no two chosen ones are nearer than it: a maximal Poisson-disk sample that contains a given one.
//
// The method is that of dart throwing on a background grid (Cook 1986; Ebeida et al. 2011 for maximality), with points
// for darts and Morton order for their order: a cell's diagonal is the spacing, so a cell holds at most one chosen
// point, and one that does holds no uncovered point; of any other cell the first uncovered point in Morton order is
// chosen. A cell that is inside a ball around a chosen point is classified as covered as a whole, others are halved.
//
// Covered means squared_distance < spacing², evaluated in double, so the distances of a sample are exact. Distances are
// computed in float first, which decides where the result is clear beyond its error.
//
// Cells are grouped twice. A bucket is at least as wide as the spacing, so that all points near a point are in its
// bucket or in one of the 26 around it; a block is 32 x 32 x 32 cells. A hash table knows the blocks that hold chosen
// points. The chosen points in and around the current block are put into an array of buckets, small enough for the
// first-level cache.
#pragma once

#include "pcm/build/levels/poisson_loops.h"
#include "pcm/build/levels/sorted_points.h"

#include <cstdint>
#include <vector>

namespace pcm {

template <class Coord>
class PoissonPass {
public:
    // `own`: indices of the bin's points that are already chosen, ascending. `others`: every point of other bins chosen
    // so far that is nearer than the spacing to some point of the bin (more do no harm).
    PoissonPass(typename SortedPoints<Coord>::Reader& points, const Lattice& lattice, int size,
                const std::vector<std::uint32_t>& own, const std::vector<Point<Coord>>& others);

    // Indices of the points that this pass chooses, ascending. Where `barred` is not empty it has for each point the
    // smallest size that may not choose it, nor may any larger one: such points are left out, covered or not.
    std::vector<std::uint32_t> run(const std::vector<std::uint8_t>& barred);

    // Instead of run(): sets `barred` of the covered points to this size.
    void mark(std::vector<std::uint8_t>& barred);

private:
    static constexpr std::uint32_t none = 0xffffffffu;
    static constexpr int block_bits = 5;  // a block is 2^block_bits cells wide
    static constexpr std::size_t side =
        18;  // buckets along an axis of the array: a block's 16 at most, and one more on either side
    struct Chosen {
        Point<Coord> point;
        std::uint32_t next;  // next chosen point of its block
    };
    struct Block {
        Point<Coord> at{};
        // Its chosen points, two lists: in the outer buckets, which the blocks around look at, and in the others. Both
        // none: the slot is not in use.
        std::uint32_t rim = none, core = none;
        bool used() const { return rim != none || core != none; }
    };
    struct Local {  // a chosen point in or around the current block, in spacings from its corner
        float x, y, z;
        std::uint32_t chosen, next;  // next of its bucket
    };
    struct NearPoints {  // the points near the current bucket, then subsets of them, each padded to a multiple of four
        std::vector<float> x, y, z;
        std::vector<std::uint32_t> chosen;
        std::size_t size = 0;
        void make_room(std::size_t more);  // for add() and fill()
        void add(float px, float py, float pz, std::uint32_t n)
        {
            x[size] = px;
            y[size] = py;
            z[size] = pz;
            chosen[size++] = n;
        }
        void fill(std::size_t multiple);  // pads with points far away
    };
    struct Range {  // part of a NearPoints
        std::size_t from, to;
    };

    std::size_t slot(const Point<Coord>& block) const;
    void grow();
    std::uint32_t add(const Point<Coord>& p);
    float relative(Coord c, std::size_t axis) const;
    void enter_block(const Point<Coord>& p);
    void add_local(std::uint32_t chosen);
    std::size_t cell_at(const Point<Coord>& p) const;
    Range gather(std::size_t cell);
    bool covered(const Point<Coord>& p, Range near);
    void choose_by_cells(std::size_t i, std::size_t end);
    void choose_by_points(std::size_t i, std::size_t end);
    void choose(std::size_t i, std::size_t cell, Range& near);
    void place(std::size_t first, std::size_t count);
    std::size_t first_free(std::size_t i, std::size_t end) const;
    // The first point of [i, end), all of one cell of `size`, that none of `near` covers and none bars; `end` if none.
    std::size_t first_uncovered(std::size_t i, std::size_t end, int size, Range near);

    typename SortedPoints<Coord>::Reader& points_;
    const Lattice& lattice_;
    const int size_;
    const int bucket_bits_;  // a bucket is 2^bucket_bits cells wide, 1 or 2
    const std::vector<std::uint32_t>& own_;
    Vec3d squared_scale_, unit_;  // unit: spacings per grid step
    double squared_spacing_;
    std::array<int, 3> cell_, bucket_, block_;
    std::vector<Chosen> chosen_;
    int table_bits_ = 6;
    std::vector<Block> table_;  // 2^table_bits_
    std::size_t used_ = 0, last_slot_ = 0;
    const std::uint8_t* barred_ = nullptr;

    // State of the current block.
    Point<Coord> origin_{};
    std::vector<Local> local_;
    std::array<std::uint32_t, side * side * side> heads_;  // first of each bucket; valid only where rows_ has a bit
    std::array<std::uint32_t, side * side> rows_;  // rows of buckets along x, one bit per bucket: holds a chosen point
    std::vector<std::uint64_t> taken_;             // one bit per cell: holds a chosen point
    std::size_t bucket_mask_;                      // from a cell's index to its bucket
    NearPoints near_;
    std::size_t hint_ = 0;  // the four that covered the last point
    std::array<std::size_t, 27> bucket_steps_;
    const PoissonLoops& loops_;
    PlacedPoints placed_;
    std::vector<std::uint32_t> found_;
};

extern template class PoissonPass<std::uint32_t>;
extern template class PoissonPass<std::uint64_t>;

}  // namespace pcm
