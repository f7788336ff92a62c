#include "pcm/place/crossing_surfaces.h"

#include "pcm/fit/shape_sums.h"
#include "pcm/place/grow_shape.h"
#include "pcm/place/scan_positions.h"
#include "pcm/shapes/shape_traits.h"
#include "pcm/system/progress_part.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <mutex>
#include <vector>

namespace pcm {
namespace {

constexpr auto crossing_bands = static_cast<std::size_t>(around_thresholds);  // the first one holds the plane's points

constexpr const char* crossing_stage = "Looking at surfaces that cross";

// One after the other, so that the sum does not depend on threads.
using NodeSums = std::map<NodeId, std::vector<ShapeSums>>;
std::vector<ShapeSums> added(const NodeSums& nodes, const std::vector<ShapeSums>& none)
{
    std::vector<ShapeSums> sums = none;
    for (const auto& [node, own] : nodes)
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i].add(own[i]);
    return sums;
}

}  // namespace

std::optional<PlaneWithoutCrossing> without_crossing(const PointSet& points, const PointSet& around, const Shape& shape,
                                                     double threshold, unsigned threads,
                                                     const ProgressFunction& progress)
{
    if (!traits_of(shape.kind).is_flat() || !(threshold > 0)) return {};
    std::mutex mutex;
    Box3d box;
    scan_positions(points, crossing_stage, threads, part_of(progress, 0, 0.3),
                   [&](const ScannedPoints&, const std::vector<Vec3d>& places) {
                       const std::lock_guard lock(mutex);
                       for (const Vec3d& p : places) box.extend(p);
                   });
    if (box.empty()) return {};
    const std::vector<ShapeSums> none(2 * crossing_bands, ShapeSums(shape, box.centre(), box.diagonal()));
    NodeSums own, others;
    const auto into = [&](NodeSums& nodes, NodeId node, const std::vector<ShapeSums>& part) {
        const std::lock_guard lock(mutex);
        nodes.emplace(node, part);
    };
    scan_positions(points, crossing_stage, threads, part_of(progress, 0.3, 0.6),
                   [&](const ScannedPoints& found, const std::vector<Vec3d>& places) {
                       std::vector<ShapeSums> part(1, none.front());
                       for (const Vec3d& p : places) part.front().add(p);
                       into(own, found.node, part);
                   });
    scan_positions(around, crossing_stage, threads, part_of(progress, 0.6, 1),
                   [&](const ScannedPoints& found, const std::vector<Vec3d>& places) {
                       std::vector<ShapeSums> part = none;
                       for (const Vec3d& p : places) {
                           const double d = signed_distance(shape, p);
                           const auto band = static_cast<std::size_t>(std::fabs(d) / threshold);
                           if (band < 1 || band >= crossing_bands) continue;
                           const double nearer = std::copysign(static_cast<double>(band) * threshold, d);
                           part[band + (d < 0 ? crossing_bands : 0)].add(p - nearer * normal_at(shape, p));
                       }
                       into(others, found.node, part);
                   });
    ShapeSums sums = added(own, {none.front()}).front();
    const std::vector<ShapeSums> banded = added(others, none);
    std::uint64_t crossing = 0;
    for (const std::size_t side : {std::size_t(0), crossing_bands}) {
        const auto begin = banded.begin() + static_cast<std::ptrdiff_t>(side);
        const auto fewest =
            std::min_element(begin + 1, begin + static_cast<std::ptrdiff_t>(crossing_bands),
                             [](const ShapeSums& a, const ShapeSums& b) { return a.points() < b.points(); });
        if (sums.points() <= fewest->points()) return {};
        sums.subtract(*fewest);
        crossing += fewest->points();
    }
    if (crossing == 0) return {};
    if (const auto plane = sums.step()) return PlaneWithoutCrossing{*plane, box.centre()};
    return {};
}

}  // namespace pcm
