#include "pcm/knn/unit_worker.h"

#include "pcm/cloud/numbers.h"
#include "pcm/knn/tuning.h"
#include "pcm/knn/unit_plan.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pcm {
namespace {

// The value below which a share of the values lie, which are reordered.
double quantile(std::vector<double>& values, double share)
{
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

// More than source coordinates differ from exact positions on the grid.
double rounding_of(const TreeInfo& info)
{
    const Box3d bounds = info.bounds();
    return 1e-14 * std::max(largest_magnitude(bounds.min), largest_magnitude(bounds.max));
}

// A point as seen from another.
struct Seen {
    double squared;  // distance, source units
    Vec3d offset;
    NodeId node;
    std::uint32_t index;
    bool operator<(const Seen& o) const { return std::tie(squared, offset) < std::tie(o.squared, o.offset); }
};

Seen seen_from(const Vec3i& at, const Vec3i& there, const Grid& grid, NodeId node, std::uint32_t index)
{
    Vec3d offset;
    for (std::size_t axis = 0; axis < 3; ++axis) offset[axis] = double(there[axis] - at[axis]) * grid.scale[axis];
    return {(offset[0] * offset[0] + offset[1] * offset[1]) + offset[2] * offset[2], offset, node, index};
}

}  // namespace

UnitWorker::UnitWorker(L2Cache& cache, BlockCache& blocks, const NeighbourhoodOptions& options, const Signal& signal,
                       NeighbourhoodVisitor& visitor)
    : cache_(cache),
      options_(options),
      signal_(signal),
      visitor_(visitor),
      rounding_(rounding_of(cache.tree().info())),
      search_alone_(cache, blocks, {}, options.max_distance + rounding_),
      cloud_(cache.tree().info().box)
{
}

bool UnitWorker::run(std::size_t number, const Box3i& box)
{
    if (!margin_) margin_ = first_margin(box);
    points_ = gather_unit(cache_, box, std::min(*margin_, options_.max_distance), options_.columns);
    unit_ = std::move(points_.unit);
    unit_.unit = number;
    if (!options_.numbers) unit_.around.clear();
    if (unit_.points == 0) return false;
    visitor_.begin(unit_);
    distances_.clear();
    unresolved_.clear();
    search_together();
    for (const auto& unresolved : unresolved_) search_alone(unresolved.second);
    hand_over();
    computed_ += unit_.points;
    learn_margin();
    visitor_.end(unit_);
    return true;
}

void UnitWorker::search_together()
{
    search(nullptr);
    for (int round = 0; round < 3 && widen(); ++round) {
        std::vector<std::uint32_t> again;
        for (const auto& [margin, number] : unresolved_) again.push_back(number);
        std::sort(again.begin(), again.end());
        unresolved_.clear();
        search(&again);
    }
}

void UnitWorker::search(const std::vector<std::uint32_t>* points)
{
    std::vector<std::uint32_t> all;
    if (!points && points_.positions.size() > unit_.points) {
        all.resize(unit_.points);
        for (std::uint32_t i = 0; i < unit_.points; ++i) all[i] = i;
        points = &all;
    }
    const auto search = make_unit_search(points_.positions, options_.backend);
    UnitSearchOptions options;
    options.neighbours = options_.neighbours;
    options.max_distance = options_.max_distance;
    search->search(points, options, [&](const FoundNeighbours& found) { take(found); });
}

// How far from the point everything must have been loaded for its neighbours to be right.
double UnitWorker::needed(const FoundNeighbours& found, std::size_t i) const
{
    const bool full = found.counts[i] == options_.neighbours;
    const double farthest = full ? std::sqrt(found.squared[i * found.stride + found.counts[i] - 1]) : infinity;
    return std::min(farthest, options_.max_distance);
}

void UnitWorker::take(const FoundNeighbours& found)
{
    if (signal_.stopped) throw Error(ErrorCode::cancelled, {}, "cancelled");
    begin_block(found.stride, found.size);
    for (std::size_t i = 0; i < found.size; ++i) {
        const std::uint32_t number = found.points[i];
        const double distance = needed(found, i);
        if (seen_++ % 16 == 0) distances_.push_back(distance);
        if (distance > points_.reach(number, cloud_)) {
            unresolved_.emplace_back(distance, number);
            continue;
        }
        const std::size_t at = block_.size() * block_.stride;
        const std::uint32_t* const neighbours = found.neighbours + i * found.stride;
        for (std::size_t axis = 0; axis < 3; ++axis)
            points_.put_offsets(axis, number, neighbours, found.counts[i], block_.offsets[axis].data() + at);
        std::copy_n(found.squared + i * found.stride, found.counts[i], block_.squares.data() + at);
        if (options_.numbers) std::copy_n(neighbours, found.counts[i], block_.neighbour_numbers.data() + at);
        add_point(number, found.counts[i]);
    }
    hand_over();
}

// Loads more points around the unit where that resolves many points. Returns whether it did.
bool UnitWorker::widen()
{
    const WidenTuning& tuned = knn_tuning().widen;
    if (unresolved_.size() < tuned.min_points || unresolved_.size() * tuned.points_per_unresolved < unit_.points)
        return false;
    std::vector<double> margins;
    for (const auto& [margin, number] : unresolved_)
        if (margin < infinity) margins.push_back(margin);
    double margin = tuned.blind_growth * *margin_;
    for (const double share : {tuned.large_share, tuned.middle_share, tuned.small_share}) {
        if (!margins.empty()) margin = 1.001 * quantile(margins, share);
        const Box3i box = box_around(points_.box, margin, cache_.tree().info());
        if (box == points_.loaded) return false;
        if (estimated_points(cache_.tree(), box) > tuned.max_unit_multiple * unit_.points + tuned.max_more_points)
            continue;
        GatheredPoints more = gather_unit(cache_, points_.box, margin, ColumnSet::only_positions());
        points_ = std::move(more);
        if (options_.numbers) unit_.around = std::move(points_.unit.around);
        points_.unit = {};
        return true;
    }
    return false;
}

void UnitWorker::search_alone(std::uint32_t number)
{
    if (signal_.stopped) throw Error(ErrorCode::cancelled, {}, "cancelled");
    ++alone_;
    const Grid& grid = cache_.tree().info().grid;
    const Vec3i at = points_.grid(number);
    const Vec3d place = grid.to_source(at);
    const std::size_t wanted = options_.neighbours + 1 + knn_tuning().single.spare_neighbours;
    const PointPlace own = unit_.place_of(number);
    const double limit = options_.max_distance * options_.max_distance;
    search_alone_.run(place, wanted, found_);
    std::vector<Seen> sorted;
    double farthest = 0;
    for (const Neighbour& neighbour : found_) {
        if (own == PointPlace{neighbour.node, neighbour.index}) continue;
        const auto chunk = cache_.get(neighbour.node, ColumnSet::only_positions());
        const Seen seen = seen_from(at, chunk->positions->grid(neighbour.index), grid, neighbour.node, neighbour.index);
        farthest = std::max(farthest, std::sqrt(seen.squared));
        if (seen.squared <= limit) sorted.push_back(seen);
    }
    std::sort(sorted.begin(), sorted.end());
    if (sorted.size() > options_.neighbours)
        sorted.erase(sorted.begin() + static_cast<std::ptrdiff_t>(options_.neighbours), sorted.end());
    // Points that were not found may come before the last one.
    const double last = sorted.size() == options_.neighbours ? std::sqrt(sorted.back().squared) : options_.max_distance;
    if (found_.size() == wanted && last > 0 && farthest <= last + 2 * rounding_) {
        sorted.clear();
        search_alone_.within(place, last + 2 * rounding_,
                             [&](const ChunkPositions& positions, NodeId node, std::uint32_t begin, std::uint32_t end) {
                                 for (std::uint32_t i = begin; i < end; ++i) {
                                     if (own == PointPlace{node, i}) continue;
                                     const Seen seen = seen_from(at, positions.grid(i), grid, node, i);
                                     if (!(seen.squared <= limit)) continue;
                                     if (sorted.size() == options_.neighbours) {
                                         if (!(seen < sorted.front())) continue;
                                         std::pop_heap(sorted.begin(), sorted.end());
                                         sorted.pop_back();
                                     }
                                     sorted.push_back(seen);
                                     std::push_heap(sorted.begin(), sorted.end());
                                 }
                             });
        std::sort_heap(sorted.begin(), sorted.end());
    }
    begin_block(options_.neighbours, 1);
    const std::size_t parts_around = unit_.around.size();
    for (std::size_t j = 0; j < sorted.size(); ++j) {
        block_.squares[j] = sorted[j].squared;
        for (std::size_t axis = 0; axis < 3; ++axis) block_.offsets[axis][j] = sorted[j].offset[axis];
        if (options_.numbers) block_.neighbour_numbers[j] = unit_.add_around({sorted[j].node, sorted[j].index});
    }
    add_point(number, sorted.size());
    hand_over();
    unit_.around.resize(parts_around);
}

void UnitWorker::begin_block(std::size_t stride, std::size_t points)
{
    block_.numbers.clear();
    block_.counts.clear();
    block_.stride = stride;
    for (auto& axis : block_.offsets) axis.resize(std::max(axis.size(), stride * points));
    block_.squares.resize(std::max(block_.squares.size(), stride * points));
    if (options_.numbers) block_.neighbour_numbers.resize(block_.squares.size());
}

void UnitWorker::add_point(std::uint32_t number, std::size_t count)
{
    block_.numbers.push_back(number);
    block_.counts.push_back(static_cast<std::uint32_t>(count));
}

void UnitWorker::hand_over()
{
    if (!block_.numbers.empty()) visitor_.visit(unit_, block_);
    block_.numbers.clear();
    block_.counts.clear();
}

// From some points of the unit, whose neighbours are searched one by one.
double UnitWorker::first_margin(const Box3i& box)
{
    const GatheredPoints points = gather_unit(cache_, box, 0, ColumnSet::only_positions());
    const MarginTuning& tuned = knn_tuning().margin;
    const std::size_t step = points.unit.points / tuned.first_points + 1;
    std::vector<double> distances;
    for (std::size_t number = 0; number < points.unit.points; number += step) {
        search_alone_.run(cache_.tree().info().grid.to_source(points.grid(static_cast<std::uint32_t>(number))),
                          options_.neighbours + 1, found_);
        if (!found_.empty()) distances.push_back(found_.back().distance());
    }
    return distances.empty() ? 0 : tuned.first_factor * quantile(distances, tuned.first_quantile);
}

void UnitWorker::learn_margin()
{
    distances_.erase(std::remove(distances_.begin(), distances_.end(), infinity), distances_.end());
    const MarginTuning& tuned = knn_tuning().margin;
    if (!distances_.empty()) margin_ = tuned.next_factor * quantile(distances_, tuned.next_quantile);
}

}  // namespace pcm
