#include "bench/pick/pick_levels.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <optional>
#include <string>

namespace pcm::bench {
namespace {

struct Picked {
    std::vector<std::optional<double>> depths;
    double cpu = 0;  // seconds of a pick
};

template <class Pick>
Picked all_picks(const std::vector<PickRay>& rays, Pick&& pick)
{
    Picked picked;
    const std::clock_t start = std::clock();
    for (const PickRay& ray : rays) {
        const PickResult result = pick(ray);
        picked.depths.push_back(result.hit ? std::optional<double>(result.hit->depth) : std::nullopt);
    }
    picked.cpu = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / static_cast<double>(rays.size());
    return picked;
}

void print_row(const char* nodes, std::uint64_t points, const Picked& found, const Picked& exact, double diagonal)
{
    std::vector<double> errors;
    std::size_t missed = 0;
    for (std::size_t r = 0; r < exact.depths.size(); ++r) {
        if (!exact.depths[r]) continue;
        missed += !found.depths[r];
        errors.push_back(found.depths[r] ? *found.depths[r] - *exact.depths[r] : diagonal);
    }
    std::sort(errors.begin(), errors.end());
    const auto hits = static_cast<double>(errors.size());
    const double p95 = errors.empty() ? 0 : errors[static_cast<std::size_t>(0.95 * (hits - 1))];
    std::printf(
        "{\"nodes\": \"%s\", \"points\": %llu, \"cpu_seconds\": %.9f, \"missed_percent\": %.4f, \"error_p95\": %.9g}\n",
        nodes, static_cast<unsigned long long>(points), found.cpu,
        errors.empty() ? 0 : 100 * static_cast<double>(missed) / hits, p95);
}

}  // namespace

void print_levels(PointCloud& cloud, const std::vector<PickRay>& rays)
{
    PointPicker picker(cloud.cache());
    const double diagonal = cloud.info().bounds().diagonal();
    cloud.cache().clear();
    const Picked exact = all_picks(rays, [&](const PickRay& ray) { return picker.exact(ray); });
    print_row("exact, from disk", cloud.info().points, exact, exact, diagonal);
    const auto& nodes = cloud.tree()->nodes();
    std::uint64_t points = 0;
    std::uint16_t deepest = 0;
    for (const Node& node : nodes) deepest = std::max(deepest, node.depth);
    for (std::uint16_t depth = 0; depth <= deepest; ++depth) {
        const std::uint64_t before = points;
        for (NodeId node = 0; node < nodes.size(); ++node)
            if (nodes[node].depth == depth) {
                cloud.cache().get(node, ColumnSet::whole(cloud.info().schema));
                points += nodes[node].points;
            }
        if (points == before) continue;  // nodes without points of their own
        const Picked found = all_picks(rays, [&](const PickRay& ray) { return picker.in_memory(ray); });
        print_row(std::to_string(depth).c_str(), points, found, exact, diagonal);
    }
    const Picked warm = all_picks(rays, [&](const PickRay& ray) { return picker.exact(ray); });
    print_row("exact, in memory", cloud.info().points, warm, exact, diagonal);
}

}  // namespace pcm::bench
