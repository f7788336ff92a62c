#include "pcm/place/inner_points.h"

#include "pcm/place/scan_positions.h"
#include "pcm/place/tuning.h"
#include "pcm/system/progress_part.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

namespace pcm {
namespace {

constexpr const char* edges_stage = "Finding edges";

}  // namespace

EdgeCubes::EdgeCubes(const Vec3d& corner, double edge, std::size_t most)
    : corner_(corner), first_edge_(edge), edge_(edge), most_(most), most_share_(place_tuning().growth.max_edge_share)
{
}

std::size_t EdgeCubes::Hash::operator()(const Key& key) const
{
    std::uint64_t hash = 0;
    for (const std::int32_t k : key) hash = (hash ^ static_cast<std::uint32_t>(k)) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
}

EdgeCubes::Key EdgeCubes::key_of(const Vec3d& p) const
{
    Key key{};
    for (std::size_t a = 0; a < 3; ++a)
        key[a] = static_cast<std::int32_t>(std::clamp(std::floor((p[a] - corner_[a]) / edge_), 0.0, 2e9));
    return key;
}

void EdgeCubes::add(const Vec3d& p, bool on_shape)
{
    Counts& counts = cubes_[key_of(p)];
    ++(on_shape ? counts.on : counts.off);
    ++points_;
    are_edges_found_ = false;
    while (cubes_.size() > most_) coarsen();
}

void EdgeCubes::coarsen()
{
    edge_ *= 2;
    std::unordered_map<Key, Counts, Hash> coarse;
    for (const auto& [key, counts] : cubes_) {
        Counts& sum = coarse[{key[0] / 2, key[1] / 2, key[2] / 2}];
        sum.on += counts.on;
        sum.off += counts.off;
    }
    cubes_ = std::move(coarse);
}

void EdgeCubes::widen()
{
    const double enough = place_tuning().growth.min_cube_points;
    while (static_cast<double>(points_) < enough * static_cast<double>(cubes_.size()) && cubes_.size() > 1) coarsen();
}

double EdgeCubes::share_of_edges() const { return place_tuning().growth.max_edge_share * first_edge_ / edge_; }

void EdgeCubes::find_edges(double most)
{
    most_share_ = most;
    for (auto& [key, counts] : cubes_) counts.is_edge = is_edge_cube(key);
    are_edges_found_ = true;
}

bool EdgeCubes::is_edge(const Vec3d& p) const
{
    const Key key = key_of(p);
    if (are_edges_found_) {
        const auto found = cubes_.find(key);
        if (found != cubes_.end()) return found->second.is_edge;
    }
    return is_edge_cube(key);
}

bool EdgeCubes::is_edge_cube(const Key& key) const
{
    Counts sum;
    for (std::int32_t n = 0; n < 27; ++n) {
        const auto found = cubes_.find({key[0] + n % 3 - 1, key[1] + n / 3 % 3 - 1, key[2] + n / 9 - 1});
        if (found == cubes_.end()) continue;
        sum.on += found->second.on;
        sum.off += found->second.off;
    }
    return sum.off >= place_tuning().growth.min_edge_points &&
           static_cast<double>(sum.off) > most_share_ * static_cast<double>(sum.on);
}

PointSet points_where(const PointSet& points, const std::function<bool(const Vec3d&)>& wanted, unsigned threads,
                      const ProgressFunction& progress)
{
    PointSet chosen(points.shared_tree());
    std::mutex mutex;
    scan_positions(points, edges_stage, threads, progress,
                   [&](const ScannedPoints& found, const std::vector<Vec3d>& positions) {
                       std::vector<std::uint32_t> numbers;
                       for (std::size_t k = 0; k < positions.size(); ++k)
                           if (wanted(positions[k])) numbers.push_back(found.numbers[k]);
                       const std::lock_guard lock(mutex);
                       chosen.set(found.node, numbers);
                   });
    return chosen;
}

PointSet inner_points(const PointSet& points, const PointSet& around, const Shape& shape, double threshold,
                      unsigned threads, const ProgressFunction& progress)
{
    EdgeCubes cubes(points.tree().info().bounds().min, place_tuning().growth.edge_cube * threshold);
    std::mutex mutex;
    scan_positions(around, edges_stage, threads, part_of(progress, 0, 0.6),
                   [&](const ScannedPoints&, const std::vector<Vec3d>& positions) {
                       std::vector<bool> on(positions.size());
                       for (std::size_t k = 0; k < positions.size(); ++k)
                           on[k] = distance_to(shape, positions[k]) <= threshold;
                       const std::lock_guard lock(mutex);
                       for (std::size_t k = 0; k < positions.size(); ++k) cubes.add(positions[k], on[k]);
                   });
    cubes.widen();
    const GrowthTuning& tuned = place_tuning().growth;
    const auto inside = [&](double most, double begin, double end) {
        cubes.find_edges(most);
        return points_where(
            points, [&](const Vec3d& p) { return !cubes.is_edge(p); }, threads, part_of(progress, begin, end));
    };
    const double share = cubes.share_of_edges();
    PointSet inner = inside(share, 0.6, 0.8);
    const bool is_enough = static_cast<double>(inner.size()) >= tuned.min_inner * static_cast<double>(points.size());
    return is_enough || !(share < tuned.max_edge_share) ? inner : inside(tuned.max_edge_share, 0.8, 1);
}

}  // namespace pcm
