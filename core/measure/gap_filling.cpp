#include "pcm/measure/gap_filling.h"

#include "pcm/cloud/numbers.h"
#include "pcm/measure/cell_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace pcm {
namespace {

using namespace cells;

// ---- Cross-validation

constexpr std::size_t bins = 24;  // bins by log2 of the width

struct Learnt {
    double squares = 0, jumps2 = 0, jumps = 0, blocks = 0;
    double mean() const { return squares / blocks; }
};

class GapErrors {
public:
    // `field` is relative to the plane, `heights` are not.
    GapErrors(const Field& field, const Field& heights, std::uint32_t widest, std::size_t reach, double spread,
              const Check& check);
    double error2(bool outer, std::uint32_t width) const { return at(outer, width, mean_); }
    double jump2(std::uint32_t width) const { return at(false, width, jumps2_); }
    double jump(std::uint32_t width) const { return std::sqrt(at(false, width, jumps_)); }

private:
    using Curve = std::array<double, bins>;
    void hide(const Field& field, std::size_t w, std::size_t dx, std::size_t dy, std::size_t scale);
    static void complete(Curve& curve, const std::array<double, bins>& blocks, double least_power, double fallback);
    static double at(bool outer, std::uint32_t width, const std::array<Curve, 2>& curves);

    const Check& check_;
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

// `scale`: number of the grid's cells in a row that one of the field's stands for.
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
            hidden.height[cell] = not_a_number;
            if (field.area[cell] > 0) blocks[*block].area += field.area[cell];
            if (field.known(cell)) blocks[*block].known += field.area[cell];
        } else if (field.known(cell)) {
            ++left;
        }
    }
    if (left < 2) return;
    const Gaps gaps = look_around(hidden, reach_ / scale);
    fill(hidden, check_);
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
    double power = least_power;  // exponent of E as a power of the width
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

GapErrors::GapErrors(const Field& field, const Field& heights, std::uint32_t widest, std::size_t reach, double spread,
                     const Check& check)
    : check_(check), reach_(reach)
{
    const std::size_t extent = std::max(field.columns, field.rows());
    // In large grids wide blocks are hidden in coarser cells, so that all widths together take about as long as the
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
    // An extrapolation is not better than an interpolation.
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
                      double spread, const Check& check)
{
    Field field{height, areas, columns};
    for (std::size_t cell = 0; cell < height.size(); ++cell)
        if (!(areas[cell] > 0)) field.height[cell] = not_a_number;
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
    const GapErrors errors(field, heights, widest, reach, spread, check);
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
    solve_laplace(field, check);
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
