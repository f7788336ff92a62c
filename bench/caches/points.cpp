// The modes without a picture: disk, decoding, scan, hits, neighbours.
#include "bench/caches/modes.h"
#include "bench/caches/storage.h"

#include "pcm/point_cloud.h"

#include <atomic>
#include <random>
#include <stdexcept>
#include <thread>

namespace pcm::bench {
namespace {

std::shared_ptr<PointCloud> open(const Settings& settings)
{
    L2Options cache;
    cache.capacity_bytes = settings.l2_bytes;
    cache.threads = settings.l2_threads;
    return PointCloud::open(settings.tree, cache);
}

std::vector<NodeId> nodes_with_points(const Tree& tree)
{
    std::vector<NodeId> nodes;
    for (NodeId id = 0; id < tree.nodes().size(); ++id)
        if (tree.node(id).points) nodes.push_back(id);
    if (nodes.empty()) throw std::runtime_error("the tree " + tree.folder().string() + " has no points");
    return nodes;
}

// Something of every chunk, so that nothing can be left out.
std::uint64_t look_at(const Chunk& chunk)
{
    return chunk.positions->size() ? static_cast<std::uint64_t>(chunk.positions->grid(0)[0]) : 0;
}

// So that the work above has a result that somebody reads.
std::atomic<std::uint64_t> looked_at{0};

}  // namespace

void prepare_storage(const Settings& settings, Row& row)
{
    if (settings.cold)
        drop_from_cache(settings.tree);
    else
        read_files(settings.tree);
    row["share_in_system_cache"] = share_in_cache(settings.tree);
}

void measure_disk(const Settings& settings, Row& row)
{
    prepare_storage(settings, row);
    const Reading plain = read_files(settings.tree);
    drop_from_cache(settings.tree);
    const Reading direct = read_files_direct(settings.tree);
    row["bytes"] = plain.bytes;
    row["read_mb_s"] = plain.megabytes_a_second();
    if (direct.bytes) row["direct_mb_s"] = direct.megabytes_a_second();
}

void measure_decoding(const Settings& settings, Row& row)
{
    prepare_storage(settings, row);
    const auto tree = Tree::open(settings.tree);
    const auto nodes = nodes_with_points(*tree);
    const ColumnSet columns = ColumnSet::all(tree->info().schema);
    std::uint64_t points = 0, bytes = 0, decoded = 0;
    const double cpu = processor_seconds();
    const auto start = Clock::now();
    for (const NodeId id : nodes) {
        const Chunk chunk = tree->read_chunk(id, columns);
        looked_at += look_at(chunk);
        points += chunk.positions->size();
        bytes += tree->node(id).extent.bytes;
        decoded += chunk.bytes();
    }
    const double seconds = seconds_since(start), cpu_seconds = processor_seconds() - cpu;
    row["points_read"] = points;
    row["seconds"] = seconds;
    row["cpu_seconds"] = cpu_seconds;
    row["mpoints_s"] = static_cast<double>(points) / seconds / 1e6;
    row["mpoints_cpu_s"] = static_cast<double>(points) / cpu_seconds / 1e6;
    row["mb_s"] = static_cast<double>(bytes) / seconds / 1e6;
    row["decoded_mb_s"] = static_cast<double>(decoded) / seconds / 1e6;
}

void measure_scan(const Settings& settings, Row& row)
{
    prepare_storage(settings, row);
    const auto cloud = open(settings);
    std::uint64_t bytes = 0;
    for (const NodeId id : nodes_with_points(*cloud->tree())) bytes += cloud->tree()->node(id).extent.bytes;
    Query query;
    query.reads_in_flight = settings.reads;
    for (std::size_t k = 0; k < cloud->info().schema.size(); ++k)
        query.attributes.push_back(cloud->info().schema[k].name);
    for (const std::string pass : {"", "again_"}) {
        std::uint64_t points = 0;
        const double cpu = processor_seconds();
        const auto start = Clock::now();
        PointCursor cursor = cloud->points(query);
        for (PointView view; cursor.getNextData(view); points += view.size())
            looked_at += static_cast<std::uint64_t>(view.grid_position(0)[0]);
        const double seconds = seconds_since(start), cpu_seconds = processor_seconds() - cpu;
        if (points != cloud->info().points)
            throw std::runtime_error("the scan found " + std::to_string(points) + " points of " +
                                     std::to_string(cloud->info().points));
        row[pass + "seconds"] = seconds;
        row[pass + "cpu_seconds"] = cpu_seconds;
        row[pass + "mpoints_s"] = static_cast<double>(points) / seconds / 1e6;
        row[pass + "mb_s"] = static_cast<double>(bytes) / seconds / 1e6;
        if (pass.empty()) {
            const L2Statistics l2 = cloud->cache().statistics();
            put_load_times(row, "l2_load", l2.load_times);
            row["l2_load_us_point"] = ratio(l2.load_seconds * 1e6, static_cast<double>(points));
            row["l2_load_ms_mean"] = ratio(l2.load_seconds * 1000, static_cast<double>(l2.load_times.count()));
        }
    }
}

namespace {

// Questions for chunks that the cache holds.
struct Hits {
    L2Cache& cache;
    const std::vector<NodeId>& nodes;
    const ColumnSet& columns;

