// A grid of square cells in plan over a polygon.
#pragma once

#include "pcm/measure/polygon.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// Cell (0, 0) begins at the minimum x and y of the polygon; rows ascend with y. Immutable; any number of threads.
class CellGrid {
public:
    // `side` > 0; a polygon that does not cross itself. Memory: 9 bytes per cell. Throws Error(invalid_argument) when
    // there would be more than 2^31 cells in a row or a column; cells_of() says how many there would be.
    CellGrid(const std::vector<Vec2d>& polygon, double side);
    static double cells_of(const std::vector<Vec2d>& polygon, double side);

    std::size_t columns() const { return columns_; }
    std::size_t rows() const { return rows_; }
    std::size_t size() const { return columns_ * rows_; }
    double side() const { return side_; }
    // Area of the polygon in each cell; 0: none. They add up to the polygon's area.
    double area(std::size_t cell) const { return areas_[cell]; }
    // The cell of a point of the polygon; size() for a point outside of it.
    std::size_t cell_of(double x, double y) const;

private:
    enum class Kind : std::uint8_t { outside, inside, edge };
    void mark_edges();
    void find_areas();
    std::size_t index_along(double distance, std::size_t count) const;

    std::vector<Vec2d> polygon_;  // relative to origin_
    std::optional<Polygon> inside_;
    Vec2d origin_{};
    double side_;
    std::size_t columns_ = 0, rows_ = 0;
    std::vector<Kind> kinds_;
    std::vector<double> areas_;
};

}  // namespace pcm
