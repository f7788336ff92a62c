#include "pcm/filter/voxel_grid_in_memory.h"

#include "pcm/filter/voxel_unit_points.h"
#include "pcm/io/pipe/held_reader.h"
#include "pcm/system/error.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/text.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t batch_points = 65536;

struct Read {
    HeldPoints points;
    Box3d box;
    std::uint64_t left_out = 0;  // without a finite position
};

void append_positions(const PointBatch& batch, const std::optional<Grid>& grid, bool keeps_grid, Read& read)
{
    HeldPoints& held = read.points;
    for (std::size_t i = 0; i < batch.size; ++i) {
        const Vec3d p = batch.gridded
                            ? grid->to_source(Vec3i{batch.grid_xyz[0][i], batch.grid_xyz[1][i], batch.grid_xyz[2][i]})
                            : Vec3d{batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
        held.positions.push_back(p);
        read.box.extend(p);
    }
    for (std::size_t a = 0; keeps_grid && a < 3; ++a)
        held.grid[a].insert(held.grid[a].end(), batch.grid_xyz[a].begin(), batch.grid_xyz[a].end());
}

// Removes the points without a finite position from a batch. Returns their number.
std::uint64_t drop_not_finite(PointBatch& batch)
{
    if (batch.gridded) return 0;
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < batch.size; ++i)
        if (std::isfinite(batch.xyz[0][i]) && std::isfinite(batch.xyz[1][i]) && std::isfinite(batch.xyz[2][i]))
            kept.push_back(static_cast<std::uint32_t>(i));
    const std::uint64_t dropped = batch.size - kept.size();
    if (dropped) keep_points(batch, kept);
    return dropped;
}

Read read_all(PointReader& points, bool keeps_grid, const ProgressFunction& progress)
{
    Watch watch(progress);
    Read read;
    const FileInfo& info = points.info();
    HeldPoints& held = read.points;
    held.positions.reserve(info.points);
    for (std::size_t a = 0; keeps_grid && a < 3; ++a) held.grid[a].reserve(info.points);
    for (const Attribute& attribute : info.schema) {
        held.attributes.emplace_back(attribute);
        held.attributes.back().resize(info.points);
    }
    PointBatch batch;
    while (points.read(batch, batch_points)) {
        read.left_out += drop_not_finite(batch);
        const std::size_t before = held.size();
        append_positions(batch, info.grid, keeps_grid, read);
        for (std::size_t k = 0; k < batch.attributes.size(); ++k) {
            Column& to = held.attributes[k];
            if (to.size() < held.size()) to.resize(std::max(held.size(), 2 * to.size()));
            if (batch.size)
                std::memcpy(to.data() + before * to.point_bytes(), batch.attributes[k].data(),
                            batch.size * to.point_bytes());
        }
        watch.report("Reading points", points.fraction_read());
    }
    for (Column& column : held.attributes) column.resize(held.size());
    return read;
}

}  // namespace

bool fits_in_memory(const FileInfo& points, std::uint64_t memory_bytes)
{
    return points.points_known && points.points <= memory_bytes / 2 / bytes_of_held_point(points.schema);
}

VoxelGridReport voxel_grid_in_memory(PointReader& points, const std::vector<std::string>& names,
                                     const VoxelGridOptions& options, const ResultOptions& result)
{
    const std::vector<Combination> combinations =
        combinations_of(points.info().schema, options.by_majority, options.by_mean);
    const bool keeps_grid = options.point == VoxelPoint::nearest && points.info().grid.has_value();
    Read read = read_all(points, keeps_grid, part_of(result.progress, 0, 0.4));
    FileInfo from = points.info();
    check_voxels(options.voxels, read.box, from.grid ? &*from.grid : nullptr);
    if (read.left_out) from.notes.push_back(grouped(read.left_out) + " points without a finite position were left out");
    const Schema schema = from.schema;
    const FileInfo info = info_of_voxels(std::move(from), options);

    VoxelPoints voxels;
    voxels.points.reset(info.schema, keeps_grid, 0);
    combine_points({options, combinations, schema, info.schema, keeps_grid}, read.points, voxels);
    VoxelGridReport report;
    report.box = read.box;
    report.most_in_one = voxels.most_in_one;
    const std::uint64_t points_in = voxels.points_in;
    read = Read();

    const auto held = std::make_shared<const PointBatch>(std::move(voxels.points));
    BuildOptions build;
    build.memory_bytes = std::max(std::min(result.memory_bytes, least_build_memory), result.memory_bytes / 2);
    build.threads = result.threads;
    build.chunk_points = result.chunk_points;
    if (result.sampling) build.sampling = *result.sampling;
    build.overwrite = result.target.overwrite;
    build.progress = part_of(result.progress, 0.5, 1);
    report.build =
        build_or_write([&] { return std::make_unique<HeldReader>(held, info); }, names, result.target.copy, build);
    report.build.outcome.points_in = points_in;
    return report;
}

}  // namespace pcm
