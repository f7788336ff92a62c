#include "pcm/filter/spaced_points.h"

#include "pcm/cloud/box_distance.h"
#include "pcm/filter/copy_points.h"
#include "pcm/filter/kept_points.h"
#include "pcm/filter/points_in_boxes.h"
#include "pcm/filter/voxel_units.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/threads/task_pool.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/tree_reader.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

namespace pcm {
namespace {

// Memory of a kept point: its place, the table's, and in the lists of borders.
constexpr std::uint64_t bytes_of_kept = 64;
constexpr double least_unit_points = 4096;

bool near(const Box3d& a, const Box3d& b, double distance)
{
    for (std::size_t i = 0; i < 3; ++i)
        if (a.min[i] - b.max[i] > distance || b.min[i] - a.max[i] > distance) return false;
    return true;
}

bool near(const Box3d& box, const Vec3d& p, double distance) { return near(box, Box3d{p, p}, distance); }

}  // namespace

class SpacedPoints::Work {
public:
    Work(std::shared_ptr<const Tree> tree, double spacing, std::uint64_t memory_bytes, unsigned threads)
        : spacing_(spacing),
          // Neighbours may be found too many, never too few.
          reach_(spacing * (1 + 1e-9)),
          threads_(std::min(thread_count(threads), 8u)),
          cloud_(tree),
          schema_(tree->info().schema),
          info_(TreeReader(tree, std::nullopt, Selection()).info())
    {
        info_.points_known = info_.points == 0;
        make_units(static_cast<double>(memory_bytes / bytes_of_kept));
        find_neighbours();
        begin_unit();
    }

    const FileInfo& info() const { return info_; }
    double fraction() const
    {
        const std::uint64_t all = cloud_.tree().info().points;
        return all ? static_cast<double>(points_in_) / static_cast<double>(all) : 1;
    }

    bool read(PointBatch& batch, std::size_t max_points)
    {
        while (next_kept_ == kept_here_.size())
            if (!next_part()) {
                info_.points = points_out_;
                shape_batch(batch, info_.schema, info_.grid.has_value(), 0);
                return false;
            }
        const std::size_t count = std::min({std::max<std::size_t>(max_points, 1), kept_here_.size() - next_kept_,
                                            points_that_fit_a_batch(info_.schema)});
        shape_batch(batch, info_.schema, info_.grid.has_value(), count);
        const std::uint32_t* const points = kept_here_.data() + next_kept_;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                const std::int64_t q = part_.chunk.positions->grid(points[i], a);
                if (batch.gridded)
                    batch.grid_xyz[a][i] = static_cast<std::int32_t>(q);
                else
                    batch.xyz[a][i] = cloud_.source(q, a);
            }
        for (std::size_t k = 0; k < schema_.size(); ++k)
            copy_points(*part_.chunk.attributes[k], points, count, batch.attributes[k].data());
        next_kept_ += count;
        return true;
    }

private:
    // A box of the cloud; its neighbours are those less than a spacing away.
    struct Unit {
        Box3i grid;
        Box3d box;
        std::vector<std::size_t> before, after;  // neighbours, by their place in the order
        std::vector<Vec3d> border;               // points kept here that are near to a later neighbour
        std::size_t waiting = 0;                 // later neighbours that are not done
    };
    struct Job {
        std::size_t unit = 0;
        Pending<PointsInBox> points;
    };

    void make_units(double points)
    {
        const VoxelLattice lattice{spacing_, {0, 0, 0}};
        for (const VoxelUnit& voxels : divide_into_units(cloud_, lattice, std::max(points, least_unit_points))) {
            Unit unit;
            unit.grid = grid_box_of(cloud_, lattice, voxels);
            if (unit.grid.empty()) continue;
            for (std::size_t a = 0; a < 3; ++a) {
                unit.box.min[a] = cloud_.source(unit.grid.min[a], a);
                unit.box.max[a] = cloud_.source(unit.grid.max[a], a);
            }
            units_.push_back(std::move(unit));
        }
    }

