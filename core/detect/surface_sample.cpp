#include "pcm/detect/surface_sample.h"

#include "pcm/cloud/symmetric_eigen.h"
#include "pcm/detect/point_labels.h"
#include "pcm/detect/tuning.h"
#include "pcm/knn/grid_steps.h"
#include "pcm/knn/unit_points.h"
#include "pcm/knn/unit_search.h"
#include "pcm/system/error.h"
#include "pcm/system/free_memory.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr double small_box = 0.25;  // share of a step: halves have no fewer points around them

// Positions relative to the first one. Narrow where their differences are 31 bits.
SearchPositions positions_of(const std::vector<Vec3i>& grid, const Vec3d& scale)
{
    SearchPositions positions;
    positions.scale = scale;
    if (grid.empty()) return positions;
    Box3i box;
    for (const Vec3i& q : grid) box.extend(q);
    bool narrow = true;
    for (std::size_t a = 0; a < 3; ++a) narrow = narrow && box.max[a] - box.min[a] < (std::int64_t(1) << 30);
    for (std::size_t a = 0; a < 3; ++a) {
        if (narrow)
            for (const Vec3i& q : grid) positions.narrow[a].push_back(static_cast<std::int32_t>(q[a] - box.min[a]));
        else
            for (const Vec3i& q : grid) positions.wide[a].push_back(q[a] - box.min[a]);
    }
    return positions;
}

// Normal, roughness and spacing out of a point's neighbours.
void describe(SurfaceSample& sample, std::uint32_t i, std::size_t count, const double* squared)
{
    const std::uint32_t* const near = sample.neighbours(i);
    const double n = static_cast<double>(count + 1);
    Vec3d mean{};
    for (std::size_t k = 0; k < count; ++k) mean = mean + (sample.at[near[k]] - sample.at[i]);
    mean = mean / n;
    SymmetricMatrix m;
    const auto add = [&](const Vec3d& d) {
        m.xx += d[0] * d[0], m.xy += d[0] * d[1], m.xz += d[0] * d[2];
        m.yy += d[1] * d[1], m.yz += d[1] * d[2], m.zz += d[2] * d[2];
    };
    add(-1.0 * mean);
    for (std::size_t k = 0; k < count; ++k) add(sample.at[near[k]] - sample.at[i] - mean);
    const SmallestEigenvector found = smallest_eigenvector(m);
    if (count >= 2 && found.values[1] > 1e-6 * found.values[2])
        for (std::size_t a = 0; a < 3; ++a) sample.normal[i][a] = static_cast<float>(found.vector[a]);
    sample.rough[i] = static_cast<float>(std::sqrt(std::max(0.0, found.values[0]) / std::max(1.0, n - 3)));
    if (count > 0) sample.spacing[i] = static_cast<float>(std::sqrt(squared[std::min<std::size_t>(count, 4) - 1]));
}

void find_neighbours(SurfaceSample& sample, SearchPositions positions, const std::function<void()>& check)
{
    const std::size_t points = sample.size(), most = SurfaceSample::most_neighbours;
    sample.edges.resize(points * most);
    sample.normal.assign(points, {0, 0, 0});
    sample.rough.assign(points, 0);
    sample.spacing.assign(points, 0);
    if (points == 0) return;
    const auto search = make_unit_search(std::move(positions));
    UnitSearchOptions options;
    options.neighbours = most;
    search->search(nullptr, options, [&](const FoundNeighbours& found) {
        if (check) check();
        for (std::size_t f = 0; f < found.size; ++f) {
            const std::uint32_t i = found.points[f];
            std::uint32_t* const edges = sample.edges.data() + std::size_t(i) * most;
            std::copy_n(found.neighbours + f * found.stride, found.counts[f], edges);
            std::fill(edges + found.counts[f], edges + most, i);
            describe(sample, i, found.counts[f], found.squared + f * found.stride);
        }
    });
}

// Edges that are too long lead back to the point itself.
void cut_edges(SurfaceSample& sample, double step, double cell)
{
    const double spacings = detect_tuning().resolution.edge_spacings;
    for (std::size_t i = 0; i < sample.size(); ++i)
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
            std::uint32_t& j = sample.edges[i * SurfaceSample::most_neighbours + k];
            const double most =
                step > 0 ? step : std::max<double>(3 * cell, spacings * std::min(sample.spacing[i], sample.spacing[j]));
            if (squared_distance(sample.at[i], sample.at[j]) > most * most) j = static_cast<std::uint32_t>(i);
        }
}

}  // namespace