    // Nanoseconds of each of `count` hits; without `ask` what the clock itself takes.
    std::vector<double> one_by_one(std::uint64_t count, bool ask) const
    {
        std::mt19937_64 random(3);
        std::vector<double> times;
        times.reserve(count);
        for (std::uint64_t i = 0; i < count; ++i) {
            const NodeId node = nodes[random() % nodes.size()];
            const auto start = Clock::now();
            if (ask) cache.get(node, columns);
            times.push_back(1e9 * seconds_since(start));
        }
        return times;
    }
    // Millions of hits a second, by several threads for `duration` seconds.
    double throughput(unsigned threads, double duration) const
    {
        std::atomic<bool> go{false}, stop{false};
        std::vector<std::uint64_t> counts(threads, 0);
        std::vector<std::thread> team;
        for (unsigned t = 0; t < threads; ++t)
            team.emplace_back([&, t] {
                std::mt19937_64 random(t + 1);
                std::uint64_t count = 0;
                while (!go) std::this_thread::yield();
                while (!stop) {
                    for (unsigned i = 0; i < 64; ++i) cache.get(nodes[random() % nodes.size()], columns);
                    count += 64;
                }
                counts[t] = count;
            });
        const auto start = Clock::now();
        go = true;
        std::this_thread::sleep_for(std::chrono::duration<double>(duration));
        stop = true;
        for (std::thread& thread : team) thread.join();
        const double seconds = seconds_since(start);
        std::uint64_t sum = 0;
        for (const std::uint64_t count : counts) sum += count;
        return static_cast<double>(sum) / seconds / 1e6;
    }
};

}  // namespace

void measure_hits(const Settings& settings, Row& row)
{
    prepare_storage(settings, row);
    const auto cloud = open(settings);
    L2Cache& cache = cloud->cache();
    const ColumnSet columns = ColumnSet::all(cloud->info().schema);
    // Held for a moment each; four fifths of the room, so that none is ever dropped.
    std::vector<NodeId> nodes;
    for (const NodeId id : nodes_with_points(*cloud->tree())) {
        if (!nodes.empty() && cache.statistics().resident_bytes > settings.l2_bytes / 5 * 4) break;
        cache.get(id, columns);
        nodes.push_back(id);
    }
    const auto misses = [&] {
        const L2Statistics s = cache.statistics();
        return s.compulsory_misses + s.capacity_misses;
    };
    const std::uint64_t misses_before = misses();

    const Hits hits{cache, nodes, columns};
    hits.one_by_one(settings.timed_hits, true);
    const std::vector<double> clock = hits.one_by_one(settings.timed_hits, false),
                              times = hits.one_by_one(settings.timed_hits, true);
    row["chunks"] = nodes.size();
    row["clock_ns"] = quantile(clock, 0.5);
    row["hit_ns_p50"] = quantile(times, 0.5) - quantile(clock, 0.5);
    row["hit_ns_p99"] = quantile(times, 0.99) - quantile(clock, 0.5);

    const std::vector<unsigned> numbers{1, 2, 4, 8};
    std::vector<std::vector<double>> found(numbers.size());
    for (int round = 0; round < 5; ++round)
        for (std::size_t k = 0; k < numbers.size(); ++k)
            found[k].push_back(hits.throughput(numbers[k], settings.seconds));
    for (std::size_t k = 0; k < numbers.size(); ++k)
        row["mhits_s_" + std::to_string(numbers[k])] = quantile(found[k], 0.5);
    if (misses() != misses_before) throw std::runtime_error("the cache dropped chunks while hits were measured");
}

void measure_neighbours(const Settings& settings, Row& row)
{
    prepare_storage(settings, row);
    const auto cloud = open(settings);
    const auto nodes = nodes_with_points(*cloud->tree());
    // Runs of consecutive points of random chunks, so that queries lie together as they do when all points are asked
    // for. A chunk is as probable as it has points.
    constexpr std::size_t run = 500;
    std::vector<double> weights;
    for (const NodeId id : nodes) weights.push_back(cloud->tree()->node(id).points);
    std::discrete_distribution<std::size_t> choose(weights.begin(), weights.end());
    std::mt19937_64 random(5);
    std::vector<Vec3d> points;
    while (points.size() < settings.queries) {
        const Chunk chunk = cloud->tree()->read_chunk(nodes[choose(random)], ColumnSet::only_positions());
        const std::size_t size = chunk.positions->size(), first = size > run ? random() % (size - run) : 0;
        for (std::size_t i = first; i < std::min(size, first + run) && points.size() < settings.queries; ++i)
            points.push_back(cloud->info().grid.to_source(chunk.positions->grid(i)));
    }
    prepare_storage(settings, row);
    NearestOptions options;
    options.threads = settings.threads;
    const double cpu = processor_seconds();
    const auto start = Clock::now();
    const NearestBatch found =
        cloud->nearest(points, settings.neighbours + 1, options);  // a point is its own nearest one
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        double distances = 0;
        for (std::size_t j = found.first[i] + 1; j < found.first[i + 1]; ++j) distances += found.points[j].distance();
        sum += ratio(distances, static_cast<double>(found.first[i + 1] - found.first[i] - 1));
    }
    const double seconds = seconds_since(start), cpu_seconds = processor_seconds() - cpu;
    const auto queries = static_cast<double>(points.size());
    row["mean_radius"] = sum / queries;
    row["seconds"] = seconds;
    row["us_query"] = 1e6 * seconds / queries;
    row["cpu_us_query"] = 1e6 * cpu_seconds / queries;
    const L2Statistics l2 = cloud->cache().statistics();
    row["l2_hits"] = l2.hits;
    row["l2_compulsory"] = l2.compulsory_misses;
    row["l2_capacity"] = l2.capacity_misses;
    row["l2_forced"] = l2.forced_misses;
    put_load_times(row, "l2_load", l2.load_times);
}

}  // namespace pcm::bench
