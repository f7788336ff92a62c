#include "pcm/knn/neighbourhoods.h"

#include "pcm/knn/unit_plan.h"
#include "pcm/knn/unit_worker.h"
#include "pcm/system/error.h"
#include "pcm/threads/crew.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <atomic>

namespace pcm {
namespace {

// What the heap keeps between units. Without it, two threads ran at the limits that are short (96 MB for outliers, 128
// MB for normals), and took 112 and 177 MB for 60 M points, although 76 and 122 for 10 M.
constexpr std::uint64_t bytes_beside_units = std::uint64_t(8) << 20;

void check(const NeighbourhoodOptions& options)
{
    if (options.neighbours < 1 || options.neighbours > most_neighbours)
        throw Error(ErrorCode::invalid_argument, {},
                    "the number of neighbours is " + std::to_string(options.neighbours) + "; it must be 1 to " +
                        std::to_string(most_neighbours));
    if (options.unit_points < 1) throw Error(ErrorCode::invalid_argument, {}, "a unit must have 1 point or more");
    if (!(options.max_distance >= 0))
        throw Error(ErrorCode::invalid_argument, {}, "the largest distance of neighbours must be 0 or more");
}

}  // namespace

std::uint64_t cache_share(std::uint64_t memory_bytes)
{
    // What normals of two threads take without the cache: 113 MB (10 M points, cache of 64 and 128 MB).
    constexpr std::uint64_t others = std::uint64_t(112) << 20, least = std::uint64_t(8) << 20;
    const std::uint64_t rest = memory_bytes > others ? memory_bytes - others : 0;
    return std::min(memory_bytes / 2, std::max(rest, least));
}

std::uint64_t block_share(std::uint64_t memory_bytes) { return std::min(memory_bytes / 8, std::uint64_t(32) << 20); }

const NeighbourhoodUnit::Part& NeighbourhoodUnit::part_of(std::uint32_t number) const
{
    const std::vector<Part>& all = number < points ? parts : around;
    const auto after = std::upper_bound(all.begin(), all.end(), number,
                                        [](std::uint32_t n, const Part& part) { return n < part.first; });
    return *(after - 1);
}

std::uint32_t NeighbourhoodUnit::add_around(const PointPlace& place)
{
    for (const Part& part : parts) {
        if (part.node != place.node) continue;
        const auto found = std::lower_bound(part.indices.begin(), part.indices.end(), place.index);
        if (found != part.indices.end() && *found == place.index)
            return part.first + static_cast<std::uint32_t>(found - part.indices.begin());
    }
    const std::uint32_t number =
        around.empty() ? points : around.back().first + static_cast<std::uint32_t>(around.back().indices.size());
    around.push_back({place.node, {}, {place.index}, number});
    return number;
}

NeighbourhoodReport for_each_neighbourhood(L2Cache& cache, const NeighbourhoodOptions& options,
                                           const std::function<std::unique_ptr<NeighbourhoodVisitor>()>& make_visitor)
{
    check(options);
    Watch watch(options.progress);
    watch.report(options.stage, options.begin);
    const std::vector<Box3i> units = plan_units(cache.tree(), options.unit_points);
    const std::uint64_t for_units = options.memory_bytes - std::min(options.memory_bytes, bytes_beside_units);
    const std::uint64_t room = std::max<std::uint64_t>(1, for_units / (bytes_per_unit_point * options.unit_points));
    const auto threads =
        static_cast<unsigned>(std::min<std::uint64_t>({thread_count(options.threads), room, units.size()}));
    BlockCache blocks(block_share(options.memory_bytes));
    std::atomic<std::size_t> next{0}, begun{0};
    const auto next_unit = [&] { return options.next_unit ? options.next_unit() : next++; };
    std::atomic<std::uint64_t> computed{0}, alone{0};
    Signal signal;
    Crew crew(signal);
    for (unsigned t = 0; t < threads; ++t)
        crew.add([&] {
            const auto visitor = make_visitor();
            UnitWorker worker(cache, blocks, options, signal, *visitor);
            for (std::size_t n; !signal.stopped && (n = next_unit()) < units.size(); begun = n)
                if (!worker.run(n, units[n])) visitor->skip(n);
            computed += worker.computed();
            alone += worker.alone();
        });
    crew.join([&] {
        const double share = static_cast<double>(begun) / static_cast<double>(units.size());
        watch.report(options.stage, options.begin + (options.end - options.begin) * 0.999 * share);
    });
    NeighbourhoodReport report;
    report.outcome.points_in = cache.tree().info().points;
    report.outcome.points_out = computed;
    report.outcome.seconds = watch.seconds();
    report.units = units.size();
    report.alone = alone;
    return report;
}

}  // namespace pcm
