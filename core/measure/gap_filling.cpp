#include "pcm/measure/gap_filling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace pcm {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// A grid of heights; NaN: not known.
struct Field {
    std::vector<double> height, area;
    std::size_t columns = 0;

    std::size_t rows() const { return columns ? height.size() / columns : 0; }
    bool known(std::size_t cell) const { return area[cell] > 0 && !std::isnan(height[cell]); }
    bool gap(std::size_t cell) const { return area[cell] > 0 && std::isnan(height[cell]); }
};

// ---- The plane through the known cells

// z = a + b (column - x0) + c (row - y0).
struct CellPlane {
    double x0 = 0, y0 = 0, a = 0, b = 0, c = 0;
    double at(std::size_t cell, std::size_t columns) const
    {
        return a + b * (static_cast<double>(cell % columns) - x0) + c * (static_cast<double>(cell / columns) - y0);
    }
};

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
        coarse.height[cell] = weight[cell] > 0 ? sum[cell] / weight[cell] : nan;
    return coarse;
}

// Successive over-relaxation from a guess that the coarser grid gives (cascadic multigrid: Bornemann and Deuflhard
// 1996), so that a few rounds do on each grid.
void solve_laplace(Field& field)
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
        solve_laplace(coarse);
        for (const std::size_t cell : gaps)
            field.height[cell] = coarse.height[(cell / field.columns / 2) * coarse.columns + cell % field.columns / 2];
    }
    constexpr double relaxation = 1.6;
    constexpr int rounds = 60;
    const std::size_t columns = field.columns;
    for (int round = 0; round < rounds; ++round) {
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

void fill(Field& field)
{
    const CellPlane plane = plane_through(field);
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) field.height[cell] -= plane.at(cell, field.columns);
    solve_laplace(field);
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) field.height[cell] += plane.at(cell, field.columns);
}

// ---- What is around a gap

struct Gaps {
    std::vector<std::uint32_t> width;
    std::vector<std::uint8_t> outer;
    std::vector<float> jump2;  // D^2
};

