// The k nearest neighbours of all points of a tree, out of core: time, processor time, memory.
//   bench_neighbourhoods TREE K THREADS CACHE_MB [ROUNDS]
// Each round is a line of JSON. From the second round on, a cache that holds the whole cloud has it.
#include "pcm/knn/neighbourhoods.h"

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>

namespace {

// What a consumer does at least: it looks at the last neighbour of each point.
class Sum final : public pcm::NeighbourhoodVisitor {
public:
    Sum(double& total, std::mutex& mutex) : total_(total), mutex_(mutex) {}
    ~Sum() override
    {
        const std::lock_guard lock(mutex_);
        total_ += sum_;
    }
    void visit(const pcm::NeighbourhoodUnit&, const pcm::Neighbourhoods& some) override
    {
        for (std::size_t i = 0; i < some.size(); ++i)
            if (some.count(i)) sum_ += std::sqrt(some.squared(i)[some.count(i) - 1]);
    }

private:
    double& total_;
    std::mutex& mutex_;
    double sum_ = 0;
};

double processor_seconds()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

int main(int argc, char** argv)
try {
    if (argc < 5) return std::fprintf(stderr, "bench_neighbourhoods TREE K THREADS CACHE_MB [ROUNDS]\n"), 2;
    const auto tree = pcm::Tree::open(argv[1]);
    pcm::L2Options cache_options;
    cache_options.capacity_bytes = std::strtoull(argv[4], nullptr, 10) << 20;
    pcm::L2Cache cache(tree, cache_options);
    pcm::NeighbourhoodOptions options;
    options.neighbours = std::strtoul(argv[2], nullptr, 10);
    options.threads = static_cast<unsigned>(std::strtoul(argv[3], nullptr, 10));
    const int rounds = argc > 5 ? std::atoi(argv[5]) : 1;
    for (int round = 0; round < rounds; ++round) {
        double total = 0;
        std::mutex mutex;
        const double before = processor_seconds();
        const auto report =
            pcm::for_each_neighbourhood(cache, options, [&] { return std::make_unique<Sum>(total, mutex); });
        const double used = processor_seconds() - before;
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        const auto points = double(report.outcome.points_out);
        std::printf(
            "{\"points\": %.0f, \"k\": %zu, \"units\": %llu, \"alone\": %llu, \"seconds\": %.3f, \"cpu_seconds\": "
            "%.3f, "
            "\"million_points_per_cpu_second\": %.3f, \"peak_mb\": %.0f, \"mean_distance\": %.9g}\n",
            points, options.neighbours, static_cast<unsigned long long>(report.units),
            static_cast<unsigned long long>(report.alone), report.outcome.seconds, used, points / used / 1e6,
            double(usage.ru_maxrss) / 1024, points > 0 ? total / points : 0);
        std::fflush(stdout);
    }
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