ChosenPoints::ChosenPoints(const std::shared_ptr<const Tree>& tree, const Selection& limit, CloudPart part,
                           TakenPoints taken)
    : tree_(tree),
      boxes_(tree),
      selector_(limit, tree->info().schema),
      part_(std::move(part)),
      taken_(std::move(taken)),
      rounding_(tree->info())
{
}

bool ChosenPoints::touches(const Box3i& box) const
{
    return part_.touches(box) && selector_.relation(source_box(box)) != BoxRelation::outside;
}

Box3d ChosenPoints::source_box(const Box3i& box) const { return rounding_(tree_->info().grid.to_source(box)); }

void ChosenPoints::visit(const Box3i& box, std::uint16_t level, const std::function<void(const Some&)>& take) const
{
    ColumnSet columns = ColumnSet::only_positions();
    for (const std::size_t k : selector_.tested()) columns.attributes.set(k);
    const auto touches = [&](const Box3i& a) {
        for (std::size_t i = 0; i < 3; ++i)
            if (a.min[i] > box.max[i] || box.min[i] > a.max[i]) return false;
        return true;
    };
    for (const NodeId node : boxes_.nodes(box)) {
        if (tree_->node(node).first_level > level) continue;
        const BoxRelation relation = selector_.relation(source_box(tree_->node(node).box));
        const CloudPart here = part_.within(tree_->node(node).box);
        if (relation == BoxRelation::outside || !here.touches(tree_->node(node).box)) continue;
        const bool is_all = here.is_whole();
        const std::vector<std::uint32_t> taken =
            taken_.labels ? taken_.labels->get(node) : std::vector<std::uint32_t>();
        const ChunkPart part = tree_->read_chunk_part(
            node, columns, [&](const Box3i& b, std::uint16_t l) { return l <= level && touches(b); });
        Some some;
        some.node = node;
        std::vector<const Column*> tested(part.chunk.attributes.size(), nullptr);
        for (const std::size_t a : selector_.tested()) tested[a] = part.chunk.attributes[a].get();
        std::uint32_t begin = 0;
        for (std::size_t s = 0; s < part.count.size(); ++s) {
            std::vector<std::uint32_t> chosen;
            for (std::uint32_t i = begin; i < begin + part.count[s]; ++i)
                if (taken_.labels && taken_.has(taken[part.first[s] + (i - begin)]))
                    continue;
                else if (const Vec3i q = part.chunk.positions->grid(i); box.contains(q) && (is_all || here.contains(q)))
                    chosen.push_back(i);
            const auto position = [&](std::size_t i) {
                return rounding_(tree_->info().grid.to_source(part.chunk.positions->grid(i)));
            };
            selector_.narrow(tested, position, chosen, relation);
            for (const std::uint32_t i : chosen) {
                some.number.push_back(part.first[s] + (i - begin));
                some.grid.push_back(part.chunk.positions->grid(i));
                some.at.push_back(position(i));
            }
            begin += part.count[s];
        }
        if (!some.number.empty()) take(some);
    }
}

std::vector<Vec3d> ChosenPoints::positions(NodeId node) const
{
    const Chunk chunk = tree_->read_chunk(node, ColumnSet::only_positions());
    std::vector<Vec3d> at(chunk.points);
    for (std::size_t i = 0; i < at.size(); ++i)
        at[i] = rounding_(tree_->info().grid.to_source(chunk.positions->grid(i)));
    return at;
}

SampleLattice::SampleLattice(const Tree& tree, double cell)
{
    for (std::size_t a = 0; a < 3; ++a) factor_[a] = tree.info().grid.scale[a] / cell;
}

Vec3i SampleLattice::cell_of(const Vec3i& grid) const
{
    Vec3i cell;
    for (std::size_t a = 0; a < 3; ++a)
        cell[a] = static_cast<std::int64_t>(std::floor(static_cast<double>(grid[a]) * factor_[a]));
    return cell;
}

std::uint64_t SampleLattice::key_of(const Vec3i& cell)
{
    std::uint64_t key = 0;
    for (const std::int64_t c : cell) {  // steps of SplitMix64
        key += static_cast<std::uint64_t>(c) + 0x9e3779b97f4a7c15u;
        key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
        key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
        key ^= key >> 31;
    }
    return key >> 1;
}