// The largest of a row's or column's values within `reach`, 0 or 1.
void spread_marks(std::vector<std::uint8_t>& marks, std::size_t begin, std::size_t length, std::size_t step,
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
std::vector<std::uint8_t> near_known(const Field& field, std::size_t reach)
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

// Cells narrower than the points are apart: gaps of that width are no holes in the cloud. How far a known cell usually
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

// Of each gap cell the nearest known cells along its row and its column. Where there are known ones on both sides of
// one of them the narrower one is the gap's width. Cells within `reach` of known ones count as known.
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
            if (reach > 0) continue;  // the heights beside the gap are not known
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

// ---- Cross-validation

constexpr std::size_t bins = 24;  // of log2 of the width

struct Learnt {
    double squares = 0, jumps2 = 0, jumps = 0, blocks = 0;
    double mean() const { return squares / blocks; }
};

class GapErrors {
public:
    // `field` is relative to the plane, `heights` are not.
    GapErrors(const Field& field, const Field& heights, std::uint32_t widest, std::size_t reach, double spread);
    double error2(bool outer, std::uint32_t width) const { return at(outer, width, mean_); }
    double jump2(std::uint32_t width) const { return at(false, width, jumps2_); }
    double jump(std::uint32_t width) const { return std::sqrt(at(false, width, jumps_)); }

private:
    using Curve = std::array<double, bins>;
    void hide(const Field& field, std::size_t w, std::size_t dx, std::size_t dy, std::size_t scale);
    static void complete(Curve& curve, const std::array<double, bins>& blocks, double least_power, double fallback);
    static double at(bool outer, std::uint32_t width, const std::array<Curve, 2>& curves);

    std::size_t reach_;
    std::array<std::array<Learnt, bins>, 2> learnt_;
    std::array<Curve, 2> mean_{}, jumps2_{}, jumps_{};
};

double bin_of(double width) { return std::clamp(std::log2(std::max(1.0, width)), 0.0, double(bins - 1)); }

// Linear in the logarithms.
double GapErrors::at(bool outer, std::uint32_t width, const std::array<Curve, 2>& curves)
{
    const Curve& curve = curves[outer];
    const double place = bin_of(width);
    const auto low = std::min(static_cast<std::size_t>(place), bins - 2);
    const double part = place - static_cast<double>(low);
    if (!(curve[low] > 0) || !(curve[low + 1] > 0)) return curve[low] + part * (curve[low + 1] - curve[low]);
    return std::exp(std::log(curve[low]) * (1 - part) + std::log(curve[low + 1]) * part);
}

// `scale`: of the grid's cells in a row that one of the field's stands for.
void GapErrors::hide(const Field& field, std::size_t w, std::size_t dx, std::size_t dy, std::size_t scale)
{
    Field hidden = field;
    const std::size_t columns = field.columns;
    const auto block_at = [&](std::size_t cell) -> std::optional<std::size_t> {
        const std::size_t x = cell % columns + dx, y = cell / columns + dy;
        if (x / w % 2 || y / w % 2) return {};
        return (y / w / 2) * (columns / (2 * w) + 2) + x / w / 2;
    };
    struct Block {
        double area = 0, known = 0, error = 0, width = 0, outer = 0, jump2 = 0, jump = 0, inner = 0;
    };
    std::vector<Block> blocks((columns / (2 * w) + 2) * (field.rows() / (2 * w) + 2));
    std::size_t left = 0;
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) {
        if (const auto block = block_at(cell)) {
            hidden.height[cell] = nan;
            if (field.area[cell] > 0) blocks[*block].area += field.area[cell];
            if (field.known(cell)) blocks[*block].known += field.area[cell];
        } else if (field.known(cell)) {
            ++left;
        }
    }
    if (left < 2) return;
    const Gaps gaps = look_around(hidden, reach_ / scale);
    fill(hidden);
    for (std::size_t cell = 0; cell < field.height.size(); ++cell) {
        const auto number = block_at(cell);
        if (!number || !field.known(cell)) continue;
        Block& block = blocks[*number];
        const double a = field.area[cell];
        block.error += a * (hidden.height[cell] - field.height[cell]);
        block.width += a * gaps.width[cell];
        if (gaps.outer[cell]) {
            block.outer += a;
        } else {
            block.inner += a;
            block.jump2 += a * static_cast<double>(gaps.jump2[cell]);
            block.jump += a * std::sqrt(static_cast<double>(gaps.jump2[cell]));
        }
    }
    double largest = 0;
    for (const Block& block : blocks) largest = std::max(largest, block.known);
    for (const Block& block : blocks) {
        if (!(block.known > 0) || !(block.known >= 0.4 * largest)) continue;
        const bool outer = block.outer > block.inner;
        const double error = block.error / block.known, width = static_cast<double>(scale) * block.width / block.known;
        Learnt& entry = learnt_[outer][static_cast<std::size_t>(std::lround(bin_of(width)))];
        entry.squares += error * error;
        entry.blocks += 1;
        if (block.inner > 0) {
            entry.jumps2 += block.jump2 / block.inner;
            entry.jumps += block.jump / block.inner;
        }
    }
}

// Bins without blocks between others are between them; narrower ones are as the first; wider ones grow by the power
// that the last ones show.
void GapErrors::complete(Curve& curve, const std::array<double, bins>& blocks, double least_power, double fallback)
{
    constexpr double enough = 3;
    std::vector<std::size_t> known;
    for (std::size_t k = 0; k < bins; ++k)
        if (blocks[k] >= enough) known.push_back(k);
    if (known.empty()) {
        curve.fill(fallback);
        for (std::size_t k = 0; k < bins; ++k) curve[k] *= std::pow(4.0, least_power * static_cast<double>(k));
        return;
    }
    for (std::size_t k = 0; k < known.front(); ++k) curve[k] = curve[known.front()];
    for (std::size_t i = 0; i + 1 < known.size(); ++i)
        for (std::size_t k = known[i] + 1; k < known[i + 1]; ++k) {
            const double part = static_cast<double>(k - known[i]) / static_cast<double>(known[i + 1] - known[i]);
            curve[k] = curve[known[i]] + part * (curve[known[i + 1]] - curve[known[i]]);
        }
    double power = least_power;  // of E by the width
    const std::size_t last = known.back();
    if (known.size() > 1 && curve[known[known.size() - 2]] > 0 && curve[last] > 0)
        power = std::clamp(0.5 * std::log2(curve[last] / curve[known[known.size() - 2]]) /
                               static_cast<double>(last - known[known.size() - 2]),
                           least_power, 2.0);
    for (std::size_t k = last + 1; k < bins; ++k) curve[k] = curve[k - 1] * std::pow(4.0, power);
}

