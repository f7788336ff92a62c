#include "pcm/measure/volume.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/measure/cell_grid.h"
#include "pcm/measure/height_cells.h"
#include "pcm/measure/measure_values.h"
#include "pcm/measure/placed_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace pcm {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double points_per_cell = 9;

[[noreturn]] void refuse(const std::string& what, const std::string& hint = {})
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

std::vector<Vec3d> polygon_of(const PlacedCloud& cloud, const VolumeOptions& options)
{
    return options.polygon.empty() ? plan_rectangle(cloud.bounds()) : options.polygon;
}

// Checked as the polygon of a measure.
double plan_area(const std::vector<Vec3d>& polygon)
{
    Measure measure;
    measure.kind = MeasureKind::volume;
    for (const Vec3d& p : polygon) measure.points.push_back({p, 0, 0, ""});
    return values_of(measure).at(0).value;
}

// Unbounded along z.
Box3d box_of(const std::vector<Vec2d>& polygon)
{
    Box3d box;
    for (const Vec2d& p : polygon) box.extend(Vec3d{p[0], p[1], 0});
    box.min[2] = -infinity;
    box.max[2] = infinity;
    return box;
}

Query query_of(const PlacedCloud& cloud, bool is_before, const VolumeOptions& options, const Box3d& box)
{
    Query query;
    if (is_before && options.limits_before) {
        query.where = options.limits_before->where;
        query.clips = options.limits_before->clips;
    } else {
        query.where = options.where;
        query.clips = options.clips;
    }
    const TreeInfo& info = cloud.cloud().info();
    if (options.level && info.levels > 0)
        query.level = std::min<std::uint16_t>(*options.level, static_cast<std::uint16_t>(info.levels - 1));
    if (cloud.moved())
        query.region = cloud.own_region(Region::box(box));
    else
        query.box = box;
    return query;
}

// So that a cell has some points: if the index knows of none there, all is one cell.
double usual_side(const PlacedCloud& cloud, const Query& query, const Box3d& box)
{
    const double area = box.extent(0) * box.extent(1);
    const double points = std::max(1.0, cloud.cloud().estimate(query).points_expected);
    return std::sqrt(area * std::min(1.0, points_per_cell / points));
}

class Volume {
public:
    Volume(PointCloud& cloud, const VolumeOptions& options)
        : options_(options),
          clouds_{{cloud, options.placement}},
          polygon_(in_plan(polygon_of(clouds_[0], options))),
          box_(box_of(polygon_))
    {
        if (options.before) clouds_.emplace_back(*options.before, options.placement_before);
        report_.area = plan_area(polygon_of(clouds_[0], options));
        choose_side();
    }
    VolumeReport run();

private:
    void choose_side();
    std::vector<HeightCell> read(std::size_t number, const CellGrid& grid);
    void add_cells(const CellGrid& grid, const std::vector<Surface2d>& surfaces,
                   const std::vector<std::vector<double>>& known);
    void add_coarse(const CellGrid& grid, const std::vector<std::vector<HeightCell>>& cells);
    double difference(const std::vector<Surface2d>& surfaces, std::size_t cell) const
    {
        return surfaces.size() > 1 ? surfaces[0].height[cell] - surfaces[1].height[cell] : surfaces[0].height[cell];
    }

    const VolumeOptions& options_;
    std::vector<PlacedCloud> clouds_;
    std::vector<Vec2d> polygon_;
    Box3d box_;
    HeightPlane base_;  // heights of both clouds are relative to it
    VolumeReport report_;
};

void Volume::choose_side()
{
    require_coordinate("the reference height", options_.reference.height);
    base_ = options_.reference;
    if (clouds_.size() > 1) {
        base_ = {};
        base_.height = clouds_[0].bounds().min[2];
    }
    report_.side = options_.side;
    if (!(options_.side >= 0) || !std::isfinite(options_.side)) refuse("the side of a cell is negative or not finite");
    const double bytes = 9 + static_cast<double>(clouds_.size()) * (sizeof(HeightCell) + 3 * sizeof(double));
    const double most = static_cast<double>(options_.memory) / bytes;
    const double least_side = 1.01 * std::sqrt(report_.area / std::max(1.0, most));
    if (report_.side == 0) {
        for (std::size_t k = 0; k < clouds_.size(); ++k)
            report_.side =
                std::max(report_.side, usual_side(clouds_[k], query_of(clouds_[k], k == 1, options_, box_), box_));
        while (CellGrid::cells_of(polygon_, report_.side) > most)
            report_.side = std::max(1.2 * report_.side, least_side);
    }
    const double cells = CellGrid::cells_of(polygon_, report_.side);
    if (cells > most) {
        double side = least_side;
        while (CellGrid::cells_of(polygon_, side) > most) side *= 1.05;
        refuse("cells with a side of " + exact(report_.side) + " are " + brief(cells) + ", which takes " +
                   bytes_text(static_cast<std::uint64_t>(std::min(1e18, cells * bytes))) + " of memory, more than " +
                   bytes_text(options_.memory),
               "take a side of " + brief(1.1 * side) + " or more, or a smaller polygon");
    }
}

