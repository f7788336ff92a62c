#include "pcm/measure/volume.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/numbers.h"
#include "pcm/measure/cell_grid.h"
#include "pcm/measure/height_cells.h"
#include "pcm/measure/measure_values.h"
#include "pcm/measure/placed_cloud.h"
#include "pcm/measure/refuse.h"
#include "pcm/measure/repeated_points.h"
#include "pcm/measure/volume_sums.h"
#include "pcm/system/error.h"
#include "pcm/system/seconds.h"
#include "pcm/system/text.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace pcm {
namespace {

constexpr double points_per_cell = 9;

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

// To begin with, by what the index knows of the box around the polygon.
double expected_side(const PlacedCloud& cloud, const Query& query, const Box3d& box)
{
    const double area = box.extent(0) * box.extent(1);
    const double points = std::max(1.0, cloud.cloud().estimate(query).points_expected);
    return std::sqrt(area * std::min(1.0, points_per_cell / points));
}

// Gaps in the cloud do not make cells wider: only those that have points count, of cells wide enough to have some.
double side_for(const std::vector<HeightCell>& cells, std::size_t columns, double side)
{
    std::vector<std::uint64_t> counts;
    for (const HeightCell& cell : cells) counts.push_back(cell.points);
    for (;;) {
        double points = 0, occupied = 0;
        for (const std::uint64_t count : counts) {
            points += static_cast<double>(count);
            occupied += count > 0;
        }
        if (!(points > 0)) return side;
        if (points >= points_per_cell / 2 * occupied || counts.size() == 1)
            return side * std::sqrt(points_per_cell * occupied / points);
        const std::size_t rows = counts.size() / columns, half = (columns + 1) / 2;
        std::vector<std::uint64_t> merged(half * ((rows + 1) / 2), 0);
        for (std::size_t k = 0; k < counts.size(); ++k) merged[k / columns / 2 * half + k % columns / 2] += counts[k];
        counts = std::move(merged);
        columns = half;
        side *= 2;
    }
}

double two_digits(double side)
{
    const double unit = std::pow(10.0, std::floor(std::log10(side)) - 1);
    // 0.25 and not 25 * 0.01
    return unit < 1 ? std::round(side / unit) / std::round(1 / unit) : std::round(side / unit) * unit;
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
    double within_memory(double side) const;
    bool improve_side(const std::vector<std::vector<HeightCell>>& cells, std::size_t columns, int pass);
    std::vector<std::vector<HeightCell>> read(const CellGrid& grid);
    std::vector<HeightCell> read(std::size_t number, const CellGrid& grid);

    const VolumeOptions& options_;
    std::vector<PlacedCloud> clouds_;
    std::vector<Vec2d> polygon_;
    Box3d box_;
    HeightPlane base_;  // heights of both clouds are relative to it
    VolumeReport report_;
};

// What is kept of each cell of the grid, of one cloud and of each more.
double bytes_per_cell(std::size_t clouds) { return 220 + 110 * (static_cast<double>(clouds) - 1); }

double Volume::within_memory(double side) const
{
    const double most = static_cast<double>(options_.memory) / bytes_per_cell(clouds_.size());
    if (most < 1)
        refuse(bytes_text(options_.memory) + " of memory do not hold one cell", "give more memory, such as 512M");
    const double least = 1.01 * std::sqrt(report_.area / std::max(1.0, most));
    if (CellGrid::cells_of(polygon_, side) > most) side = std::max(side, least);
    while (CellGrid::cells_of(polygon_, side) > most) side *= 1.05;
    return side;
}

void Volume::choose_side()
{
    require_coordinate("the reference height", options_.reference.height);
    base_ = options_.reference;
    if (clouds_.size() > 1) {
        base_ = {};
        base_.height = clouds_[0].bounds().min[2];
    }
    report_.side = options_.side;
    require_coordinate("the side of a cell", options_.side);
    if (!(options_.side >= 0) || !std::isfinite(options_.side)) refuse("the side of a cell is negative or not finite");
    if (report_.side == 0) {
        for (std::size_t k = 0; k < clouds_.size(); ++k)
            report_.side =
                std::max(report_.side, expected_side(clouds_[k], query_of(clouds_[k], k == 1, options_, box_), box_));
        report_.side = within_memory(two_digits(report_.side));
    }
    const double side = within_memory(report_.side);
    if (side > report_.side) {
        const double cells = CellGrid::cells_of(polygon_, report_.side), bytes = bytes_per_cell(clouds_.size());
        refuse("cells with a side of " + exact(report_.side) + " are " + brief(cells) + ", which takes " +
                   bytes_text(static_cast<std::uint64_t>(std::min(1e18, cells * bytes))) + " of memory, more than " +
                   bytes_text(options_.memory),
               "take a side of " + brief(1.1 * side) + " or more, or a smaller polygon");
    }
}

// Whether the points have to be read again for other cells, after they were read `pass` times before.
bool Volume::improve_side(const std::vector<std::vector<HeightCell>>& cells, std::size_t columns, int pass)
{
    constexpr int most_passes = 2;
    constexpr double near_enough = 1.25;
    double side = 0;
    for (const std::vector<HeightCell>& one : cells) side = std::max(side, side_for(one, columns, report_.side));
    side = within_memory(two_digits(side));
    report_.usual_side = options_.side == 0 ? report_.side : side;
    if (options_.side > 0 || pass == most_passes) return false;
    if (side < near_enough * report_.side && report_.side < near_enough * side) return false;
    report_.side = side;
    return true;
}

std::vector<std::vector<HeightCell>> Volume::read(const CellGrid& grid)
{
    std::vector<std::vector<HeightCell>> cells;
    report_.points = {};
    for (std::size_t number = 0; number < clouds_.size(); ++number) {
        cells.push_back(read(number, grid));
        if (report_.points[number] == 0)
            refuse("no point of " + clouds_[number].cloud().tree()->folder().string() +
                       " is in the polygon: there is no volume",
                   extent_text(clouds_[number].bounds()));
    }
    return cells;
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
    EvenSample sample;
    for (PointView view; cursor.getNextData(view);)
        for (std::size_t i = 0; i < view.size(); ++i) {
            const Vec3d p = cloud.position(view, i);
            const std::size_t cell = grid.cell_of(p[0], p[1]);
            if (cell == grid.size()) continue;
            cells[cell].add(p[2] - base_.at(p[0], p[1]));
            ++report_.points[number];
            sample.add(view.position(i));
        }
    report_.outcome.points_in += cursor.statistics().points_read;
    // Chance makes it some hundredths more than 1 in a sample.
    constexpr double least_repeats = 1.05;
    report_.repeats[number] = points_per_place(cloud.cloud(), sample.points(), options_.level);
    if (report_.repeats[number] > least_repeats)
        for (HeightCell& cell : cells) cell.count_places(report_.repeats[number]);
    return cells;
}

VolumeReport Volume::run()
{
    const auto start = std::chrono::steady_clock::now();
    std::optional<CellGrid> grid;
    std::vector<std::vector<HeightCell>> cells;
    for (int pass = 0; pass == 0 || improve_side(cells, grid->columns(), pass); ++pass) {
        cells.clear();
        grid.emplace(polygon_, report_.side);
        cells = read(*grid);
    }
    Watch watch(options_.progress);
    add_volumes(report_, *grid, cells, options_.height, options_.empty, [&] { watch.report("Filling gaps", 0.95); });
    if (!(report_.area_counted > 0))
        refuse("no cell has points of both clouds: there is no volume", "take a larger side, or interpolate");
    report_.outcome.points_out = report_.points[0] + report_.points[1];
    report_.outcome.error = report_.values()[0].uncertainty;
    report_.outcome.error_meaning = "uncertainty of the net volume (one standard deviation), source units cubed";
    report_.outcome.seconds = seconds_since(start);
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
    if (!(std::fabs(n[2]) > 1e-9)) refuse("a vertical plane cannot be the reference of a volume: it has no heights");
    return {point[0], point[1], point[2], -n[0] / n[2], -n[1] / n[2]};
}

VolumeReport measure_volume(PointCloud& cloud, const VolumeOptions& options)
{
    if (cloud.info().points == 0) refuse(cloud.tree()->folder().string() + " has no points: there is no volume");
    return Volume(cloud, options).run();
}

}  // namespace pcm
