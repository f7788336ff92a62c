// Volumes between a cloud's surface and a level, a plane or another cloud's surface, in a polygon seen from above.
//
// The polygon is divided into square cells. The surface's height in a cell is the mean of the heights of the points in
// it (or the lowest or the highest). With d = height of the cloud - height of the reference, and A the area of the
// polygon in the cell:
//
//     cut = sum of d A over cells with d > 0       what lies above the reference, to be taken away
//     fill = sum of -d A over cells with d < 0     what is missing below it
//     net = cut - fill
//
// So for two clouds, the first after and the second before, `cut` is what was added and `fill` what was taken away.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/measure/measure.h"
#include "pcm/point_cloud.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

enum class CellHeight : std::uint8_t { mean, lowest, highest };
enum class EmptyCells : std::uint8_t {
    left_out,      // cells without points of a cloud count for nothing; their area is reported
    interpolated,  // their heights are made from those around them: each the mean of its neighbours (Laplace)
};

// z = height + slope_x (x - x0) + slope_y (y - y0).
struct HeightPlane {
    double x0 = 0, y0 = 0, height = 0, slope_x = 0, slope_y = 0;
    double at(double x, double y) const { return height + (slope_x * (x - x0) + slope_y * (y - y0)); }
};
// The plane through `point` with this normal. Throws Error(invalid_argument) for a vertical plane.
HeightPlane plane_of(const Vec3d& point, const Vec3d& normal);

// The corners of a box in plan, at its lowest z.
std::vector<Vec3d> plan_rectangle(const Box3d& box);

struct VolumeOptions {
    std::vector<Vec3d> polygon;          // three or more points, seen from above; empty: the box of the first cloud. A
                                         // point of the cloud on the polygon's edge may count or not
    HeightPlane reference;               // not used with two clouds
    std::shared_ptr<PointCloud> before;  // the second cloud, whose surface is the reference; may be null
    // Where the clouds stand: polygon, reference, side and volumes are of that place. Absent: at their source
    // coordinates. Clips and conditions are on source coordinates and values always.
    std::optional<Affine> placement, placement_before;
    double side = 0;  // of a cell, source units; 0: so that a cell has about 9 points
    CellHeight height = CellHeight::mean;
    EmptyCells empty = EmptyCells::left_out;
    std::optional<std::uint16_t> level;               // of both clouds, or their last one; the whole clouds when absent
    std::vector<Condition> where;                     // on both clouds; all must be met
    std::vector<Clip> clips;                          // all must hold
    std::optional<Selection> limits_before;           // of the second cloud, whose `where` and `clips` hold instead
    std::uint64_t memory = std::uint64_t{512} << 20;  // for the cells; bytes
    ProgressFunction progress;
};

struct VolumeReport {
    double cut = 0, fill = 0;                                // source units, cubed
    double cut_spread = 0, fill_spread = 0, net_spread = 0;  // one standard deviation, from the spread of the heights
                                                             // in each cell: s / sqrt(n) of a mean, s of an extreme
    // Of the cells with points alone, and of cells twice as wide over the same area.
    double cut_measured = 0, fill_measured = 0;
    double cut_coarse = 0, fill_coarse = 0;
    double side = 0;
    double area = 0;          // of the polygon in plan
    double area_counted = 0;  // of the cells that count, interpolated ones among them
    double area_interpolated = 0;
    double area_without_data = 0;  // of the cells without points of a cloud, interpolated or not
    std::uint64_t cells = 0, cells_without_data = 0;
    std::array<std::uint64_t, 2> points{};  // of each cloud in the polygon
    Outcome outcome;                        // error: uncertainty of the net volume

    double net() const { return cut - fill; }
    // "net", "cut", "fill" ("^3"), "area without data", "cell side". The uncertainty of a volume is the root of the
    // squares of its spread and of the difference that coarser cells make. Interpolated cells have none of their own:
    // their area says how much they matter.
    std::vector<MeasureValue> values() const;
};

// Streams the points; memory: beside the caches', about 80 bytes a cell (130 with two clouds). Throws
// Error(invalid_argument) for a polygon that is not one, for a side that makes more cells than fit in the memory (it
// says which side would), for a placement that flattens, and when no cell counts; Error(cancelled); and what
// PointCloud::points() throws.
VolumeReport measure_volume(PointCloud& cloud, const VolumeOptions& options);

}  // namespace pcm
