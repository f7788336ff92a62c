#include "pcm/detect/pipe_search.h"

#include "pcm/cloud/numbers.h"
#include "pcm/detect/sagitta.h"
#include "pcm/detect/seed_order.h"
#include "pcm/detect/tuning.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/shapes/axis_frame.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr std::array<std::size_t, 3> line_sizes{48, 96, 192};  // points of patches that are tried in turn

struct Line {
    Vec3d middle{}, axis{};
};

// The line along a patch that is longer than wide.
std::optional<Line> line_of(const std::vector<Vec3d>& points)
{
    Line line;
    const double share = 1 / static_cast<double>(points.size());
    for (const Vec3d& p : points) line.middle = line.middle + share * p;
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    for (const Vec3d& p : points) {
        const Vec3d d = p - line.middle;
        const Eigen::Vector3d e(d[0], d[1], d[2]);
        m += e * e.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
    const double least = detect_tuning().pipes.min_elongation;
    if (!(solver.eigenvalues()[2] > least * least * solver.eigenvalues()[1])) return std::nullopt;
    for (std::size_t a = 0; a < 3; ++a) line.axis[a] = solver.eigenvectors()(static_cast<Eigen::Index>(a), 2);
    return line;
}

// The cylinder along the line whose circle is nearest to the points: u^2 + v^2 = 2 a u + 2 b v + c.
std::optional<Shape> cylinder_along(const Line& line, const std::vector<Vec3d>& points)
{
    const AxisFrame frame(line.axis);
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Vec3d& p : points) {
        const double u = dot(p - line.middle, frame.u), v = dot(p - line.middle, frame.v);
        const Eigen::Vector3d row(2 * u, 2 * v, 1);
        m += row * row.transpose();
        right += (u * u + v * v) * row;
    }
    const Eigen::Vector3d x = m.ldlt().solve(right);
    const double square = x[2] + x[0] * x[0] + x[1] * x[1];
    if (!(square > 0) || !std::isfinite(square)) return std::nullopt;
    return Shape{ShapeKind::cylinder, line.middle + x[0] * frame.u + x[1] * frame.v, line.axis, std::sqrt(square), 0};
}

double extent_along(const Vec3d& axis, const std::vector<Vec3d>& points)
{
    double from = infinity, to = -infinity;
    for (const Vec3d& p : points) {
        from = std::min(from, dot(p, axis));
        to = std::max(to, dot(p, axis));
    }
    return to - from;
}

// The smallest angle about a cylinder's axis that holds this share of the points, by the share, radians: few points of
// another surface at its edge do not count as an arc.
double arc_of(const Shape& cylinder, const std::vector<Vec3d>& points, double share)
{
    const AxisFrame frame(cylinder.axis);
    std::vector<double> angles;
    for (const Vec3d& p : points)
        angles.push_back(std::atan2(dot(p - cylinder.point, frame.v), dot(p - cylinder.point, frame.u)));
    std::sort(angles.begin(), angles.end());
    const std::size_t count = angles.size(), held = static_cast<std::size_t>(share * static_cast<double>(count));
    for (std::size_t i = 0; i < held; ++i) angles.push_back(angles[i] + 2 * pi);
    double least = 2 * pi;
    for (std::size_t i = 0; i < count; ++i) least = std::min(least, angles[i + held] - angles[i]);
    return std::min(least / share, 2 * pi);
}

class PipeSearch {
public:
    PipeSearch(const SurfaceSample& sample, const PipeSearchOptions& options, std::vector<std::uint8_t>& taken)
        : sample_(sample), options_(options), growth_(sample, taken), tried_(sample.size(), 0)
    {
    }

    std::vector<FoundShape> run()
    {
        std::vector<FoundShape> found;
        std::size_t count = 0;
        for (const std::uint32_t seed :
             seeds_in_order(sample_, growth_, options_.seed, [](std::uint32_t) { return 0; })) {
            if (options_.check && ++count % 64 == 0) options_.check();
            if (!growth_.is_free(seed) || tried_[seed]) continue;
            FoundShape pipe = pipe_from(seed);
            if (pipe.points.empty()) continue;
            growth_.take(pipe, limits(pipe.threshold));
            found.push_back(std::move(pipe));
        }
        return found;
    }

private:
    GrowthLimits limits(double threshold) const { return {threshold, -1, options_.least}; }

    // Without points where there is none.
    FoundShape pipe_from(std::uint32_t seed)
    {
        const std::vector<std::uint32_t> all = growth_.patch(seed, line_sizes.back(), -1);
        for (std::size_t i = 0; i < std::min(all.size(), tuned_.tried_points); ++i) tried_[all[i]] = 1;
        for (const std::size_t size : line_sizes) {
            if (all.size() < size) break;
            const std::vector<std::uint32_t> patch(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(size));
            const std::vector<Vec3d> points = places_of(sample_, patch);
            const auto line = line_of(points);
            const auto start = line ? cylinder_along(*line, points) : std::nullopt;
            if (!start) continue;
            const ShapeFit fit = refine_shape(FitPoints::of(points), *start);
            if (!fit.has_shape() || fit.shape.radius > extent_along(fit.shape.axis, points)) continue;
            const double threshold = tuned_.kept_threshold * threshold_of(fit.shape, points);
            if (threshold < tuned_.min_noises * options_.noise) continue;
            FoundShape pipe = growth_.grow(fit.shape, patch, limits(threshold));
            if (pipe.points.size() >= options_.least && is_pipe(pipe)) return pipe;
        }
        return {};
    }

    // The largest one that does not hide the bend.
    double threshold_of(const Shape& shape, const std::vector<Vec3d>& points) const
    {
        const double sagitta = sagitta_of(shape, turn_of(shape, points));
        return std::min(options_.threshold, sagitta / detect_tuning().search.sagitta_thresholds);
    }

    bool is_pipe(const FoundShape& pipe) const
    {
        const std::vector<Vec3d> points = places_of(sample_, pipe.points);
        return threshold_of(pipe.shape, points) >= pipe.threshold &&
               arc_of(pipe.shape, points, tuned_.arc_share) >= tuned_.min_turn &&
               extent_along(pipe.shape.axis, points) >= tuned_.min_length * pipe.shape.radius && is_alone(pipe, points);
    }

    // Few other free points are within a few thresholds of its surface.
    bool is_alone(const FoundShape& pipe, const std::vector<Vec3d>& points) const
    {
        Box3d box;
        for (const Vec3d& p : points) box.extend(p + sample_.origin);
        std::size_t others = 0;
        for_points_near(sample_, box, pipe.shape, tuned_.alone_thresholds * pipe.threshold, [&](std::uint32_t i) {
            const double distance = distance_to(pipe.shape, sample_.at[i]);
            others +=
                growth_.is_free(i) && distance > pipe.threshold && distance <= tuned_.alone_thresholds * pipe.threshold;
        });
        return static_cast<double>(others) <= tuned_.max_others * static_cast<double>(points.size());
    }

    const SurfaceSample& sample_;
    const PipeSearchOptions& options_;
    const PipeTuning& tuned_ = detect_tuning().pipes;
    ShapeGrowth growth_;
    std::vector<std::uint8_t> tried_;
};

}  // namespace

std::vector<FoundShape> search_pipes(const SurfaceSample& sample, const PipeSearchOptions& options,
                                     std::vector<std::uint8_t>& taken)
{
    return PipeSearch(sample, options, taken).run();
}

}  // namespace pcm
