#include "pcm/measure/cell_field.h"

#include "pcm/cloud/numbers.h"

#include <algorithm>
#include <array>
#include <limits>

namespace pcm::cells {

namespace {

}  // namespace

// ---- The plane through the known cells

// Slopes are drawn towards 0 as by the unevenness of one cell's width: they stay finite for cells on a line.
CellPlane plane_through(const Field& field)
{
    CellPlane plane;
    double weight = 0;
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) {
        if (!field.known(cell)) continue;
        const double w = field.area[cell];
        weight += w;
        plane.x0 += w * static_cast<double>(cell % field.columns);
        plane.y0 += w * static_cast<double>(cell / field.columns);
        plane.a += w * field.height[cell];
    }
    if (!(weight > 0)) return plane;
    plane.x0 /= weight;
    plane.y0 /= weight;
    plane.a /= weight;
    double xx = weight / 4, xy = 0, yy = weight / 4, xz = 0, yz = 0;
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) {
        if (!field.known(cell)) continue;
        const double w = field.area[cell], z = field.height[cell] - plane.a;
        const double x = static_cast<double>(cell % field.columns) - plane.x0;
        const double y = static_cast<double>(cell / field.columns) - plane.y0;
        xx += w * x * x;
        xy += w * x * y;
        yy += w * y * y;
        xz += w * x * z;
        yz += w * y * z;
    }
    const double determinant = xx * yy - xy * xy;
    plane.b = (yy * xz - xy * yz) / determinant;
    plane.c = (xx * yz - xy * xz) / determinant;
    return plane;
}

// ---- Laplace's equation

// Cells of two by two as one: the mean of the known ones.
Field coarser(const Field& fine)
{
    Field coarse;
    coarse.columns = (fine.columns + 1) / 2;
    const std::size_t rows = (fine.rows() + 1) / 2;
    std::vector<double> weight(coarse.columns * rows, 0), sum(weight);
    coarse.area = weight;
    for (std::size_t cell = 0; cell < fine.height.size(); ++cell) {
        if (!(fine.area[cell] > 0)) continue;
        const std::size_t to = (cell / fine.columns / 2) * coarse.columns + cell % fine.columns / 2;
        coarse.area[to] += fine.area[cell];
        if (std::isnan(fine.height[cell])) continue;
        weight[to] += fine.area[cell];
        sum[to] += fine.area[cell] * fine.height[cell];
    }
    coarse.height.resize(sum.size());
    for (std::size_t cell = 0; cell < sum.size(); ++cell)
        coarse.height[cell] = weight[cell] > 0 ? sum[cell] / weight[cell] : not_a_number;
    return coarse;
}

// Successive over-relaxation from a guess that the coarser grid gives (cascadic multigrid: Bornemann and Deuflhard
// 1996), so that a few rounds do on each grid.
void solve_laplace(Field& field, const Check& check)
{
    std::vector<std::size_t> gaps;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) {
        if (field.gap(cell)) gaps.push_back(cell);
        if (!field.known(cell)) continue;
        low = std::min(low, field.height[cell]);
        high = std::max(high, field.height[cell]);
    }
    if (gaps.empty()) return;
    if (!(low <= high)) {
        for (const std::size_t cell : gaps) field.height[cell] = 0;
        return;
    }
    if (field.height.size() > 1) {
        Field coarse = coarser(field);
        solve_laplace(coarse, check);
        for (const std::size_t cell : gaps)
            field.height[cell] = coarse.height[(cell / field.columns / 2) * coarse.columns + cell % field.columns / 2];
    }
    constexpr double relaxation = 1.6;
    constexpr int rounds = 60;
    const std::size_t columns = field.columns;
    for (int round = 0; round < rounds; ++round) {
        if (check) check();
        double largest = 0;
        for (const std::size_t cell : gaps) {
            const std::size_t column = cell % columns;
            double sum = 0;
            int count = 0;
            const auto take = [&](bool exists, std::size_t other) {
                if (!exists || !(field.area[other] > 0)) return;
                sum += field.height[other];
                ++count;
            };
            take(column > 0, cell - 1);
            take(column + 1 < columns, cell + 1);
            take(cell >= columns, cell - columns);
            take(cell + columns < field.height.size(), cell + columns);
            if (count == 0) continue;
            const double change = relaxation * (sum / count - field.height[cell]);
            field.height[cell] += change;
            largest = std::max(largest, std::fabs(change));
        }
        if (!(largest > 1e-7 * (high - low))) break;
    }
}

void fill(Field& field, const Check& check)
{
    const CellPlane plane = plane_through(field);
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) field.height[cell] -= plane.at(cell, field.columns);
    solve_laplace(field, check);
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) field.height[cell] += plane.at(cell, field.columns);
}

// ---- What is around a gap

// The largest of a row's or column's values within `reach`, 0 or 1.
static void spread_marks(std::vector<std::uint8_t>& marks, std::size_t begin, std::size_t length, std::size_t step,
                         std::size_t reach)
{
    const std::size_t far = length + reach;
    std::vector<std::size_t> distance(length, far);
    for (const bool forward : {true, false}) {
        std::size_t since = far;
        for (std::size_t k = 0; k < length; ++k) {
            const std::size_t place = forward ? k : length - 1 - k;
            since = marks[begin + place * step] ? 0 : since + 1;
            distance[place] = std::min(distance[place], since);
        }
    }
    for (std::size_t k = 0; k < length; ++k) marks[begin + k * step] = distance[k] <= reach;
}