std::vector<HeightCell> Volume::read(std::size_t number, const CellGrid& grid)
{
    std::vector<HeightCell> cells(grid.size());
    const PlacedCloud& cloud = clouds_[number];
    Query query = query_of(cloud, number == 1, options_, box_);
    if (options_.progress)
        query.progress = [&, this](const ProgressUpdate& update) {
            ProgressUpdate whole = update;
            whole.stage = "Reading heights";
            whole.fraction = (static_cast<double>(number) + update.fraction) / static_cast<double>(clouds_.size());
            whole.seconds_left = -1;
            return options_.progress(whole);
        };
    PointCursor cursor = cloud.cloud().points(query);
    for (PointView view; cursor.getNextData(view);)
        for (std::size_t i = 0; i < view.size(); ++i) {
            const Vec3d p = cloud.position(view, i);
            const std::size_t cell = grid.cell_of(p[0], p[1]);
            if (cell == grid.size()) continue;
            cells[cell].add(p[2] - base_.at(p[0], p[1]));
            ++report_.points[number];
        }
    report_.outcome.points_in += cursor.statistics().points_read;
    return cells;
}

void Volume::add_cells(const CellGrid& grid, const std::vector<Surface2d>& surfaces,
                       const std::vector<std::vector<double>>& known)
{
    double cut = 0, fill = 0;
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
        const double area = grid.area(cell);
        if (!(area > 0)) continue;
        ++report_.cells;
        bool has_data = true;
        for (const std::vector<double>& heights : known) has_data = has_data && !std::isnan(heights[cell]);
        if (!has_data) {
            ++report_.cells_without_data;
            report_.area_without_data += area;
        }
        const double d = difference(surfaces, cell);
        if (std::isnan(d)) continue;
        report_.area_counted += area;
        if (!has_data) report_.area_interpolated += area;
        double variance = 0;
        for (const Surface2d& surface : surfaces) variance += surface.variance[cell] * area * area;
        (d > 0 ? report_.cut : report_.fill) += std::fabs(d) * area;
        if (has_data) (d > 0 ? report_.cut_measured : report_.fill_measured) += std::fabs(d) * area;
        (d > 0 ? cut : fill) += variance;
    }
    report_.cut_spread = std::sqrt(cut);
    report_.fill_spread = std::sqrt(fill);
    report_.net_spread = std::sqrt(cut + fill);
}

// Two by two cells as one, over the area of those of them that count and have points of their own.
void Volume::add_coarse(const CellGrid& grid, const std::vector<std::vector<HeightCell>>& cells)
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
            std::vector<Surface2d> surfaces;
            for (const HeightCell& one : merged) surfaces.push_back(surface_of({one}, options_.height));
            const double d = difference(surfaces, 0);
            (d > 0 ? report_.cut_coarse : report_.fill_coarse) += std::fabs(d) * area;
        }
}

VolumeReport Volume::run()
{
    const auto start = std::chrono::steady_clock::now();
    const CellGrid grid(polygon_, report_.side);
    std::vector<std::vector<HeightCell>> cells;
    for (std::size_t number = 0; number < clouds_.size(); ++number) cells.push_back(read(number, grid));
    std::vector<Surface2d> surfaces;
    for (const auto& one : cells) surfaces.push_back(surface_of(one, options_.height));
    add_coarse(grid, cells);
    cells.clear();
    std::vector<std::vector<double>> known;
    for (Surface2d& surface : surfaces) known.push_back(surface.height);
    if (options_.empty == EmptyCells::interpolated) {
        std::vector<double> areas(grid.size());
        for (std::size_t cell = 0; cell < grid.size(); ++cell) areas[cell] = grid.area(cell);
        for (Surface2d& surface : surfaces) fill_gaps(surface.height, areas, grid.columns());
    }
    add_cells(grid, surfaces, known);
    for (std::size_t number = 0; number < clouds_.size(); ++number)
        if (report_.points[number] == 0)
            refuse("no point of " + clouds_[number].cloud().tree()->folder().string() +
                       " is in the polygon: there is no volume",
                   extent_text(clouds_[number].bounds()));
    if (!(report_.area_counted > 0))
        refuse("no cell has points of both clouds: there is no volume", "take a larger side");
    report_.outcome.points_out = report_.points[0] + report_.points[1];
    report_.outcome.error = report_.values()[0].uncertainty;
    report_.outcome.error_meaning = "uncertainty of the net volume (one standard deviation), source units cubed";
    report_.outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report_;
}

}  // namespace

std::vector<Vec3d> plan_rectangle(const Box3d& box)
{
    return {box.min,
            {box.max[0], box.min[1], box.min[2]},
            {box.max[0], box.max[1], box.min[2]},
            {box.min[0], box.max[1], box.min[2]}};
}

HeightPlane plane_of(const Vec3d& point, const Vec3d& normal)
{
    require_place("the point of the plane,", point);
    require_place("the normal of the plane,", normal);
    if (!(length(normal) > 0)) refuse("the normal of the plane has the length 0", "give a direction such as 0 0 1");
    const Vec3d n = normalised(normal);
    if (!(std::fabs(n[2]) > 1e-9)) refuse("a vertical plane is no reference for a volume: it has no heights");
    return {point[0], point[1], point[2], -n[0] / n[2], -n[1] / n[2]};
}

std::vector<MeasureValue> VolumeReport::values() const
{
    return {{"net", net(), std::hypot(net_spread, (cut_measured - fill_measured) - (cut_coarse - fill_coarse)), "^3"},
            {"cut", cut, std::hypot(cut_spread, cut_measured - cut_coarse), "^3"},
            {"fill", fill, std::hypot(fill_spread, fill_measured - fill_coarse), "^3"},
            {"area without data", area_without_data, 0, "^2"},
            {"cell side", side, 0, ""}};
}

VolumeReport measure_volume(PointCloud& cloud, const VolumeOptions& options)
{
    if (cloud.info().points == 0) refuse(cloud.tree()->folder().string() + " has no points: there is no volume");
    return Volume(cloud, options).run();
}

}  // namespace pcm
