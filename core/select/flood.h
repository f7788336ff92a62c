// A flood over points in memory: those that steps no longer than a distance reach.
#pragma once

#include "pcm/cloud/geometry.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// Points are sorted into cubes. Where the distance is long enough relative to the box, the diagonal of a cube is just
// below the distance: then all points of a cube are reached with the first one, and only pairs of cubes are compared.
// One thread. Memory: about 80 bytes per point, the points included.
class Flood {
public:
    // `box` is around all points; distance > 0.
    Flood(std::vector<Vec3d> points, const Box3d& box, double distance);

    // Point i is reached.
    void reach(std::size_t i);
    // A reached point that is not one of these, anywhere: those within the distance are reached.
    void reach_from(const Vec3d& p);
    // Reaches all that can be reached.
    void run();

    bool reached(std::size_t i) const { return reached_[i] != 0; }
    const Vec3d& point(std::size_t i) const { return points_[i]; }

private:
    struct Cell {
        std::uint64_t key;
        std::uint32_t begin, end;  // range in order_
        std::uint32_t open;        // order_[begin, open): points that are not reached
        Box3d box;                 // tight
    };
    // Cells that differ in x alone: they follow each other.
    struct Row {
        std::uint64_t key;
        std::uint32_t begin, end;  // range in cells_
    };
    using Index = std::array<std::int64_t, 3>;
    Index index_of(const Vec3d& p) const;
    void make_cells();
    template <class Visit>
    void for_each_open_near(const Vec3d& low, const Vec3d& high, const Visit& visit);
    bool near(const Vec3d& p, const Vec3d& q) const { return squared_distance(p, q) <= square_; }
    bool may_be_near(const Vec3d& p, const Box3d& box) const;
    void reach_all(Cell& cell);
    void spread_from(const Vec3d& p, Cell& cell);
    void spread_from(const Cell& from, Cell& cell);

    std::vector<Vec3d> points_;
    const Vec3d origin_;
    const double distance_, square_;
    double edge_ = 0;
    bool whole_cells_ = false;  // a cell is reached as a whole
    Index most_{};              // the largest index on each axis
    std::vector<Cell> cells_;   // ascending by key
    std::vector<Row> rows_;     // ascending by key
    std::vector<std::uint32_t> order_;
    std::vector<std::uint8_t> reached_;
    std::vector<std::uint32_t> next_;  // reached, not spread from: points, or cells that are reached as a whole
    std::vector<std::uint32_t> cell_of_;
};

}  // namespace pcm
