#include "pcm/select/flood.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

constexpr std::int64_t most_cells = std::int64_t(1) << 20;  // along an axis

std::uint64_t key_of(const std::array<std::int64_t, 3>& index)
{
    return static_cast<std::uint64_t>(index[2]) << 42 | static_cast<std::uint64_t>(index[1]) << 21 |
           static_cast<std::uint64_t>(index[0]);
}

}  // namespace

Flood::Flood(std::vector<Vec3d> points, const Box3d& box, double distance)
    : points_(std::move(points)),
      origin_(box.min),
      distance_(distance),
      square_(distance * distance),
      reached_(points_.size(), 0)
{
    // Rounding moves a point by less than a millionth of an edge where there are no more than 2^20 cells.
    edge_ = distance / std::sqrt(3.0) * (1 - 1e-6);
    const double extent = std::max({box.extent(0), box.extent(1), box.extent(2), 0.0});
    whole_cells_ = extent / edge_ < most_cells;
    if (!whole_cells_) edge_ = std::max(distance * (1 + 1e-6), extent / most_cells);
    most_ = index_of(box.max);
    make_cells();
}

Flood::Index Flood::index_of(const Vec3d& p) const
{
    Index index;
    for (std::size_t a = 0; a < 3; ++a)
        index[a] = static_cast<std::int64_t>(
            std::clamp(std::floor((p[a] - origin_[a]) / edge_), -8.0, static_cast<double>(most_cells + 8)));
    return index;
}

void Flood::make_cells()
{
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(points_.size());
    for (std::uint32_t i = 0; i < points_.size(); ++i) keys[i] = {key_of(index_of(points_[i])), i};
    std::sort(keys.begin(), keys.end());
    order_.resize(points_.size());
    cell_of_.resize(points_.size());
    for (std::uint32_t i = 0; i < keys.size(); ++i) {
        const auto [key, point] = keys[i];
        order_[i] = point;
        if (cells_.empty() || cells_.back().key != key) {
            if (rows_.empty() || rows_.back().key != key >> 21) {
                const auto begin = static_cast<std::uint32_t>(cells_.size());
                rows_.push_back({key >> 21, begin, begin});
            }
            cells_.push_back({key, i, i, i, {}});
            ++rows_.back().end;
        }
        Cell& cell = cells_.back();
        cell.open = ++cell.end;
        cell.box.extend(points_[point]);
        cell_of_[point] = static_cast<std::uint32_t>(cells_.size() - 1);
    }
}

// Conservative: false only when no point of the box is within the distance.
bool Flood::may_be_near(const Vec3d& p, const Box3d& box) const
{
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const double d = std::max({box.min[a] - p[a], p[a] - box.max[a], 0.0});
        sum += d * d;
    }
    return sum <= square_ * (1 + 1e-12);
}

void Flood::reach_all(Cell& cell)
{
    if (cell.open == cell.begin) return;
    for (std::uint32_t i = cell.begin; i < cell.end; ++i) reached_[order_[i]] = 1;
    cell.open = cell.begin;
    next_.push_back(static_cast<std::uint32_t>(&cell - cells_.data()));
}

void Flood::reach(std::size_t i)
{
    if (reached_[i]) return;
    Cell& cell = cells_[cell_of_[i]];
    if (whole_cells_) return reach_all(cell);
    for (std::uint32_t k = cell.begin; k < cell.open; ++k)
        if (order_[k] == i) {
            std::swap(order_[k], order_[--cell.open]);
            break;
        }
    reached_[i] = 1;
    next_.push_back(static_cast<std::uint32_t>(i));
}

// Cells with points that are not reached, of those that the box, grown by the distance, touches.
template <class Visit>
void Flood::for_each_open_near(const Vec3d& low, const Vec3d& high, const Visit& visit)
{
    const double reach = distance_ * (1 + 1e-6);
    const Index from = index_of(low - Vec3d{reach, reach, reach}), to = index_of(high + Vec3d{reach, reach, reach});
    const std::int64_t first_x = std::max<std::int64_t>(from[0], 0), last_x = std::min(to[0], most_[0]),
                       first_y = std::max<std::int64_t>(from[1], 0), last_y = std::min(to[1], most_[1]);
    if (first_x > last_x || first_y > last_y) return;
    const auto before = [](const auto& entry, std::uint64_t key) { return entry.key < key; };
    for (std::int64_t z = std::max<std::int64_t>(from[2], 0); z <= std::min(to[2], most_[2]); ++z) {
        const std::uint64_t last_row = key_of({last_x, last_y, z}) >> 21;
        auto row = std::lower_bound(rows_.begin(), rows_.end(), key_of({first_x, first_y, z}) >> 21, before);
        for (; row != rows_.end() && row->key <= last_row; ++row) {
            const std::uint64_t last = row->key << 21 | static_cast<std::uint64_t>(last_x);
            const auto end = cells_.begin() + row->end;
            auto cell = std::lower_bound(cells_.begin() + row->begin, end,
                                         row->key << 21 | static_cast<std::uint64_t>(first_x), before);
            for (; cell != end && cell->key <= last; ++cell)
                if (cell->open > cell->begin) visit(*cell);
        }
    }
}

void Flood::spread_from(const Vec3d& p, Cell& cell)
{
    if (!may_be_near(p, cell.box)) return;
    for (std::uint32_t k = cell.begin; k < cell.open;) {
        const std::uint32_t i = order_[k];
        if (!near(p, points_[i])) {
            ++k;
            continue;
        }
        if (whole_cells_) return reach_all(cell);
        std::swap(order_[k], order_[--cell.open]);
        reached_[i] = 1;
        next_.push_back(i);
    }
}

void Flood::spread_from(const Cell& from, Cell& cell)
{
    for (std::uint32_t k = from.begin; k < from.end && cell.open > cell.begin; ++k)
        spread_from(points_[order_[k]], cell);
}

void Flood::reach_from(const Vec3d& p)
{
    for_each_open_near(p, p, [&](Cell& cell) { spread_from(p, cell); });
}

void Flood::run()
{
    while (!next_.empty()) {
        const std::uint32_t i = next_.back();
        next_.pop_back();
        if (whole_cells_) {
            const Cell& from = cells_[i];
            for_each_open_near(from.box.min, from.box.max, [&](Cell& cell) { spread_from(from, cell); });
        } else {
            reach_from(points_[i]);
        }
    }
}

}  // namespace pcm
