#include "pcm/knn/neighbourhoods.h"

#include "pcm/knn/point_search.h"
#include "pcm/system/error.h"
#include "pcm/threads/crew.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <atomic>
#include <string>

namespace pcm {

const NeighbourhoodUnit::Part& NeighbourhoodUnit::part_of(std::uint32_t number) const
{
    const auto after = std::upper_bound(parts.begin(), parts.end(), number,
                                        [](std::uint32_t n, const Part& part) { return n < part.first; });
    return *(after - 1);
}

NeighbourhoodReport for_each_neighbourhood(L2Cache& cache, const NeighbourhoodOptions& options,
                                           const std::function<std::unique_ptr<NeighbourhoodVisitor>()>& make_visitor)
{
    if (options.neighbours < 1 || options.neighbours > most_neighbours)
        throw Error(ErrorCode::invalid_argument, {},
                    "the number of neighbours is " + std::to_string(options.neighbours) + "; it must be 1 to " +
                        std::to_string(most_neighbours));
    const Tree& tree = cache.tree();
    std::vector<NodeId> nodes;
    for (NodeId id = 0; id < tree.nodes().size(); ++id)
        if (tree.node(id).points > 0) nodes.push_back(id);
    BlockCache blocks;
    Watch watch(options.progress);
    Signal signal;
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint64_t> computed{0};
    {
        Crew crew(signal);
        for (unsigned t = 0; t < thread_count(options.threads); ++t)
            crew.add([&] {
                const auto visitor = make_visitor();
                PointSearch search(cache, blocks, {}, options.max_distance);
                std::vector<Neighbour> found;
                for (std::size_t n; !signal.stopped && (n = next++) < nodes.size();) {
                    NeighbourhoodUnit unit;
                    unit.parts.resize(1);
                    auto& part = unit.parts[0];
                    part.node = nodes[n];
                    part.chunk = cache.get(part.node, options.columns);
                    for (std::uint32_t i = 0; i < part.chunk->points; ++i) part.indices.push_back(i);
                    unit.points = part.chunk->points;
                    const std::uint32_t in_level =
                        options.level ? tree.node(part.node).points_to_level(*options.level) : unit.points;
                    const std::uint32_t computing = in_level ? in_level : unit.points;
                    visitor->begin(unit);
                    for (std::uint32_t i = 0; i < computing; ++i) {
                        const Vec3d q = tree.info().grid.to_source(part.chunk->positions->grid(i));
                        search.run(q, options.neighbours + 1, found);
                        Neighbourhoods one;
                        one.numbers = {i};
                        one.stride = options.neighbours;
                        one.squares.resize(one.stride);
                        for (auto& axis : one.offsets) axis.resize(one.stride);
                        std::size_t count = 0;
                        for (const Neighbour& f : found) {
                            if ((f.node == part.node && f.index == i) || count == one.stride) continue;
                            for (std::size_t a = 0; a < 3; ++a) one.offsets[a][count] = f.position[a] - q[a];
                            one.squares[count++] = f.squared_distance;
                        }
                        one.counts = {static_cast<std::uint32_t>(count)};
                        visitor->visit(unit, one);
                    }
                    computed += computing;
                    if (options.level) {
                        unit.source.resize(unit.points);
                        for (std::uint32_t i = 0; i < unit.points; ++i) unit.source[i] = std::min(i, computing - 1);
                    }
                    visitor->end(unit);
                }
            });
        crew.join([&] {
            const double done = static_cast<double>(std::min(next.load(), nodes.size())) /
                                static_cast<double>(std::max<std::size_t>(1, nodes.size()));
            watch.report(options.stage, options.begin + (options.end - options.begin) * done);
        });
    }
    NeighbourhoodReport report;
    report.outcome.points_in = tree.info().points;
    report.outcome.points_out = computed;
    report.outcome.seconds = watch.seconds();
    report.units = nodes.size();
    return report;
}

}  // namespace pcm
