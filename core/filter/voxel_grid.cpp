#include "pcm/filter/voxel_grid.h"

#include "pcm/filter/voxel_unit_points.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/pipe/held_reader.h"
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

// Points whose processing is worth a box of their own.
constexpr std::uint64_t least_held_points = 4096, most_held_points = std::uint64_t(1) << 22;

bool has(const Schema& schema, std::string_view name) { return schema.find(name).has_value(); }

}  // namespace

FileInfo info_of_voxels(FileInfo from, const VoxelGridOptions& options)
{
    from.points_known = from.points == 0;
    if (options.point == VoxelPoint::centroid) {
        from.position_type = ScalarType::f64;
        from.grid.reset();
        from.near_grid.reset();
        if (has(from.schema, attribute_name::radius))
            from.notes.push_back(
                "'radius' is the mean of the points' radii; the points of a voxel grid are further apart, so "
                "estimate radii again before splats are drawn with them");
    }
    if (!options.count) return from;
    const std::string name = unique_name(from.schema, point_count_name);
    from.schema.add({name, ScalarType::u32, 1, 1, 0, "number of points in the voxel"});
    if (name != point_count_name)
        from.notes.push_back("the points have an attribute '" + std::string(point_count_name) +
                             "' already; the number of points in a voxel is '" + name + "'");
    return from;
}

class VoxelGridReader::Work {
public:
    Work(std::shared_ptr<const Tree> tree, const VoxelGridOptions& options)
        : options_(options),
          threads_(std::min(thread_count(options.threads), TaskPool::most_threads)),
          cloud_(tree),
          combinations_(combinations_of(tree->info().schema, options.by_majority, options.by_mean)),
          info_(info_of_voxels(TreeReader(tree, std::nullopt, Selection()).info(), options))
    {
        const TreeInfo& from = tree->info();
        const bool integers = from.position_type == ScalarType::i32;
        check_voxels(options_.voxels, from.bounds(), integers ? &from.grid : nullptr);
        const std::uint64_t memory = options.memory_bytes / (threads_ + 1);
        most_points_ = static_cast<std::size_t>(
            std::clamp<std::uint64_t>(memory / bytes_of_held_point(from.schema), least_held_points, most_held_points));
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
        next_point_ += copy_some(current_.points, next_point_, info_.schema, max_points, batch);
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
    bool next_unit()
    {
        current_ = VoxelPoints();
        next_point_ = 0;
        for (; next_ahead_ < units_.size() && ahead_.size() < threads_; ++next_ahead_)
            ahead_.emplace_back(pool_, threads_, [this, unit = units_[next_ahead_]] {
                const VoxelRules rules{options_, combinations_, cloud_.tree().info().schema, info_.schema,
                                       info_.grid.has_value()};
                return combine_unit({rules, cloud_, most_points_, stopped_}, unit);
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
        report.box = from->info().bounds();
        return points = std::make_shared<VoxelGridReader>(std::move(from), own);
    });
    report.build.outcome.points_in = points->points_in();
    report.most_in_one = points->most_in_one();
    return report;
}

}  // namespace pcm