    void find_neighbours()
    {
        for (std::size_t i = 0; i < units_.size(); ++i)
            for (std::size_t j = i + 1; j < units_.size(); ++j)
                if (near(units_[i].box, units_[j].box, reach_)) {
                    units_[i].after.push_back(j);
                    units_[j].before.push_back(i);
                    ++units_[i].waiting;
                }
    }

    // The points taken in the units before are taken here too, where they are near.
    void begin_unit()
    {
        if (unit_ == units_.size()) return;
        kept_.emplace(spacing_, units_[unit_].box.min);
        for (const std::size_t i : units_[unit_].before) {
            for (const Vec3d& p : units_[i].border)
                if (near(units_[unit_].box, p, reach_)) kept_->add(p);
            if (--units_[i].waiting == 0) units_[i].border = {};
        }
        from_others_ = kept_->points().size();
    }

    void end_unit()
    {
        Unit& unit = units_[unit_++];
        const std::vector<Vec3d>& points = kept_->points();
        for (std::size_t i = from_others_; i < points.size() && !unit.after.empty(); ++i)
            if (std::any_of(unit.after.begin(), unit.after.end(),
                            [&](std::size_t j) { return near(units_[j].box, points[i], reach_); }))
                unit.border.push_back(points[i]);
        begin_unit();
    }

    void read_ahead()
    {
        while (ahead_.size() <= threads_ && (next_node_ < nodes_.size() || next_unit_ < units_.size())) {
            if (next_node_ == nodes_.size()) {
                nodes_ = cloud_.nodes(units_[next_unit_++].grid);
                next_node_ = 0;
                continue;
            }
            const NodeId id = nodes_[next_node_++];
            const Box3i& box = units_[next_unit_ - 1].grid;
            ahead_.push_back({next_unit_ - 1, Pending<PointsInBox>(pool_, threads_, [this, id, box] {
                                  return cloud_.read(id, box, ColumnSet::all(schema_));
                              })});
        }
    }

    bool next_part()
    {
        part_ = PointsInBox();
        kept_here_.clear();
        next_kept_ = 0;
        read_ahead();
        if (ahead_.empty()) return false;
        Job job = std::move(ahead_.front());
        ahead_.pop_front();
        part_ = job.points.get();
        read_ahead();
        while (unit_ < job.unit) end_unit();
        positions_.clear();
        if (part_.size() > 0) cloud_.append(part_, positions_);
        for (std::size_t i = 0; i < part_.size(); ++i) {
            if (kept_->has_near(positions_[i])) continue;
            kept_->add(positions_[i]);
            kept_here_.push_back(static_cast<std::uint32_t>(part_.index(i)));
        }
        points_in_ += part_.size();
        points_out_ += kept_here_.size();
        return true;
    }

    const double spacing_, reach_;
    const unsigned threads_;
    const PointsInBoxes cloud_;
    const Schema& schema_;
    FileInfo info_;
    std::vector<Unit> units_;

    std::size_t unit_ = 0;  // the present one
    std::optional<KeptPoints> kept_;
    std::size_t from_others_ = 0;  // number of them that are points of other units
    PointsInBox part_;
    std::vector<Vec3d> positions_;
    std::vector<std::uint32_t> kept_here_;  // kept points of part_
    std::size_t next_kept_ = 0;
    std::uint64_t points_in_ = 0, points_out_ = 0;

    std::vector<NodeId> nodes_;  // nodes of unit next_unit_ - 1
    std::size_t next_node_ = 0, next_unit_ = 0;
    TaskPool pool_;
    std::deque<Job> ahead_;
};

SpacedPoints::SpacedPoints(std::shared_ptr<const Tree> tree, double spacing, std::uint64_t memory_bytes,
                           unsigned threads)
    : work_(std::make_unique<Work>(std::move(tree), spacing, memory_bytes, threads))
{
}

SpacedPoints::~SpacedPoints() = default;

const FileInfo& SpacedPoints::info() const { return work_->info(); }

bool SpacedPoints::read(PointBatch& batch, std::size_t max_points) { return work_->read(batch, max_points); }

double SpacedPoints::fraction_read() const { return work_->fraction(); }

}  // namespace pcm
