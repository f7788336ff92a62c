#include "pcm/measure/cell_grid.h"

#include "pcm/cloud/exact_products.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

// The part of the polygon where the coordinate is at least `bound` (or at most, `above` false). Sutherland-Hodgman: the
// parts of a polygon that falls apart stay joined by edges along the bound, which have no area.
std::vector<Vec2d> cut(const std::vector<Vec2d>& polygon, std::size_t axis, double bound, bool above)
{
    std::vector<Vec2d> kept;
    const auto holds = [&](const Vec2d& p) { return above ? p[axis] >= bound : p[axis] <= bound; };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        if (holds(a)) kept.push_back(a);
        if (holds(a) == holds(b)) continue;
        Vec2d crossing;
        crossing[axis] = bound;
        crossing[1 - axis] = a[1 - axis] + (b[1 - axis] - a[1 - axis]) * ((bound - a[axis]) / (b[axis] - a[axis]));
        kept.push_back(crossing);
    }
    return kept;
}

double area_of(const std::vector<Vec2d>& polygon)
{
    double sum = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) sum += turn(polygon[0], polygon[i], polygon[i + 1]);
    return std::fabs(sum) / 2;
}

Vec2d extent_of(const std::vector<Vec2d>& polygon, Vec2d& least)
{
    Vec2d most = least = polygon[0];
    for (const Vec2d& p : polygon)
        for (std::size_t a = 0; a < 2; ++a) {
            least[a] = std::min(least[a], p[a]);
            most[a] = std::max(most[a], p[a]);
        }
    return {most[0] - least[0], most[1] - least[1]};
}

}  // namespace

double CellGrid::cells_of(const std::vector<Vec2d>& polygon, double side)
{
    Vec2d least;
    const Vec2d extent = extent_of(polygon, least);
    return std::max(1.0, std::ceil(extent[0] / side)) * std::max(1.0, std::ceil(extent[1] / side));
}

CellGrid::CellGrid(const std::vector<Vec2d>& polygon, double side) : polygon_(polygon), side_(side)
{
    const Vec2d extent = extent_of(polygon, origin_);
    for (Vec2d& p : polygon_) p = {p[0] - origin_[0], p[1] - origin_[1]};
    inside_.emplace(polygon_);
    const double columns = std::ceil(extent[0] / side), rows = std::ceil(extent[1] / side);
    if (!(columns < 2147483648.0) || !(rows < 2147483648.0))
        throw Error(ErrorCode::invalid_argument, {}, "the cells of the grid are too small for the polygon");
    columns_ = std::max<std::size_t>(1, static_cast<std::size_t>(columns));
    rows_ = std::max<std::size_t>(1, static_cast<std::size_t>(rows));
    kinds_.assign(size(), Kind::outside);
    areas_.assign(size(), 0.0);
    mark_edges();
    find_areas();
}

std::size_t CellGrid::index_along(double distance, std::size_t count) const
{
    const double index = std::floor(distance / side_);
    return index <= 0 ? 0 : std::min(count - 1, static_cast<std::size_t>(index));
}

// All cells that an edge passes, and those next to it where rounding could decide.
void CellGrid::mark_edges()
{
    const double margin = 1e-9 * side_;
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
        Vec2d a = polygon_[i], b = polygon_[(i + 1) % polygon_.size()];
        if (a[1] > b[1]) std::swap(a, b);
        const std::size_t first = index_along(a[1] - margin, rows_), last = index_along(b[1] + margin, rows_);
        for (std::size_t row = first; row <= last; ++row) {
            const double low = std::max(a[1], static_cast<double>(row) * side_ - margin);
            const double high = std::min(b[1], static_cast<double>(row + 1) * side_ + margin);
            const auto x_at = [&](double y) {
                return b[1] > a[1] ? a[0] + (b[0] - a[0]) * std::clamp((y - a[1]) / (b[1] - a[1]), 0.0, 1.0) : a[0];
            };
            double from = x_at(low), to = b[1] > a[1] ? x_at(high) : b[0];
            if (from > to) std::swap(from, to);
            const std::size_t end = index_along(to + margin, columns_);
            for (std::size_t column = index_along(from - margin, columns_); column <= end; ++column)
                kinds_[row * columns_ + column] = Kind::edge;
        }
    }
}

void CellGrid::find_areas()
{
    for (std::size_t row = 0; row < rows_; ++row) {
        const double y = static_cast<double>(row) * side_;
        std::vector<Vec2d> strip;  // made where it is needed
        for (std::size_t column = 0; column < columns_; ++column) {
            const std::size_t cell = row * columns_ + column;
            const double x = static_cast<double>(column) * side_;
            if (kinds_[cell] == Kind::edge) {
                if (strip.empty()) strip = cut(cut(polygon_, 1, y, true), 1, y + side_, false);
                areas_[cell] = area_of(cut(cut(strip, 0, x, true), 0, x + side_, false));
                continue;
            }
            // All of a cell that no edge passes is where its neighbour is, unless that is on an edge.
            const bool known = column > 0 && kinds_[cell - 1] != Kind::edge;
            if (known ? kinds_[cell - 1] == Kind::inside : inside_->contains(x + side_ / 2, y + side_ / 2)) {
                kinds_[cell] = Kind::inside;
                areas_[cell] = side_ * side_;
            }
        }
    }
}

std::size_t CellGrid::cell_of(double x, double y) const
{
    const Vec2d p{x - origin_[0], y - origin_[1]};
    const double columns = p[0] / side_, rows = p[1] / side_;
    if (!(columns >= 0 && rows >= 0) || columns > static_cast<double>(columns_) || rows > static_cast<double>(rows_))
        return size();
    const std::size_t cell = index_along(p[1], rows_) * columns_ + index_along(p[0], columns_);
    if (kinds_[cell] == Kind::outside || (kinds_[cell] == Kind::edge && !inside_->contains(p[0], p[1]))) return size();
    return cell;
}

}  // namespace pcm