namespace {

std::vector<Vicinity> reaching(const std::vector<Vicinity>& all, const Box3d& box)
{
    std::vector<Vicinity> some;
    for (const Vicinity& one : all)
        if (one.box.intersects(box)) some.push_back(one);
    return some;
}

bool is_in_one(const std::vector<Vicinity>& only, const Vec3d& p)
{
    return only.empty() || std::any_of(only.begin(), only.end(), [&](const Vicinity& one) { return one.contains(p); });
}

// Nothing where there are more than `most`, as in for_each_sample().
std::optional<SurfaceSample> sample_up_to(const ChosenPoints& points, const Box3i& box, const SampleSettings& settings,
                                          std::size_t most)
{
    const Tree& tree = points.tree();
    const SampleLattice lattice(tree, settings.cell > 0 ? settings.cell : 1);
    SurfaceSample sample;
    sample.origin = points.source_box(box).centre();
    std::vector<Vec3i> grid;
    std::size_t inside = 0;
    const auto too_many = [&] {
        return inside > most || (grid.size() > most + most / 3 && inside > most / 8) || grid.size() / 2 > most;
    };
    const Box3i around = box_around(box, settings.margin, tree.info());
    const std::vector<Vicinity> only = reaching(settings.only, points.source_box(around));
    if (only.empty() && !settings.only.empty()) return sample;
    points.visit(around, settings.level, [&](const ChosenPoints::Some& some) {
        if (settings.check) settings.check();
        if (too_many()) return;
        for (std::size_t i = 0; i < some.number.size(); ++i) {
            if (!is_in_one(only, some.at[i])) continue;
            if (settings.cell > 0) {
                const std::uint64_t key = SampleLattice::key_of(lattice.cell_of(some.grid[i]));
                if (!sample.by_cell.emplace(key, static_cast<std::uint32_t>(grid.size())).second) continue;
            }
            grid.push_back(some.grid[i]);
            sample.at.push_back(some.at[i] - sample.origin);
            sample.inside.push_back(box.contains(some.grid[i]));
            inside += sample.inside.back();
        }
    });
    if (too_many()) return std::nullopt;
    SearchPositions positions = positions_of(grid, tree.info().grid.scale);
    std::vector<Vec3i>().swap(grid);
    find_neighbours(sample, std::move(positions), settings.check);
    cut_edges(sample, settings.step, settings.cell);
    sample.blocks.resize((sample.size() + SurfaceSample::block_points - 1) / SurfaceSample::block_points);
    for (std::size_t i = 0; i < sample.size(); ++i) sample.blocks[i / SurfaceSample::block_points].extend(sample.at[i]);
    for (const Box3d& block : sample.blocks) sample.bounds.extend(block);
    return sample;
}

}  // namespace

std::vector<Vec3d> places_of(const SurfaceSample& sample, const std::vector<std::uint32_t>& points)
{
    std::vector<Vec3d> places;
    for (const std::uint32_t i : points) places.push_back(sample.at[i]);
    return places;
}

SurfaceSample sample_surface(const ChosenPoints& points, const Box3i& box, const SampleSettings& settings)
{
    return *sample_up_to(points, box, settings, std::numeric_limits<std::size_t>::max() / 2);
}

std::vector<Box3i> halves_of(const Box3i& box, const Vec3d& scale)
{
    const auto extent = [&](std::size_t a) {
        return static_cast<double>(grid_steps(box.min[a], box.max[a])) * scale[a];
    };
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (extent(a) > extent(axis)) axis = a;
    if (box.min[axis] == box.max[axis]) return {};
    Box3i low = box, high = box;
    low.max[axis] = box.min[axis] + static_cast<std::int64_t>(grid_steps(box.min[axis], box.max[axis]) / 2);
    high.min[axis] = low.max[axis] + 1;
    return {low, high};
}

void for_each_sample(const ChosenPoints& points, const Box3i& box, const SampleSettings& settings,
                     const std::function<void(const Box3i&, SurfaceSample)>& use)
{
    const std::vector<Box3i> halves = halves_of(box, points.tree().info().grid.scale);
    if (settings.check) settings.check();
    if (settings.most > 0 && !halves.empty()) {
        if (auto sample = sample_up_to(points, box, settings, settings.most)) {
            use(box, std::move(*sample));
            sample.reset();
            return return_free_memory();
        }
        const Box3d place = points.source_box(box);
        if (settings.step > 0 && place.diagonal() < small_box * settings.step)
            throw Error(ErrorCode::invalid_argument, points.tree().folder(),
                        "the longest step of " + exact(settings.step) + " reaches more than " +
                            grouped(2 * settings.most) + " points from " + exact(place.min) +
                            ", which is more than fits into memory",
                        "give a shorter step, or 0");
        for (const Box3i& half : halves) for_each_sample(points, half, settings, use);
    } else {
        use(box, sample_surface(points, box, settings));
    }
}

}  // namespace pcm
