// A grid of heights some of which are not known: the plane through them, Laplace's equation, and what is around gaps.
// For gap_filling.cpp, whose header says what for.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace pcm::cells {

// Called several times a second by the thread that works; may throw. May be empty.
using Check = std::function<void()>;

// A grid of heights; NaN: not known.
struct Field {
    std::vector<double> height, area;
    std::size_t columns = 0;

    std::size_t rows() const { return columns ? height.size() / columns : 0; }
    bool known(std::size_t cell) const { return area[cell] > 0 && !std::isnan(height[cell]); }
    bool gap(std::size_t cell) const { return area[cell] > 0 && std::isnan(height[cell]); }
};

// z = a + b (column - x0) + c (row - y0).
struct CellPlane {
    double x0 = 0, y0 = 0, a = 0, b = 0, c = 0;
    double at(std::size_t cell, std::size_t columns) const
    {
        return a + b * (static_cast<double>(cell % columns) - x0) + c * (static_cast<double>(cell / columns) - y0);
    }
};

// Slopes are drawn towards 0 as by the unevenness of one cell's width: they stay finite for cells on a line.
CellPlane plane_through(const Field& field);

// Cells of two by two as one: the mean of the known ones.
Field coarser(const Field& fine);
// Laplace's equation in the gaps; fill() takes the plane away first.
void solve_laplace(Field& field, const Check& check);
void fill(Field& field, const Check& check);

struct Gaps {
    std::vector<std::uint32_t> width;
    std::vector<std::uint8_t> outer;
    std::vector<float> jump2;  // D^2
};
// For each gap cell the nearest known cells along its row and its column. Where both sides of one of them have known
// cells, the narrower one is the gap's width. Cells within `reach` of known ones count as known.
Gaps look_around(const Field& field, std::size_t reach);
// Cells narrower than the points are apart: gaps of that width are not holes in the cloud. How far a known cell usually
// is from the next one, less the one step that neighbours are apart; 0 where cells have about a point each.
std::size_t usual_reach(const Field& field);

}  // namespace pcm::cells