// The mean squared difference of known cells `lag` cells apart along rows and columns, and how many there are.
Learnt differences(const Field& heights, std::size_t lag)
{
    Learnt found;
    const std::size_t columns = heights.columns;
    for (std::size_t cell = 0; cell < heights.height.size(); ++cell) {
        if (!heights.known(cell)) continue;
        const auto add = [&](std::size_t other) {
            if (!heights.known(other)) return;
            const double d = heights.height[other] - heights.height[cell];
            found.squares += d * d;
            found.blocks += 1;
        };
        if (cell % columns + lag < columns) add(cell + lag);
        if (cell + lag * columns < heights.height.size()) add(cell + lag * columns);
    }
    return found;
}

GapErrors::GapErrors(const Field& field, const Field& heights, std::uint32_t widest, std::size_t reach, double spread)
    : reach_(reach)
{
    const std::size_t extent = std::max(field.columns, field.rows());
    // Of large grids wide blocks are hidden in coarser ones, so that all widths together take about as long as the
    // first.
    constexpr std::size_t large = 30000, fine = 4;
    Field seen = field;
    std::size_t scale = 1;
    for (std::size_t w = 1; w <= std::max<std::size_t>(1, extent / 2) && w / 2 <= widest; w *= 2) {
        for (; w > fine * scale && seen.height.size() > large; scale *= 2) seen = coarser(seen);
        const std::size_t own = w / scale;
        for (std::size_t k = 0; k < 4; ++k) {
            if (k > 0 && field.height.size() / (w * w) > 8000) break;  // enough blocks
            hide(seen, own, k % 2 * own, k / 2 * own, scale);
        }
    }
    double total = 0, mean = 0, squares = 0;
    for (std::size_t cell = 0; cell < field.height.size(); ++cell)
        if (field.known(cell)) {
            const double off = field.height[cell] - mean;
            total += 1;
            mean += off / total;
            squares += off * (field.height[cell] - mean);
        }
    // All that is known where nothing could be hidden.
    const double fallback = std::max(total > 1 ? squares / (total - 1) : 0, spread * spread);
    std::array<std::array<double, bins>, 2> blocks{};
    for (std::size_t outer = 0; outer < 2; ++outer)
        for (std::size_t k = 0; k < bins; ++k) {
            const Learnt& entry = learnt_[outer][k];
            blocks[outer][k] = entry.blocks;
            if (!(entry.blocks > 0)) continue;
            mean_[outer][k] = entry.squares / entry.blocks;
            jumps2_[outer][k] = entry.jumps2 / entry.blocks;
            jumps_[outer][k] = std::pow(entry.jumps / entry.blocks, 2);
        }
    for (std::size_t outer = 0; outer < 2; ++outer) {
        complete(mean_[outer], blocks[outer], outer ? 1.0 : 0.5, fallback);
        complete(jumps2_[outer], blocks[outer], 0, fallback);
        complete(jumps_[outer], blocks[outer], 0, fallback);
    }
    // An extrapolation is no better than an interpolation.
    Curve rises{};
    std::array<double, bins> pairs{};
    for (std::size_t k = 0; k < bins && std::size_t{1} << k <= extent; ++k) {
        const Learnt found = differences(heights, std::size_t{1} << k);
        pairs[k] = found.blocks;
        if (found.blocks > 0) rises[k] = found.mean();
    }
    complete(rises, pairs, 0.5, fallback);
    constexpr double share = 0.5;
    for (std::size_t k = 0; k < bins; ++k) mean_[1][k] = std::max(mean_[1][k], mean_[0][k]) + share * rises[k];
}

}  // namespace

