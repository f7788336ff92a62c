// How long a program waits for the points of a tree; run.py starts it, each time as a process of its own.
//
//   bench_tree first TREE POINTS THREADS     opens the tree and loads its first POINTS points, coarse ones first, with all attributes
//   bench_tree box TREE X Y Z X Y Z THREADS  opens it and reads the positions of the points in a box, twice: from disk, and again
//
// Prints one line of JSON, times in ms.
#include "point_cloud.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

std::shared_ptr<pcm::PointCloud> open(const char* path, const char* threads)
{
    pcm::L2Options cache;
    cache.capacity_bytes = std::uint64_t(4) << 30;
    cache.threads = static_cast<unsigned>(std::atoi(threads));
    return pcm::PointCloud::open(path, cache);
}

int first(char** argument)
{
    const Clock::time_point start = Clock::now();
    const auto cloud = open(argument[0], argument[2]);
    const double opened = ms_since(start);
    const std::uint64_t wanted = std::strtoull(argument[1], nullptr, 10);
    // Nodes are stored parents first.
    std::vector<pcm::ChunkRequest> list;
    const pcm::ColumnSet columns = pcm::ColumnSet::all(cloud->info().schema);
    std::uint64_t points = 0;
    for (pcm::NodeId id = 0; id < cloud->tree()->nodes().size() && points < wanted; ++id)
        if (cloud->tree()->node(id).points) {
            list.push_back({id, columns});
            points += cloud->tree()->node(id).points;
        }
    const std::size_t chunks = list.size();
    cloud->cache().request(std::move(list));
    cloud->cache().wait_idle();
    if (cloud->cache().statistics().resident_chunks != chunks) throw std::runtime_error("not all chunks were loaded");
    std::printf("{\"open_ms\": %.3f, \"total_ms\": %.3f, \"points\": %llu, \"chunks\": %zu}\n", opened, ms_since(start),
                static_cast<unsigned long long>(points), chunks);
    return 0;
}

int box(char** argument)
{
    const Clock::time_point start = Clock::now();
    const auto cloud = open(argument[0], argument[7]);
    const double opened = ms_since(start);
    pcm::Query query;
    query.box.emplace();
    for (std::size_t a = 0; a < 3; ++a) {
        query.box->min[a] = std::strtod(argument[1 + a], nullptr);
        query.box->max[a] = std::strtod(argument[4 + a], nullptr);
    }
    double times[2];
    std::uint64_t points = 0;
    double sum = 0;  // of coordinates, so that they are looked at
    for (double& time : times) {
        const Clock::time_point begin = Clock::now();
        pcm::PointCursor cursor = cloud->points(query);
        points = 0;
        for (pcm::PointView view; cursor.getNextData(view); points += view.size())
            for (std::size_t i = 0; i < view.size(); ++i) sum += view.position(i)[2];
        time = ms_since(begin);
    }
    std::printf("{\"open_ms\": %.3f, \"box_ms\": %.3f, \"again_ms\": %.3f, \"points\": %llu, \"sum\": %.6g}\n", opened, times[0],
                times[1], static_cast<unsigned long long>(points), sum);
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    try {
        if (argc == 5 && std::strcmp(argv[1], "first") == 0) return first(argv + 2);
        if (argc == 10 && std::strcmp(argv[1], "box") == 0) return box(argv + 2);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_tree: %s\n", error.what());
        return 1;
    }
    std::fprintf(stderr, "bench_tree first TREE POINTS THREADS | box TREE X Y Z X Y Z THREADS\n");
    return 2;
}
