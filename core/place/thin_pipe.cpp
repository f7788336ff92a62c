#include "pcm/place/thin_pipe.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/near_tree.h"
#include "pcm/fit/pipe_start.h"
#include "pcm/fit/tuning.h"
#include "pcm/place/one_surface.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace pcm {
namespace {

constexpr std::size_t neighbours = 13;     // points nearest to one, itself among them
constexpr std::size_t circle_points = 60;  // the nearest ones, from pairs of which circles are drawn
constexpr int most_steps = 8;              // steps of a connection that are tried
constexpr std::size_t circle_bins = 24;
constexpr std::size_t sizes = 8;  // number of radii

// A circle through the place, seen along an axis; lengths relative to the place.
struct Circle {
    double u = 0, v = 0, radius = 0;
    double score = 0;
};

class ThinPipeSearch {
public:
    ThinPipeSearch(const Vec3d& place, double most_noise, const NearPoints& near)
        : place_(place), most_noise_(most_noise), near_(near), tree_(near.points.x, near.points.y, near.points.z)
    {
        connect();
    }

    // The pipe of most points among those of all sizes that have little noise, of the shortest steps that show any;
    // without a shape where there is none.
    ShapeFit run()
    {
        std::vector<ShapeFit> pipes;
        double step = near_.spacing;
        std::size_t before = 0;
        for (int tried = 0; tried < most_steps; ++tried, step *= tuned_.step_growth) {
            const std::vector<Vec3d> together = connected(step);
            if (together.size() == before) continue;
            before = together.size();
            if (const auto line = line_of(together, tuned_.min_elongation)) add_pipes_along(line->axis, pipes);
            if (!pipes.empty()) break;
        }
        double least = infinity;
        for (const ShapeFit& pipe : pipes) least = std::min(least, pipe.noise);
        ShapeFit best;
        for (ShapeFit& pipe : pipes)
            if (pipe.noise <= place_tuning().neighbourhood.max_noise_ratio * least &&
                (!best.has_shape() || pipe.inliers > best.inliers))
                best = std::move(pipe);
        return best;
    }

private:
    struct Step {
        double length = 0;
        std::uint32_t to = 0;
    };

    void connect()
    {
        std::vector<NearTree::Near> around;
        for (std::size_t i = 0; i < near_.points.size(); ++i) {
            tree_.nearest(near_.points.at(i), neighbours, around);
            steps_.emplace_back();
            for (const NearTree::Near& one : around) steps_.back().push_back({std::sqrt(one.square), one.index});
        }
    }

    // The points that steps of at most this length connect with the nearest one.
    std::vector<Vec3d> connected(double step) const
    {
        std::vector<Vec3d> points;
        std::vector<std::uint8_t> known(near_.points.size(), 0);
        std::vector<std::uint32_t> next{0};
        known[0] = 1;
        while (!next.empty()) {
            const std::uint32_t at = next.back();
            next.pop_back();
            points.push_back(near_.points.source(at));
            for (const Step& one : steps_[at]) {
                if (one.length > step || known[one.to]) continue;
                known[one.to] = 1;
                next.push_back(one.to);
            }
        }
        return points;
    }

    void add_pipes_along(const Vec3d& axis, std::vector<ShapeFit>& pipes) const
    {
        const AxisFrame frame(axis);
        for (const Circle& circle : circles_along(frame)) {
            if (!(circle.score > 0)) continue;
            Shape start{ShapeKind::cylinder, place_ + circle.u * frame.u + circle.v * frame.v, axis, circle.radius, 0};
            double threshold = tuned_.circle_share * circle.radius;
            ShapeFit best;
            // The longer the piece, the better its direction is known.
            for (double reach = tuned_.reach * near_.spacing; reach < 2 * near_.radius; reach *= 2) {
                ShapeFit pipe = pipe_of(start, reach, threshold);
                if (!pipe.has_shape()) break;
                start = pipe.shape;
                threshold =
                    std::min(tuned_.max_threshold * start.radius, place_tuning().evidence.spread_noises * pipe.noise);
                best = std::move(pipe);
            }
            if (best.inliers >= tuned_.min_points) pipes.push_back(std::move(best));
        }
    }

