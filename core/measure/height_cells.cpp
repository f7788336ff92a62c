#include "pcm/measure/height_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {

void HeightCell::add(double height)
{
    ++points;
    lowest = points == 1 ? height : std::min(lowest, height);
    highest = points == 1 ? height : std::max(highest, height);
    const double off = height - mean;
    mean += off / static_cast<double>(points);
    squares += off * (height - mean);
}

void HeightCell::add(const HeightCell& other)
{
    if (other.points == 0) return;
    if (points == 0) {
        *this = other;
        return;
    }
    const auto a = static_cast<double>(points), b = static_cast<double>(other.points);
    const double off = other.mean - mean;
    squares += other.squares + off * off * (a * b / (a + b));
    mean += off * (b / (a + b));
    points += other.points;
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
}

void HeightCell::count_places(double points_per_place)
{
    if (points == 0) return;
    points =
        std::max<std::uint64_t>(1, static_cast<std::uint64_t>(static_cast<double>(points) / points_per_place + 0.5));
    squares = points > 1 ? squares / points_per_place : 0;
}

Surface2d surface_of(const std::vector<HeightCell>& cells, CellHeight kind)
{
    double squares = 0, freedom = 0;
    for (const HeightCell& cell : cells)
        if (cell.points > 1) {
            squares += cell.squares;
            freedom += static_cast<double>(cell.points - 1);
        }
    const double usual = freedom > 0 ? squares / freedom : 0;
    Surface2d surface;
    surface.height.reserve(cells.size());
    surface.variance.reserve(cells.size());
    for (const HeightCell& cell : cells) {
        const auto count = static_cast<double>(cell.points);
        const double variance = cell.points > 1 ? cell.squares / (count - 1) : usual;
        const double height = cell.points == 0             ? std::numeric_limits<double>::quiet_NaN()
                              : kind == CellHeight::mean   ? cell.mean
                              : kind == CellHeight::lowest ? cell.lowest
                                                           : cell.highest;
        surface.height.push_back(height);
        surface.variance.push_back(cell.points == 0 ? 0 : kind == CellHeight::mean ? variance / count : variance);
    }
    return surface;
}

}  // namespace pcm
