// Nearest neighbours at each level of a tree: the error against the exact answer against the time it takes.
//   bench_knn TREE QUERIES K THREADS
#include "pcm/point_cloud.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

double seconds_of(const std::chrono::steady_clock::time_point& start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Places near the cloud: points of it, moved by up to `away`.
std::vector<pcm::Vec3d> places(pcm::PointCloud& cloud, std::size_t count, double away)
{
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> shift(-away, away);
    std::vector<pcm::Vec3d> all, result;
    pcm::Query query;
    query.level = cloud.tree()->level_with_at_most(2'000'000);
    auto cursor = cloud.points(query);
    for (pcm::PointView view; cursor.getNextData(view);)
        for (std::size_t i = 0; i < view.size(); ++i) all.push_back(view.position(i));
    for (std::size_t i = 0; i < count && !all.empty(); ++i) {
        pcm::Vec3d p = all[random() % all.size()];
        for (double& c : p) c += shift(random);
        result.push_back(p);
    }
    return result;
}

}  // namespace

int main(int argc, char** argv)
try {
    if (argc != 5) return std::fprintf(stderr, "bench_knn TREE QUERIES K THREADS\n"), 2;
    pcm::L2Options cache;
    cache.capacity_bytes = std::uint64_t(4) << 30;
    const auto cloud = pcm::PointCloud::open(argv[1], cache);
    const auto k = static_cast<std::size_t>(std::strtoul(argv[3], nullptr, 10));
    const auto points = places(*cloud, std::strtoul(argv[2], nullptr, 10), 1.0);
    pcm::NearestOptions options;
    options.threads = static_cast<unsigned>(std::strtoul(argv[4], nullptr, 10));
    const pcm::NearestBatch exact = cloud->nearest(points, k, options);  // fills the cache

    std::printf("%zu queries, k = %zu, %u threads; errors in source units\n", points.size(), k, options.threads);
    std::printf("level     spacing  promised   mean error    max error  mean of all k    us a query   of one by one\n");
    const std::uint16_t levels = cloud->info().levels;
    for (std::uint16_t level = 0; level < levels; ++level) {
        options.level = level;
        auto start = std::chrono::steady_clock::now();
        const pcm::NearestBatch found = cloud->nearest(points, k, options);
        const double batch = seconds_of(start);
        start = std::chrono::steady_clock::now();
        const std::size_t singles = std::min<std::size_t>(points.size(), 2000);
        for (std::size_t i = 0; i < singles; ++i) cloud->nearest(points[i], k, options);
        const double single = seconds_of(start);
        double sum = 0, largest = 0, all = 0;
        std::size_t compared = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            for (std::size_t j = found.first[i]; j < found.first[i + 1]; ++j) {
                const double error =
                    found.points[j].distance() - exact.points[exact.first[i] + (j - found.first[i])].distance();
                all += error;
                ++compared;
                if (j > found.first[i]) continue;
                sum += error;
                largest = std::max(largest, error);
            }
        const auto queries = static_cast<double>(std::max<std::size_t>(points.size(), 1));
        std::printf("%5u  %10.4g  %8.4g  %11.4g  %11.4g  %13.4g  %12.2f  %14.2f\n", level,
                    cloud->info().spacings[level], found.outcome.error, sum / queries, largest,
                    all / static_cast<double>(std::max<std::size_t>(compared, 1)), batch / queries * 1e6,
                    single / static_cast<double>(std::max<std::size_t>(singles, 1)) * 1e6);
    }
} catch (const std::exception& error) {
    return std::fprintf(stderr, "bench_knn: %s\n", error.what()), 1;
}
