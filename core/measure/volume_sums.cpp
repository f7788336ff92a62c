#include "pcm/measure/volume_sums.h"

#include "pcm/measure/gap_filling.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace pcm {
namespace {

double normal_density(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * pi); }
double normal_share(double z) { return std::erfc(-z / std::sqrt(2.0)) / 2; }

// A cell's height over the reference is d with an error of sigma: how much of the error is one of the cut (the rest is
// of the fill), and by how much noise makes both larger: E max(d + e, 0) - max(d, 0).
struct Parts {
    double cut = 0, excess = 0;
};
Parts parts_of(double d, double sigma)
{
    if (!(sigma > 0)) return {d > 0 ? 1.0 : 0.0, 0};
    const double z = d / sigma;
    return {normal_share(z), std::max(0.0, sigma * normal_density(z) - std::fabs(d) * normal_share(-std::fabs(z)))};
}

std::vector<double> minus(const std::vector<double>& a, const std::vector<double>& b)
{
    std::vector<double> difference(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) difference[i] = a[i] - b[i];
    return difference;
}

// The heights over the reference in all cells, and the errors of those that were filled: of one field, or of two whose
// errors are independent.
struct Filled {
    std::vector<double> difference;
    std::vector<FilledCells> fields;

    double sigma2(std::size_t cell) const
    {
        double sum = 0;
        for (const FilledCells& field : fields)
            sum += field.sigma[cell] * field.sigma[cell] + field.step[cell] * field.step[cell];
        return sum;
    }
    double uncertainty(const std::vector<double>& weights, std::size_t columns) const
    {
        double squares = 0;
        for (const FilledCells& field : fields) squares += std::pow(gap_uncertainty(field, weights, columns), 2);
        return std::sqrt(squares);
    }
};

// NaN where not all surfaces are known.
std::vector<double> difference_of(const std::vector<Surface2d>& surfaces)
{
    return surfaces.size() > 1 ? minus(surfaces[0].height, surfaces[1].height) : surfaces[0].height;
}

double spread_within(const std::vector<HeightCell>& cells)
{
    double squares = 0, freedom = 0;
    for (const HeightCell& cell : cells)
        if (cell.points > 1) {
            squares += cell.squares;
            freedom += static_cast<double>(cell.points - 1);
        }
    return freedom > 0 ? std::sqrt(squares / freedom) : 0;
}

// Two surfaces are filled one by one, or as their difference, which is smooth where little has changed (McNabb, Nuth,
// Kaab, Girod 2019, "Sensitivity of glacier volume change estimation to DEM void interpolation", The Cryosphere 13):
// what comes out less uncertain.
Filled fill(const std::vector<Surface2d>& surfaces, const std::vector<double>& areas, std::size_t columns,
            double spread, const std::function<void()>& check)
{
    Filled whole;
    if (surfaces.size() == 1) {
        whole.fields.push_back(fill_gaps(surfaces[0].height, areas, columns, spread, check));
        whole.difference = whole.fields[0].height;
        return whole;
    }
    whole.fields.push_back(
        fill_gaps(minus(surfaces[0].height, surfaces[1].height), areas, columns, spread * std::sqrt(2.0), check));
    whole.difference = whole.fields[0].height;
    if (!whole.fields[0].filled) {
        bool known = false;
        for (const double d : whole.difference) known = known || !std::isnan(d);
        if (known) return whole;
    }
    Filled apart;
    for (const Surface2d& surface : surfaces)
        apart.fields.push_back(fill_gaps(surface.height, areas, columns, spread, check));
    apart.difference = minus(apart.fields[0].height, apart.fields[1].height);
    const bool together =
        whole.fields[0].filled && whole.uncertainty(areas, columns) <= apart.uncertainty(areas, columns);
    return together ? whole : apart;
}

// Two by two cells as one, over the area of those of them that have points of their own.
void add_coarse(VolumeReport& report, const CellGrid& grid, const std::vector<std::vector<HeightCell>>& cells,
                CellHeight height)
{
    const std::size_t columns = (grid.columns() + 1) / 2, rows = (grid.rows() + 1) / 2;
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column) {
            std::vector<HeightCell> merged(cells.size());
            double area = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t x = 2 * column + k % 2, y = 2 * row + k / 2;
                if (x >= grid.columns() || y >= grid.rows()) continue;
                const std::size_t cell = y * grid.columns() + x;
                bool counts = true;
                for (const auto& surface : cells) counts = counts && surface[cell].points > 0;
                if (!counts) continue;
                area += grid.area(cell);
                for (std::size_t s = 0; s < cells.size(); ++s) merged[s].add(cells[s][cell]);
            }
            if (!(area > 0) || merged[0].points == 0) continue;
            double d = surface_of({merged[0]}, height).height[0];
            if (cells.size() > 1) d -= surface_of({merged[1]}, height).height[0];
            (d > 0 ? report.cut_coarse : report.fill_coarse) += std::fabs(d) * area;
        }
}

// Adds a cell that counts.
void add_height(double d, double area, VolumeReport& report)
{
    (d > 0 ? report.cut : report.fill) += std::fabs(d) * area;
    (d > 0 ? report.cut_squares : report.fill_squares) += d * d * area;
}

}  // namespace

