#include "pcm/query/nearest.h"

#include "pcm/cloud/box_distance.h"
#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/morton.h"
#include "pcm/cloud/numbers.h"
#include "pcm/knn/point_search.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/threads/crew.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <tuple>

namespace pcm {
namespace {

double seconds_now()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void require(const std::vector<Vec3d>& points, const NearestOptions& options)
{
    for (const Vec3d& p : points) require_place("neighbours cannot be searched: the place", p);
    if (!(options.max_distance >= 0))
        throw Error(ErrorCode::invalid_argument, {},
                    "the largest distance of neighbours is " + exact(options.max_distance) + "; it must be 0 or more");
}

void give_source_numbers(Hit& hit, const Region& beam, const TreeInfo& info)
{
    hit.position = SourceRounding(info)(hit.position);
    hit.along = beam.along(hit.position);
}

double spacing_at(const Tree& tree, const std::optional<std::uint16_t>& level)
{
    return level ? level_spacing(tree, *level) : 0;
}

double least_distance(const std::vector<Neighbour>& points, double spacing, double max_distance)
{
    const double distance = points.empty() ? max_distance : points[0].distance();
    return spacing == 0 ? distance : std::max(0.0, distance - spacing);
}

constexpr const char* error_meaning = "by how much the nearest point of the whole cloud may be nearer, source units";

double error_of(const std::vector<Neighbour>& points, double spacing, double max_distance)
{
    return std::min(spacing, points.empty() ? max_distance : points[0].distance());
}

}  // namespace

double level_spacing(const Tree& tree, std::uint16_t level)
{
    const TreeInfo& info = tree.info();
    if (level >= info.spacings.size() || level + 1 >= info.levels || tree.points_to_level(level) == info.points)
        return 0;
    return info.coverage_kept ? info.spacings[level] : infinity;
}

NearestResult find_nearest(L2Cache& cache, BlockCache& blocks, const Vec3d& point, std::size_t k,
                           const NearestOptions& options)
{
    require({point}, options);
    const double start = seconds_now();
    NearestResult result;
    PointSearch search(cache, blocks, options.level, options.max_distance);
    search.run(point, k, result.points);
    const double spacing = spacing_at(cache.tree(), options.level);
    result.least_distance = least_distance(result.points, spacing, options.max_distance);
    result.outcome.points_in = search.compared();
    result.outcome.points_out = result.points.size();
    result.outcome.error = error_of(result.points, spacing, options.max_distance);
    result.outcome.error_meaning = error_meaning;
    result.outcome.seconds = seconds_now() - start;
    return result;
}

NearestBatch find_nearest(L2Cache& cache, BlockCache& blocks, const std::vector<Vec3d>& points, std::size_t k,
                          const NearestOptions& options)
{
    require(points, options);
    if (points.size() > 0xffffffffu)
        throw Error(ErrorCode::invalid_argument, {}, "more than 4294967295 points were given at once",
                    "search for them in parts");
    const double start = seconds_now(), spacing = spacing_at(cache.tree(), options.level);
    const std::vector<std::uint32_t> order = morton_order(points);
    std::vector<std::vector<Neighbour>> found(points.size());
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint64_t> compared{0};
    constexpr std::size_t at_once = 256;
    Watch watch(options.progress);
    Signal signal;
    const auto work = [&] {
        PointSearch search(cache, blocks, options.level, options.max_distance);
        for (std::size_t begin; !signal.stopped && (begin = next.fetch_add(at_once)) < order.size();)
            for (std::size_t i = begin; i < std::min(begin + at_once, order.size()); ++i)
                search.run(points[order[i]], k, found[order[i]]);
        compared += search.compared();
    };
    const std::size_t most = (points.size() + at_once - 1) / at_once;
    const std::size_t threads = std::min<std::size_t>(thread_count(options.threads), most);
    {
        Crew crew(signal);
        for (std::size_t t = 0; t < threads; ++t) crew.add(work);
        crew.join([&] {
            const auto begun = static_cast<double>(std::min(next.load(), order.size()));
            watch.report("Searching neighbours",
                         order.empty() ? 1.0 : 0.999 * begun / static_cast<double>(order.size()));
        });
    }
    NearestBatch batch;
    batch.first.push_back(0);
    for (auto& neighbours : found) {
        batch.points.insert(batch.points.end(), neighbours.begin(), neighbours.end());
        batch.first.push_back(batch.points.size());
        batch.least_distance.push_back(least_distance(neighbours, spacing, options.max_distance));
        batch.outcome.error = std::max(batch.outcome.error, error_of(neighbours, spacing, options.max_distance));
        std::vector<Neighbour>().swap(neighbours);
    }
    batch.outcome.points_in = compared;
    batch.outcome.points_out = batch.points.size();
    batch.outcome.error_meaning = error_meaning;
    batch.outcome.seconds = seconds_now() - start;
    return batch;
}

HitResult find_first_hit(L2Cache& cache, BlockCache& blocks, const Region& beam,
                         const std::optional<std::uint16_t>& level)
{
    if (beam.kind() != Region::Kind::ray && beam.kind() != Region::Kind::cone)
        throw Error(ErrorCode::invalid_argument, {},
                    "the first point along a region can be found in a ray or a cone only");
    const double start = seconds_now();
    HitResult result;
    HeldChunks chunks(cache, blocks, level);
    const Tree& tree = chunks.tree();
    const auto may_hold = [&](double along, NodeId id) {
        return !result.hit || std::tie(along, id) <= std::tie(result.hit->along, result.hit->node);
    };
    std::priority_queue<std::pair<double, NodeId>, std::vector<std::pair<double, NodeId>>, std::greater<>> nodes;
    const auto queue = [&](NodeId id) {
        const Node& node = tree.node(id);
        if (node.box.empty() || !chunks.passes(node)) return;
        const Box3d box = chunks.grid().to_source(node.box);
        const double along = std::max(0.0, beam.least_along(box));
        if (may_hold(along, id) && beam.relation(box) != BoxRelation::outside) nodes.emplace(along, id);
    };
    if (!tree.nodes().empty()) queue(0);
    while (!nodes.empty()) {
        const auto [along, id] = nodes.top();
        nodes.pop();
        if (!may_hold(along, id)) continue;
        const auto is_wanted = [&, node = id](const Box3d& box) {
            return may_hold(std::max(0.0, beam.least_along(box)), node) && beam.relation(box) != BoxRelation::outside;
        };
        if (tree.node(id).points > 0) {
            const HeldChunk& chunk = chunks.get(id);
            const PointBlocks& parts = *chunk.blocks;
            for (std::size_t g = 0; g < parts.groups.size() && parts.group_first[g] < chunk.end_block; ++g) {
                if (!is_wanted(parts.groups.box(g))) continue;
                for (std::size_t b = parts.group_first[g];
                     b < std::min<std::size_t>(parts.group_first[g + 1], chunk.end_block); ++b) {
                    if (!is_wanted(parts.blocks.box(b))) continue;
                    for (std::uint32_t i = parts.first[b]; i < parts.first[b + 1]; ++i) {
                        ++result.outcome.points_in;
                        const Vec3d p = chunks.grid().to_source(chunk.positions().grid(i));
                        const double t = beam.along(p);
                        const bool sooner =
                            !result.hit ||
                            std::tie(t, id, i) < std::tie(result.hit->along, result.hit->node, result.hit->index);
                        if (sooner && beam.contains(p)) result.hit = Hit{id, i, t, p};
                    }
                }
            }
        }
        for (const NodeId child : tree.node(id).children)
            if (child != no_node) queue(child);
    }
    if (result.hit) give_source_numbers(*result.hit, beam, tree.info());
    result.outcome.points_out = result.hit ? 1 : 0;
    result.outcome.error = spacing_at(tree, level);
    result.outcome.error_meaning =
        "every point of the whole cloud has a point of this level nearer than this, source units";
    result.outcome.seconds = seconds_now() - start;
    return result;
}

}  // namespace pcm
