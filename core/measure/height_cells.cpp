#include "pcm/measure/height_cells.h"

#include <algorithm>
#include <cmath>
#include <deque>
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

namespace {

struct Neighbours {
    std::size_t count = 0;
    std::array<std::size_t, 4> cells{};
};

Neighbours neighbours_of(std::size_t cell, const std::vector<double>& areas, std::size_t columns)
{
    Neighbours found;
    const std::size_t column = cell % columns;
    const auto take = [&](bool exists, std::size_t other) {
        if (exists && areas[other] > 0) found.cells[found.count++] = other;
    };
    take(column > 0, cell - 1);
    take(column + 1 < columns, cell + 1);
    take(cell >= columns, cell - columns);
    take(cell + columns < areas.size(), cell + columns);
    return found;
}

}  // namespace

void fill_gaps(std::vector<double>& height, const std::vector<double>& areas, std::size_t columns)
{
    // First guess: outwards from the known cells, the height of a cell that is known already.
    std::deque<std::size_t> front;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t cell = 0; cell < height.size(); ++cell)
        if (!std::isnan(height[cell])) {
            low = std::min(low, height[cell]);
            high = std::max(high, height[cell]);
            front.push_back(cell);
        }
    std::vector<std::size_t> gaps;
    for (; !front.empty(); front.pop_front()) {
        const Neighbours around = neighbours_of(front.front(), areas, columns);
        for (std::size_t k = 0; k < around.count; ++k)
            if (std::isnan(height[around.cells[k]])) {
                height[around.cells[k]] = height[front.front()];
                gaps.push_back(around.cells[k]);
                front.push_back(around.cells[k]);
            }
    }
    std::sort(gaps.begin(), gaps.end());
    constexpr double relaxation = 1.7;
    for (int round = 0; round < 2000; ++round) {
        double largest = 0;
        for (const std::size_t cell : gaps) {
            const Neighbours around = neighbours_of(cell, areas, columns);
            double sum = 0;
            for (std::size_t k = 0; k < around.count; ++k) sum += height[around.cells[k]];
            const double change = relaxation * (sum / static_cast<double>(around.count) - height[cell]);
            height[cell] += change;
            largest = std::max(largest, std::fabs(change));
        }
        if (!(largest > 1e-6 * (high - low))) break;
    }
}

}  // namespace pcm
