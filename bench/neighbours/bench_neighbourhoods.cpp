// The k nearest neighbours of all points of a tree, out of core: time, processor time, memory.
//   bench_neighbourhoods TREE K THREADS CACHE_MB [ROUNDS] [--sweep NAME...]
// Each round is a line of JSON. From the second round on, a cache that holds the whole cloud has it. With --sweep a
// table for each tuned value instead (README.md).
#include "bench/sweep/sweep.h"
#include "pcm/knn/neighbourhoods.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

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

struct Round {
    pcm::NeighbourhoodReport report;
    double cpu_seconds = 0, mean_distance = 0;

    double million_points_per_cpu_second() const { return double(report.outcome.points_out) / cpu_seconds / 1e6; }
};

Round run(pcm::L2Cache& cache, const pcm::NeighbourhoodOptions& options)
{
    Round round;
    double total = 0;
    std::mutex mutex;
    const double before = processor_seconds();
    round.report = pcm::for_each_neighbourhood(cache, options, [&] { return std::make_unique<Sum>(total, mutex); });
    round.cpu_seconds = processor_seconds() - before;
    const auto points = double(round.report.outcome.points_out);
    round.mean_distance = points > 0 ? total / points : 0;
    return round;
}

void print(const Round& round, const pcm::NeighbourhoodOptions& options)
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::printf(
        "{\"points\": %llu, \"k\": %zu, \"units\": %llu, \"alone\": %llu, \"seconds\": %.3f, \"cpu_seconds\": %.3f, "
        "\"million_points_per_cpu_second\": %.3f, \"peak_mb\": %.0f, \"mean_distance\": %.9g}\n",
        static_cast<unsigned long long>(round.report.outcome.points_out), options.neighbours,
        static_cast<unsigned long long>(round.report.units), static_cast<unsigned long long>(round.report.alone),
        round.report.outcome.seconds, round.cpu_seconds, round.million_points_per_cpu_second(),
        double(usage.ru_maxrss) / 1024, round.mean_distance);
    std::fflush(stdout);
}

// A row of a sweep: the best of the rounds, because other programs on the machine can only make a round slower.
std::vector<std::string> figures(pcm::L2Cache& cache, const pcm::NeighbourhoodOptions& options, int rounds)
{
    Round best;
    for (int i = 0; i < rounds; ++i) {
        const Round round = run(cache, options);
        if (i == 0 || round.cpu_seconds < best.cpu_seconds) best = round;
    }
    char speed[32], distance[32];
    std::snprintf(speed, sizeof speed, "%.4f", best.million_points_per_cpu_second());
    std::snprintf(distance, sizeof distance, "%.9g", best.mean_distance);
    return {speed, std::to_string(best.report.alone), distance};
}

}  // namespace

int main(int argc, char** argv)
try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    const auto option = std::find(words.begin(), words.end(), "--sweep");
    const std::vector<std::string> given(words.begin(), option);
    const auto sweeps = pcm::bench::read_sweeps(option == words.end() ? std::vector<std::string>()
                                                                      : std::vector(option + 1, words.end()));
    if (given.size() < 4) {
        if (option != words.end() && sweeps.empty()) return 0;  // the names were listed
        return std::fprintf(stderr, "bench_neighbourhoods TREE K THREADS CACHE_MB [ROUNDS] [--sweep NAME...]\n"), 2;
    }
    const auto tree = pcm::Tree::open(given[0]);
    pcm::L2Options cache_options;
    cache_options.capacity_bytes = std::strtoull(given[3].c_str(), nullptr, 10) << 20;
    pcm::L2Cache cache(tree, cache_options);
    pcm::NeighbourhoodOptions options;
    options.neighbours = std::strtoul(given[1].c_str(), nullptr, 10);
    options.threads = static_cast<unsigned>(std::strtoul(given[2].c_str(), nullptr, 10));
    const int rounds = given.size() > 4 ? std::atoi(given[4].c_str()) : 1;
    if (!sweeps.empty()) run(cache, options);  // so that every value finds the same chunks in the cache
    for (const pcm::bench::Sweep& sweep : sweeps)
        print_sweep(sweep, {"million points per CPU s", "alone", "mean distance"},
                    [&] { return figures(cache, options, rounds); });
    for (int round = 0; sweeps.empty() && round < rounds; ++round) print(run(cache, options), options);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
