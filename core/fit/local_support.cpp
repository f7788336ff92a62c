#include "pcm/fit/local_support.h"

#include "pcm/fit/tuning.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pcm {
namespace {

constexpr std::int64_t cells_across = std::int64_t(1) << 20;

// Counts of points within and beyond the threshold, by cell.
class SupportCells {
public:
    SupportCells(double size, std::size_t points) : size_(size)
    {
        std::size_t capacity = 64;
        while (capacity < 2 * points) capacity *= 2;
        cells_.resize(capacity);
    }

    struct Cell {
        std::uint64_t key = 0;  // 0: empty
        std::uint32_t in = 0, out = 0;
        float support = -1;  // or what else is kept of it; below 0: not computed
    };
    using Place = std::array<std::int64_t, 3>;

    Place place(const Vec3d& p) const
    {
        Place place{};
        // Working coordinates are from -1 to 1.
        for (std::size_t k = 0; k < 3; ++k) place[k] = static_cast<std::int64_t>((p[k] + 2) / size_) + 1;
        return place;
    }
    Cell& at(const Place& place) { return slot(key_of(place)); }
    const Cell& find(const Place& place) { return slot(key_of(place)); }
    void make(Cell& cell, const Place& place) { cell.key = key_of(place); }

private:
    static std::uint64_t key_of(const Place& place)
    {
        return static_cast<std::uint64_t>((place[0] << 42) | (place[1] << 21) | place[2]) + 1;
    }
    Cell& slot(std::uint64_t key)
    {
        std::size_t at = (key * 0x9e3779b97f4a7c15u) >> 20;
        for (;; ++at) {
            Cell& cell = cells_[at & (cells_.size() - 1)];
            if (cell.key == key || cell.key == 0) return cell;
        }
    }

    double size_;
    std::vector<Cell> cells_;
};

// Points within and beyond the threshold in a cell and those around it.
std::pair<double, double> around(SupportCells& cells, const SupportCells::Place& place)
{
    double in = 0, out = 0;
    for (std::int64_t dx = -1; dx <= 1; ++dx)
        for (std::int64_t dy = -1; dy <= 1; ++dy)
            for (std::int64_t dz = -1; dz <= 1; ++dz) {
                const SupportCells::Cell& cell = cells.find({place[0] + dx, place[1] + dy, place[2] + dz});
                in += cell.in;
                out += cell.out;
            }
    return {in, out};
}

// Points beyond the threshold, counted once per cell.
double beyond(SupportCells& cells, const SupportCells::Place& place)
{
    SupportCells::Cell& cell = cells.at(place);
    if (cell.support < 0) cell.support = static_cast<float>(around(cells, place).second);
    return cell.support;
}

// Counts the points up to `farthest` from the surface.
SupportCells filled(const WorkingPoints& points, const std::vector<double>& distances, double threshold, double size,
                    double farthest)
{
    std::size_t near = 0;
    for (const double distance : distances) near += std::fabs(distance) <= farthest;
    SupportCells cells(size, near);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!(std::fabs(distances[i]) <= farthest)) continue;
        const SupportCells::Place place = cells.place(points.at(i));
        SupportCells::Cell& cell = cells.at(place);
        cells.make(cell, place);
        ++(std::fabs(distances[i]) <= threshold ? cell.in : cell.out);
    }
    return cells;
}

// The size of cells whose blocks have enough points of the surface.
double cell_size(const WorkingPoints& points, const std::vector<double>& distances, double threshold, double noise,
                 std::size_t inliers)
{
    const auto n = static_cast<double>(inliers);
    const SupportTuning& tuned = fit_tuning().support;
    const double wanted = std::max(tuned.min_block_points, n / tuned.blocks);
    const double least = std::max(2 * noise, 4.0 / cells_across);
    double size = std::max(least, std::sqrt(wanted / n) / 2);
    for (int round = 0; round < 3 && size > least; ++round) {
        SupportCells cells = filled(points, distances, threshold, size, threshold);
        std::vector<double> counts;
        for (std::size_t i = 0; i < points.size() && counts.size() < 40; ++i)
            if (std::fabs(distances[i]) <= threshold) counts.push_back(around(cells, cells.place(points.at(i))).first);
        std::nth_element(counts.begin(), counts.begin() + counts.size() / 2, counts.end());
        const double scale = std::sqrt(wanted / counts[counts.size() / 2]);
        size = std::clamp(size * scale, least, 0.5);
        if (scale > 0.6 && scale < 1.7) break;
    }
    return size;
}

}  // namespace

bool LocalSupport::find(const Shape& shape, double threshold, double noise)
{
    const std::size_t n = points_.size();
    const std::vector<double> before = distances_;
    distances_.resize(n);
    model_.distances(shape, points_.x.data(), points_.y.data(), points_.z.data(), n, distances_.data());
    std::size_t inliers = 0;
    double change = 0;
    for (std::size_t i = 0; i < n; ++i)
        if (std::fabs(distances_[i]) <= threshold) {
            ++inliers;
            if (!before.empty()) change += (distances_[i] - before[i]) * (distances_[i] - before[i]);
        }
    if (!before.empty() && inliers > 0 && change <= 0.25 * noise * noise * static_cast<double>(inliers)) return false;
    support_.clear();
    share_ = 1;
    if (inliers < fit_tuning().support.min_inliers || inliers == n || !(threshold < 0.1)) return true;
    if (!(size_ > 0)) size_ = cell_size(points_, distances_, threshold, noise, inliers);
    SupportCells cells = filled(points_, distances_, threshold, size_, threshold);
    // What is anywhere is counted in larger cells: in a block of these, beyond the threshold.
    const double large = std::max(size_, 4 * threshold), block = 3 * size_, large_block = 3 * large;
    SupportCells large_cells = filled(points_, distances_, threshold, large, large_block);
    const double part =
        block * block * std::min(block, 2 * threshold) / (large_block * large_block * (large_block - 2 * threshold));
    support_.assign(n, 0);
    const double min_support = fit_tuning().support.min_support;
    double supported = 0, belong = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (!(std::fabs(distances_[i]) <= threshold)) continue;
        const SupportCells::Place place = cells.place(points_.at(i));
        SupportCells::Cell& cell = cells.at(place);
        if (cell.support < 0) {
            const double others = around(cells, place).first - 1;
            const double chance = part * beyond(large_cells, large_cells.place(points_.at(i)));
            const bool is_more = others > chance + min_support * std::sqrt(chance + 1);
            cell.support = is_more ? static_cast<float>((others - chance) / others) : 0;
        }
        if (!(cell.support > 0)) continue;
        support_[i] = 1;
        supported += 1;
        belong += cell.support;
    }
    if (supported > 0) share_ = belong / supported;
    return true;
}

}  // namespace pcm