void add_volumes(VolumeReport& report, const CellGrid& grid, const std::vector<std::vector<HeightCell>>& cells,
                 CellHeight height, EmptyCells empty, const std::function<void()>& check)
{
    add_coarse(report, grid, cells, height);
    std::vector<Surface2d> surfaces;
    double spread = 0;
    for (const auto& cloud_cells : cells) {
        surfaces.push_back(surface_of(cloud_cells, height));
        spread = std::max(spread, spread_within(cloud_cells));
    }
    std::vector<double> areas(grid.size());
    for (std::size_t cell = 0; cell < grid.size(); ++cell) areas[cell] = grid.area(cell);
    const Filled filled = empty == EmptyCells::interpolated ? fill(surfaces, areas, grid.columns(), spread, check)
                                                            : Filled{difference_of(surfaces), {}};
    std::vector<double> all_gaps(grid.size(), 0), cut_gaps(all_gaps), fill_gaps(all_gaps);
    double net = 0, cut = 0, fill = 0;
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
        const double area = areas[cell];
        if (!(area > 0)) continue;
        ++report.cells;
        bool has_data = true;
        for (const auto& cloud_cells : cells) has_data = has_data && cloud_cells[cell].points > 0;
        if (!has_data) {
            ++report.cells_without_data;
            report.area_without_data += area;
        }
        const double d = filled.difference[cell];
        if (std::isnan(d)) continue;
        report.area_counted += area;
        add_height(d, area, report);
        // A surface that has points in the cell, in any case.
        double variance = 0;
        for (const Surface2d& surface : surfaces) variance += surface.variance[cell];
        const double gap_variance = has_data ? 0 : filled.sigma2(cell);
        const Parts parts = parts_of(d, std::sqrt(variance + gap_variance));
        net += variance * area * area;
        cut += variance * area * area * parts.cut * parts.cut;
        fill += variance * area * area * (1 - parts.cut) * (1 - parts.cut);
        report.excess += parts.excess * area;
        if (has_data) {
            (d > 0 ? report.cut_measured : report.fill_measured) += std::fabs(d) * area;
            continue;
        }
        report.area_interpolated += area;
        for (const FilledCells& field : filled.fields)
            if (field.outer[cell]) {
                report.area_extrapolated += area;
                break;
            }
        all_gaps[cell] = area;
        cut_gaps[cell] = area * parts.cut;
        fill_gaps[cell] = area * (1 - parts.cut);
    }
    report.net_spread = std::sqrt(net);
    report.cut_spread = std::sqrt(cut);
    report.fill_spread = std::sqrt(fill);
    report.net_gaps = filled.uncertainty(all_gaps, grid.columns());
    report.cut_gaps = filled.uncertainty(cut_gaps, grid.columns());
    report.fill_gaps = filled.uncertainty(fill_gaps, grid.columns());
}

std::vector<MeasureValue> VolumeReport::values() const
{
    const double net_coarse = (cut_measured - fill_measured) - (cut_coarse - fill_coarse);
    // What the area that counts for nothing may hold, by the heights of the rest. Their mean is near 0 where the
    // reference goes through the surface, and says nothing then.
    const auto left_out = [this](double squares) {
        return area_counted > 0 ? std::max(0.0, area - area_counted) * std::sqrt(squares / area_counted) : 0;
    };
    const auto root = [](std::initializer_list<double> parts) {
        double squares = 0;
        for (const double part : parts) squares += part * part;
        return std::sqrt(squares);
    };
    return {{"net", net(), root({net_spread, net_gaps, net_coarse, left_out(cut_squares + fill_squares)}), "^3"},
            {"cut", cut, root({cut_spread, cut_gaps, cut_measured - cut_coarse, excess, left_out(cut_squares)}), "^3"},
            {"fill", fill, root({fill_spread, fill_gaps, fill_measured - fill_coarse, excess, left_out(fill_squares)}),
             "^3"},
            {"area with points", 100 * covered(), 0, "%"},
            {"area without data", area_without_data, 0, "^2"},
            {"area extrapolated", area_extrapolated, 0, "^2"},
            {"cell side", side, 0, ""}};
}

std::vector<std::string> VolumeReport::notes() const
{
    constexpr double much = 0.05;
    const auto percent = [&](double part) { return brief(std::round(1000 * part / area) / 10) + " %"; };
    std::vector<std::string> notes;
    for (const double repeated : repeats)
        if (repeated > 1.5)
            notes.push_back("there are " + brief(repeated) +
                            " points at each place in the mean: they count as one measurement");
    const double left_out = area - area_counted;
    if (covered() < 0.5)
        notes.push_back(
            "less than half of the polygon's area has points, " + percent(area - area_without_data) + ", in cells " +
            brief(side) + " wide: the rest is " + (left_out > area_interpolated ? "left out" : "interpolated") +
            (usual_side > 1.25 * side ? "; cells " + brief(usual_side) + " wide would have 9 points each" : ""));
    if (left_out > 1e-6 * area && covered() >= 0.5)
        notes.push_back("the volume is that of the " + percent(area_counted) +
                        " of the polygon's area that have points");
    if (area_extrapolated > much * area)
        notes.push_back(percent(area_extrapolated) +
                        " of the area lie outside the points and are extrapolated; a polygon within "
                        "the points has a more certain volume");
    return notes;
}

}  // namespace pcm