// Known cells, and those within `reach` of one along rows and columns.
static std::vector<std::uint8_t> near_known(const Field& field, std::size_t reach)
{
    std::vector<std::uint8_t> marks(field.height.size());
    for (std::size_t cell = 0; cell < marks.size(); ++cell) marks[cell] = field.known(cell);
    if (reach == 0) return marks;
    for (std::size_t row = 0; row < field.rows(); ++row)
        spread_marks(marks, row * field.columns, field.columns, 1, reach);
    for (std::size_t column = 0; column < field.columns; ++column)
        spread_marks(marks, column, field.rows(), field.columns, reach);
    return marks;
}

// Cells narrower than the points are apart: gaps of that width are not holes in the cloud. How far a known cell usually
// is from the next one, less the one step that neighbours are apart; 0 where cells have about a point each.
std::size_t usual_reach(const Field& field)
{
    std::size_t known = 0;
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) known += field.known(cell);
    for (std::size_t reach = 0; 2 * reach < std::max(field.columns, field.rows()); reach = 2 * reach + 1) {
        // Windows around known cells that have another one: most of them, if points are as near as that.
        const std::size_t columns = field.columns, around = reach + 1;
        std::size_t with_other = 0;
        std::vector<std::uint32_t> sums((field.rows() + 1) * (columns + 1), 0);
        for (std::size_t row = 0; row < field.rows(); ++row)
            for (std::size_t column = 0, sum = 0; column < columns; ++column) {
                sum += field.known(row * columns + column);
                sums[(row + 1) * (columns + 1) + column + 1] =
                    sums[row * (columns + 1) + column + 1] + static_cast<std::uint32_t>(sum);
            }
        for (std::size_t cell = 0; cell < field.height.size(); ++cell) {
            if (!field.known(cell)) continue;
            const std::size_t x = cell % columns, y = cell / columns;
            const std::size_t left = x > around ? x - around : 0, right = std::min(columns, x + around + 1);
            const std::size_t low = y > around ? y - around : 0, high = std::min(field.rows(), y + around + 1);
            const std::size_t line = columns + 1;
            with_other += sums[high * line + right] + sums[low * line + left] >
                          sums[low * line + right] + sums[high * line + left] + 1;
        }
        if (10 * with_other >= 9 * known) return reach;
    }
    return 0;
}

// For each gap cell the nearest known cells along its row and its column. Where both sides of one of them have known
// cells, the narrower one is the gap's width. Cells within `reach` of known ones count as known.
Gaps look_around(const Field& field, std::size_t reach)
{
    const std::size_t count = field.height.size(), columns = field.columns;
    const std::vector<std::uint8_t> known = near_known(field, reach);
    struct Sides {
        std::uint32_t before = 0, after = 0;  // distances; 0: none
    };
    std::vector<std::array<Sides, 2>> sides(count);
    const auto sweep = [&](std::size_t axis, std::size_t lines, std::size_t length, std::size_t line_step,
                           std::size_t step) {
        for (std::size_t line = 0; line < lines; ++line)
            for (const bool forward : {true, false}) {
                std::uint32_t distance = 0;  // to the last known cell; 0: none yet
                for (std::size_t k = 0; k < length; ++k) {
                    const std::size_t cell = line * line_step + (forward ? k : length - 1 - k) * step;
                    if (known[cell]) {
                        distance = 1;
                        continue;
                    }
                    if (distance == 0) continue;
                    (forward ? sides[cell][axis].before : sides[cell][axis].after) = distance++;
                }
            }
    };
    sweep(0, field.rows(), columns, columns, 1);
    sweep(1, columns, field.rows(), 1, columns);
    Gaps gaps;
    gaps.width.assign(count, 0);
    gaps.outer.assign(count, 0);
    gaps.jump2.assign(count, 0);
    for (std::size_t cell = 0; cell < count; ++cell) {
        if (!field.gap(cell)) continue;
        if (known[cell]) {
            gaps.width[cell] = static_cast<std::uint32_t>(2 * reach + 1);
            continue;
        }
        std::uint32_t between = 0, nearest = 0;
        double jump2 = 0;
        int pairs = 0;
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const Sides& s = sides[cell][axis];
            for (const std::uint32_t d : {s.before, s.after})
                if (d > 0 && (nearest == 0 || d < nearest)) nearest = d;
            if (s.before == 0 || s.after == 0) continue;
            const std::uint32_t width = s.before + s.after - 1;
            between = between == 0 ? width : std::min(between, width);
            if (reach > 0) continue;  // the heights next to the gap are not known
            const std::size_t step = axis == 0 ? 1 : columns;
            const double jump = field.height[cell + s.after * step] - field.height[cell - s.before * step];
            jump2 += jump * jump;
            ++pairs;
        }
        const auto all = static_cast<std::uint32_t>(std::max(columns, field.rows()));
        gaps.outer[cell] = between == 0;
        gaps.width[cell] = between > 0 ? between : nearest > 0 ? 2 * nearest : all;
        gaps.jump2[cell] = pairs ? static_cast<float>(jump2 / pairs) : 0.0F;
    }
    return gaps;
}

}  // namespace pcm::cells