FilledCells fill_gaps(const std::vector<double>& height, const std::vector<double>& areas, std::size_t columns,
                      double spread)
{
    Field field{height, areas, columns};
    for (std::size_t cell = 0; cell < height.size(); ++cell)
        if (!(areas[cell] > 0)) field.height[cell] = nan;
    FilledCells filled;
    std::size_t known = 0, gap_cells = 0;
    for (std::size_t cell = 0; cell < height.size(); ++cell) {
        known += field.known(cell);
        gap_cells += field.gap(cell);
    }
    filled.height = field.height;
    filled.sigma.assign(height.size(), 0);
    filled.step.assign(height.size(), 0);
    filled.width.assign(height.size(), 0);
    filled.outer.assign(height.size(), 0);
    if (known == 0 || gap_cells == 0) return filled;
    filled.filled = true;
    // What is learnt, and the differences, are relative to the plane.
    const Field heights = field;
    const CellPlane plane = plane_through(field);
    for (std::size_t cell = 0; cell < height.size(); ++cell) field.height[cell] -= plane.at(cell, columns);
    const std::size_t reach = usual_reach(field);
    Gaps gaps = look_around(field, reach);
    std::uint32_t widest = 1;
    for (const std::uint32_t width : gaps.width) widest = std::max(widest, width);
    const GapErrors errors(field, heights, widest, reach, spread);
    double excess = 0, inner = 0;
    for (std::size_t cell = 0; cell < height.size(); ++cell) {
        if (!field.gap(cell)) continue;
        const double usual = errors.jump2(gaps.width[cell]), jump2 = static_cast<double>(gaps.jump2[cell]);
        const double local = gaps.outer[cell] || !(usual > 0) ? 1 : 0.5 * (1 + jump2 / usual);
        filled.sigma[cell] = std::sqrt(local * errors.error2(gaps.outer[cell], gaps.width[cell]));
        if (gaps.outer[cell]) continue;
        inner += areas[cell];
        excess += areas[cell] * (std::sqrt(jump2) - errors.jump(gaps.width[cell]));
    }
    const double common = inner > 0 ? std::max(0.0, excess / inner) / 2 : 0;
    for (std::size_t cell = 0; cell < height.size(); ++cell)
        if (field.gap(cell) && !gaps.outer[cell]) filled.step[cell] = common;
    filled.width = std::move(gaps.width);
    filled.outer = std::move(gaps.outer);
    solve_laplace(field);
    for (std::size_t cell = 0; cell < height.size(); ++cell)
        if (std::isnan(filled.height[cell]) && areas[cell] > 0)
            filled.height[cell] = field.height[cell] + plane.at(cell, columns);
    return filled;
}

double gap_uncertainty(const FilledCells& cells, const std::vector<double>& weights, std::size_t columns)
{
    if (!cells.filled) return 0;
    const std::size_t rows = weights.size() / columns, line = columns + 1;
    // Sums over all cells before (row, column).
    std::vector<double> sums((rows + 1) * line, 0);
    double step = 0;
    for (std::size_t row = 0; row < rows; ++row) {
        double sum = 0;
        for (std::size_t column = 0; column < columns; ++column) {
            const std::size_t cell = row * columns + column;
            sum += weights[cell] * cells.sigma[cell];
            step += weights[cell] * cells.step[cell];
            sums[(row + 1) * line + column + 1] = sums[row * line + column + 1] + sum;
        }
    }
    double variance = 0;
    for (std::size_t cell = 0; cell < weights.size(); ++cell) {
        const double own = weights[cell] * cells.sigma[cell];
        if (!(own > 0)) continue;
        const std::size_t w = cells.width[cell], column = cell % columns, row = cell / columns;
        const std::size_t left = column > w ? column - w : 0, right = std::min(columns, column + w + 1);
        const std::size_t low = row > w ? row - w : 0, high = std::min(rows, row + w + 1);
        const double around =
            sums[high * line + right] - sums[low * line + right] - sums[high * line + left] + sums[low * line + left];
        variance += own * std::max(own, around);
    }
    return std::sqrt(variance + step * step);
}

}  // namespace pcm