    // For each size the circle through the place that has most points more than lie next to it.
    std::array<Circle, sizes> circles_along(const AxisFrame& frame) const
    {
        std::vector<std::array<double, 2>> seen;
        for (std::size_t i = 0; i < near_.points.size(); ++i) {
            const Vec3d d = near_.points.source(i) - place_;
            if (std::fabs(dot(d, frame.axis)) <= tuned_.reach * near_.spacing)
                seen.push_back({dot(d, frame.u), dot(d, frame.v)});
        }
        std::sort(seen.begin(), seen.end(),
                  [](const auto& a, const auto& b) { return a[0] * a[0] + a[1] * a[1] < b[0] * b[0] + b[1] * b[1]; });
        const std::size_t count = std::min(seen.size(), circle_points);
        std::array<Circle, sizes> best{};
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const double turn = 2 * (seen[i][0] * seen[j][1] - seen[i][1] * seen[j][0]);
                const double a = seen[i][0] * seen[i][0] + seen[i][1] * seen[i][1],
                             b = seen[j][0] * seen[j][0] + seen[j][1] * seen[j][1];
                Circle circle{(seen[j][1] * a - seen[i][1] * b) / turn, (seen[i][0] * b - seen[j][0] * a) / turn, 0, 0};
                circle.radius = std::hypot(circle.u, circle.v);
                const double size =
                    std::log(tuned_.max_radius * near_.spacing / circle.radius) / std::log(tuned_.sizes);
                if (!(size >= 0 && size < sizes)) continue;
                circle.score = score_of(circle, seen);
                Circle& of_size = best[static_cast<std::size_t>(size)];
                if (circle.score > of_size.score) of_size = circle;
            }
        return best;
    }

    double score_of(const Circle& circle, const std::vector<std::array<double, 2>>& seen) const
    {
        double score = 0;
        const double wide = tuned_.circle_share * circle.radius;
        for (const auto& [u, v] : seen) {
            const double away = (std::hypot(u - circle.u, v - circle.v) - circle.radius) / wide;
            if (away > tuned_.beside) continue;
            score += std::fabs(away) <= 1 ? 1 - away * away : -1;
        }
        return score;
    }

    // The pipe of the points up to `reach` along it to both sides; refused where it is none.
    ShapeFit pipe_of(const Shape& start, double reach, double threshold) const
    {
        FitPoints points;
        points.origin = near_.points.origin;
        std::vector<std::size_t> numbers;
        for (std::size_t i = 0; i < near_.points.size(); ++i) {
            const Vec3d p = near_.points.source(i);
            if (std::fabs(dot(p - place_, start.axis)) > reach) continue;
            points.add(p);
            numbers.push_back(i);
        }
        RefineOptions refine;
        refine.threshold = threshold;
        ShapeFit pipe = refine_shape(points, start, refine);
        pipe.threshold = threshold;
        if (!pipe.has_shape() || !is_pipe(pipe, points)) return {};
        std::vector<std::uint8_t> is_inlier(near_.points.size(), 0);
        for (std::size_t i = 0; i < numbers.size(); ++i) is_inlier[numbers[i]] = pipe.is_inlier[i];
        pipe.is_inlier = std::move(is_inlier);
        return pipe;
    }

    bool is_pipe(const ShapeFit& pipe, const FitPoints& points) const
    {
        const Shape& shape = pipe.shape;
        if (!(pipe.noise < most_noise_) || !(shape.radius > tuned_.min_radius * pipe.noise) ||
            !(shape.radius <= tuned_.max_radius * near_.spacing) ||
            distance_to(shape, place_) > place_tuning().evidence.place_spreads * pipe.threshold)
            return false;
        double on = 0, beside = 0;
        std::array<std::uint8_t, circle_bins> seen{};
        const AxisFrame frame(shape.axis);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double away = signed_distance(shape, points.source(i));
            if (away > std::max(tuned_.beside * pipe.threshold, tuned_.beside_radii * shape.radius)) continue;
            if (std::fabs(away) > pipe.threshold) {
                beside += 1;
                continue;
            }
            on += 1;
            const double turn = (frame.angle_of(points.source(i) - shape.point) + pi) / (2 * pi);
            seen[std::min(circle_bins - 1, static_cast<std::size_t>(turn * static_cast<double>(circle_bins)))] = 1;
        }
        const double bins = std::accumulate(seen.begin(), seen.end(), 0.0);
        return on >= tuned_.min_piece && beside <= tuned_.max_beside * on &&
               bins >= tuned_.min_circle * static_cast<double>(circle_bins);
    }

    const Vec3d place_;
    const double most_noise_;
    const NearPoints& near_;
    const NearTree tree_;
    const ThinPipeTuning& tuned_ = place_tuning().thin_pipes;
    std::vector<std::vector<Step>> steps_;
};

}  // namespace

std::optional<LocalFit> fit_thin_pipe(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options,
                                      double most_noise)
{
    if (!options.may_choose(ShapeKind::cylinder)) return {};
    NearOptions around;
    around.places = true;
    around.count = place_tuning().thin_pipes.points;
    around.limit = options.limit;
    around.progress = options.progress;
    LocalFit pipe;
    pipe.near = points_near(cloud, place, around);
    if (pipe.near.ids.empty() || !(pipe.near.spacing > 0)) return {};
    pipe.fit = ThinPipeSearch(place, most_noise, pipe.near).run();
    if (!pipe.fit.has_shape()) return {};
    pipe.close = pipe.near;
    pipe.noise = fit_tuning().thresholds.inlier_noises * pipe.fit.noise;
    pipe.notes.push_back("the points around the place are those of several pipes: the " + grouped(pipe.fit.inliers) +
                         " points of its own one were fitted");
    return pipe;
}

}  // namespace pcm
