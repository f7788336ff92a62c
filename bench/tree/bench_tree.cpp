// How long a program waits for the points of a tree; run.py starts it, each time as a process of its own.
//
//   bench_tree first TREE POINTS THREADS     opens the tree and loads its first POINTS points, coarse ones first, with
//   all attributes bench_tree box TREE SIDE COUNT THREADS cold|warm
//       opens it and reads the positions of the points in a column of SIDE x SIDE, twice; so COUNT times, elsewhere
//       each time. Cold: the system's cache of the files is dropped before each.
//
// Prints one line of JSON, times in ms, of columns the medians.
#include "pcm/point_cloud.h"
#include "pcm/system/work_done.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <random>
#include <stdexcept>

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start)
{
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

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
    // As a view of the whole from afar wants them: the coarsest first.
    const pcm::NodeTable& nodes = cloud->tree()->nodes();
    std::vector<pcm::NodeId> order(nodes.size());
    std::iota(order.begin(), order.end(), pcm::NodeId{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](pcm::NodeId a, pcm::NodeId b) { return nodes[a].first_level < nodes[b].first_level; });
    std::vector<pcm::ChunkRequest> list;
    const pcm::ColumnSet columns = pcm::ColumnSet::all(cloud->info().schema);
    std::uint64_t points = 0;
    for (std::size_t i = 0; i < order.size() && points < wanted; ++i)
        if (nodes[order[i]].points) {
            list.push_back({order[i], columns});
            points += nodes[order[i]].points;
        }
    const std::size_t chunks = list.size();
    cloud->cache().request(std::move(list));
    cloud->cache().wait_idle();
    if (cloud->cache().statistics().resident_chunks != chunks) throw std::runtime_error("not all chunks were loaded");
    std::printf("{\"open_ms\": %.3f, \"total_ms\": %.3f, \"points\": %llu, \"chunks\": %zu, \"reads\": %llu}\n", opened,
                ms_since(start), static_cast<unsigned long long>(points), chunks,
                static_cast<unsigned long long>(pcm::work_done().reads));
    return 0;
}

// Forgets what the system has cached of the tree's files.
void drop_from_cache(const std::filesystem::path& tree)
{
    for (const auto& entry : std::filesystem::directory_iterator(tree)) {
        const int file = ::open(entry.path().c_str(), O_RDONLY);
        if (file < 0) throw std::runtime_error("cannot open " + entry.path().string());
        ::fdatasync(file);
        ::posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
        ::close(file);
    }
}

double median(std::vector<double>& values)
{
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

int box(char** argument)
{
    const double side = std::strtod(argument[1], nullptr);
    const int count = std::atoi(argument[2]);
    const bool cold = std::strcmp(argument[4], "cold") == 0;
    if (!(side > 0) || count < 1) throw std::runtime_error("no such boxes");
    std::mt19937_64 random(7);
    std::vector<double> opened, times, again, numbers;
    double sum = 0;  // sum of coordinates, so that they are looked at
    for (int k = 0; k < count; ++k) {
        if (cold) drop_from_cache(argument[0]);
        const Clock::time_point start = Clock::now();
        const auto cloud = open(argument[0], argument[3]);
        opened.push_back(ms_since(start));
        pcm::Query query;
        query.box = cloud->info().bounds();
        for (std::size_t a = 0; a < 2; ++a) {
            const double room = std::max(0.0, query.box->extent(a) - side);
            query.box->min[a] += std::uniform_real_distribution<double>(0, 1)(random) * room;
            query.box->max[a] = query.box->min[a] + side;
        }
        for (std::vector<double>* to : {&times, &again}) {
            const Clock::time_point begin = Clock::now();
            pcm::PointCursor cursor = cloud->points(query);
            std::size_t points = 0;
            for (pcm::PointView view; cursor.getNextData(view); points += view.size())
                for (std::size_t i = 0; i < view.size(); ++i) sum += view.position(i)[2];
            to->push_back(ms_since(begin));
            if (to == &times) numbers.push_back(static_cast<double>(points));
        }
    }
    std::printf("{\"open_ms\": %.3f, \"box_ms\": %.3f, \"again_ms\": %.3f, \"points\": %.0f, \"sum\": %.6g}\n",
                median(opened), median(times), median(again), median(numbers), sum);
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    try {
        if (argc == 5 && std::strcmp(argv[1], "first") == 0) return first(argv + 2);
        if (argc == 7 && std::strcmp(argv[1], "box") == 0) return box(argv + 2);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_tree: %s\n", error.what());
        return 1;
    }
    std::fprintf(stderr, "bench_tree first TREE POINTS THREADS | box TREE SIDE COUNT THREADS cold|warm\n");
    return 2;
}
