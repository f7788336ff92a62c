#include "pcm/filter/voxel_grid.h"

#include "pcm/filter/voxel_unit_points.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/unique_name.h"
#include "pcm/threads/task_pool.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/tree_reader.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <deque>
#include <optional>
#include <utility>

namespace pcm {
namespace {

// Memory that a point takes while its unit is combined.
std::size_t bytes_of_point(const Schema& schema)
{
    constexpr std::size_t position = 24, keys = 2 * 8, order = 8, result = 24;
    return position + keys + order + result + 2 * schema.point_bytes();
}

// Points whose processing is worth a box of their own.
constexpr std::uint64_t least_held_points = 4096, most_held_points = std::uint64_t(1) << 22;

bool has(const Schema& schema, std::string_view name) { return schema.find(name).has_value(); }

}  // namespace

class VoxelGridReader::Work {
public:
    Work(std::shared_ptr<const Tree> tree, const VoxelGridOptions& options)
        : options_(options),
          threads_(std::min(thread_count(options.threads), TaskPool::most_threads)),
          cloud_(tree),
          combinations_(combinations_of(tree->info().schema, options.by_majority, options.by_mean)),
          info_(TreeReader(tree, std::nullopt, Selection()).info())
    {
        const TreeInfo& from = tree->info();
        const bool integers = from.position_type == ScalarType::i32;
        check_voxels(options_.voxels, from.bounds(), integers ? &from.grid : nullptr);
        describe(from);
        const std::uint64_t memory = options.memory_bytes / (threads_ + 1);
        most_points_ = static_cast<std::size_t>(
            std::clamp<std::uint64_t>(memory / bytes_of_point(from.schema), least_held_points, most_held_points));
        // The estimate is exceeded rarely where it leaves some room.
        units_ = divide_into_units(cloud_, options_.voxels, 0.8 * static_cast<double>(most_points_));
    }
    ~Work() { stopped_ = true; }

    bool read(PointBatch& batch, std::size_t max_points)
    {
        while (next_point_ == current_.points.size)
            if (!next_unit()) {
                info_.points = points_out_;
                shape_batch(batch, info_.schema, info_.grid.has_value(), 0);
                return false;
            }
        const std::size_t count = std::min({std::max<std::size_t>(max_points, 1), current_.points.size - next_point_,
                                            points_that_fit_a_batch(info_.schema)});
        shape_batch(batch, info_.schema, info_.grid.has_value(), count);
        for (std::size_t a = 0; a < 3; ++a) {
            if (batch.gridded)
                std::copy_n(current_.points.grid_xyz[a].data() + next_point_, count, batch.grid_xyz[a].data());
            else
                std::copy_n(current_.points.xyz[a].data() + next_point_, count, batch.xyz[a].data());
        }
        for (std::size_t k = 0; k < batch.attributes.size(); ++k) {
            const std::size_t bytes = batch.attributes[k].point_bytes();
            std::memcpy(batch.attributes[k].data(), current_.points.attributes[k].data() + next_point_ * bytes,
                        count * bytes);
        }
        next_point_ += count;
        return true;
    }

    const FileInfo& info() const { return info_; }
    double fraction() const
    {
        if (info_.points == 0 || units_.empty()) return 1;
        return static_cast<double>(points_in_) / static_cast<double>(cloud_.tree().info().points);
    }
    std::uint64_t points_in() const { return points_in_; }
    std::uint64_t points_out() const { return points_out_; }
    std::uint64_t most_in_one() const { return most_in_one_; }

private:
    void describe(const TreeInfo& from)
    {
        info_.points_known = from.points == 0;
        if (options_.point == VoxelPoint::centroid) {
            info_.position_type = ScalarType::f64;
            info_.grid.reset();
            info_.near_grid.reset();
            if (has(from.schema, attribute_name::radius))
                info_.notes.push_back(
                    "'radius' is the mean of the points' radii; the points of a voxel grid are further apart, so "
                    "estimate radii again before splats are drawn with them");
        }
        if (!options_.count) return;
        const std::string name = unique_name(from.schema, point_count_name);
        info_.schema.add({name, ScalarType::u32, 1, 1, 0, "number of points in the voxel"});
        if (name != point_count_name)
            info_.notes.push_back("the points have an attribute '" + std::string(point_count_name) +
                                  "' already; the number of points in a voxel is '" + name + "'");
    }

    bool next_unit()
    {
        current_ = VoxelPoints();
        next_point_ = 0;
        for (; next_ahead_ < units_.size() && ahead_.size() < threads_; ++next_ahead_)
            ahead_.emplace_back(pool_, threads_, [this, unit = units_[next_ahead_]] {
                return combine_unit(
                    {cloud_, options_, combinations_, info_.schema, info_.grid.has_value(), most_points_, stopped_},
                    unit);
            });
        if (ahead_.empty()) return false;
        Pending<VoxelPoints> next = std::move(ahead_.front());
        ahead_.pop_front();
        current_ = next.get();
        points_in_ += current_.points_in;
        points_out_ += current_.points.size;
        most_in_one_ = std::max(most_in_one_, current_.most_in_one);
        return true;
    }

    const VoxelGridOptions options_;
    const unsigned threads_;
    const PointsInBoxes cloud_;
    const std::vector<Combination> combinations_;
    FileInfo info_;
    std::size_t most_points_ = 0;
    std::vector<VoxelUnit> units_;
    std::size_t next_ahead_ = 0;
    VoxelPoints current_;
    std::size_t next_point_ = 0;
    std::uint64_t points_in_ = 0, points_out_ = 0, most_in_one_ = 0;
    std::atomic<bool> stopped_{false};
    TaskPool pool_;
    std::deque<Pending<VoxelPoints>> ahead_;
};

VoxelGridReader::VoxelGridReader(std::shared_ptr<const Tree> tree, const VoxelGridOptions& options)
    : work_(std::make_unique<Work>(std::move(tree), options))
{
}

VoxelGridReader::~VoxelGridReader() = default;

const FileInfo& VoxelGridReader::info() const { return work_->info(); }

bool VoxelGridReader::read(PointBatch& batch, std::size_t max_points) { return work_->read(batch, max_points); }

double VoxelGridReader::fraction_read() const { return work_->fraction(); }

std::uint64_t VoxelGridReader::points_in() const { return work_->points_in(); }

std::uint64_t VoxelGridReader::points_out() const { return work_->points_out(); }

std::uint64_t VoxelGridReader::most_in_one() const { return work_->most_in_one(); }

VoxelGridReport voxel_grid(const std::filesystem::path& tree, const VoxelGridOptions& options,
                           const ResultOptions& result)
{
    VoxelGridOptions own = options;
    own.memory_bytes = result.reader_memory();
    own.threads = result.threads;
    std::shared_ptr<VoxelGridReader> points;
    VoxelGridReport report;
    report.build = build_result(tree, result, [&](std::shared_ptr<const Tree> from) {
        return points = std::make_shared<VoxelGridReader>(std::move(from), own);
    });
    report.build.outcome.points_in = points->points_in();
    report.most_in_one = points->most_in_one();
    return report;
}

}  // namespace pcm
