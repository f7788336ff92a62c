// What grows with the number of bins of a build, alone: the plan, and the levels of a cloud of which each bin has few
// points.
//
//   bench_bins BINS POINTS_A_BIN THREADS      prints one line of JSON: seconds, and bytes at the peak
#include "pcm/build/bins/top_tree.h"
#include "pcm/build/levels/level_sampler.h"
#include "pcm/build/levels/morton_sort.h"
#include "pcm/system/peak_memory.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>

namespace {

using pcm::Point;
using Coord = std::uint32_t;
using Cloud = std::vector<Point<Coord>>;

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Points of a bumpy surface, some of it a hundred times as dense.
Cloud surface(std::size_t count, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    Cloud points(count);
    for (Point<Coord>& p : points) {
        const double dense = random() % 3 ? 1 : 0.05, u = unit() * dense, v = unit() * dense;
        p = {static_cast<Coord>(u * 2e9), static_cast<Coord>(v * 2e9),
             static_cast<Coord>(5e7 * (2 + std::sin(u * 90) + std::cos(v * 70)) + unit() * 1e4)};
    }
    return points;
}

void put_bins(const Cloud& points, const pcm::TopTree<Coord>& top, std::size_t bins, pcm::SortedPoints<Coord>& to)
{
    std::vector<Cloud> of(bins);
    for (const Point<Coord>& p : points) of[top.bin_of(p)].push_back(p);
    pcm::RowLayout layout;
    layout.bytes = sizeof(Point<Coord>);
    to.resize(bins);
    for (std::size_t bin = 0; bin < bins; ++bin) {
        if (of[bin].empty()) continue;
        Cloud sorted;
        for (const std::uint32_t i : pcm::morton_order<Coord>(reinterpret_cast<const std::byte*>(of[bin].data()),
                                                              of[bin].size(), layout, {0, 0, 0}))
            sorted.push_back(of[bin][i]);
        to.put(bin, sorted);
    }
}

}  // namespace

int main(int count, char** argument)
{
    if (count != 4) return std::fprintf(stderr, "bench_bins BINS POINTS_A_BIN THREADS\n"), 2;
    const auto wanted = std::strtoull(argument[1], nullptr, 10), each = std::strtoull(argument[2], nullptr, 10);
    const auto threads = static_cast<unsigned>(std::atoi(argument[3]));
    const std::uint64_t per_bin = 100'000,
                        points = wanted * per_bin / 4 * 3;  // bins are three quarters full on average
    const pcm::AxisShift finer{0, 0, 0};
    Cloud sample = surface(wanted * 75, 1);

    auto start = std::chrono::steady_clock::now();
    pcm::TopTree<Coord> top;
    const std::size_t bins = pcm::TopPlanner<Coord>(top, finer, per_bin).plan(0, sample, points, 0);
    const double planned = seconds_since(start);
    Cloud().swap(sample);

    const std::filesystem::path folder = std::filesystem::temp_directory_path();
    const std::string name = "bench_bins." + std::to_string(std::random_device()());
    pcm::SortedPoints<Coord> sorted(folder / (name + ".points"));
    put_bins(surface(bins * each, 2), top, bins, sorted);
    const std::uint64_t before = pcm::peak_memory_bytes();
    start = std::chrono::steady_clock::now();
    pcm::LevelSampler<Coord> levels(sorted, pcm::Lattice(), pcm::Sampling::poisson, folder / (name + ".levels"));
    levels.run(threads, [](double) {});
    std::printf(
        "{\"bins\": %zu, \"plan_s\": %.3f, \"levels_s\": %.2f, \"levels\": %zu, \"peak_bytes_before_levels\": %llu, "
        "\"peak_bytes\": %llu}\n",
        bins, planned, seconds_since(start), levels.spacings().size(), static_cast<unsigned long long>(before),
        static_cast<unsigned long long>(pcm::peak_memory_bytes()));
}
