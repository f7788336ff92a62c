#include "pcm/fit/shape_search.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/least_squares.h"
#include "pcm/fit/point_normals.h"
#include "pcm/fit/sample_draw.h"
#include "pcm/fit/sample_score.h"
#include "pcm/fit/tuning.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t improved_points = 512;
constexpr unsigned flat_samples = 60;
constexpr std::size_t most_asked = 100;

// What the estimators are made of. In the order of the enumerators.
struct EstimatorParts {
    SampleScoring scoring;
    bool progressive;  // points of good quality are drawn first
    bool pretest;      // a sample is scored if one more point is near its shape: T(d,d) with d = 1
};
constexpr EstimatorParts parts_of[] = {
    {SampleScoring::count, false, false},       // ransac
    {SampleScoring::squares, false, false},     // msac
    {SampleScoring::likelihood, false, false},  // mlesac
    {SampleScoring::squares, true, false},      // prosac
    {SampleScoring::count, false, true},        // rransac
    {SampleScoring::squares, false, true},      // rmsac
};

class Search {
public:
    Search(const WorkingPoints& points, const SearchOptions& options)
        : points_(points),
          options_(options),
          model_(model_of(options.fit.kind)),
          parts_(parts_of[static_cast<std::size_t>(options.fit.estimator)]),
          normals_(points),
          draw_(points, normals_, model_.sampled, parts_.progressive, options.fit.seed),
          random_(options.fit.seed ^ 0x7e57),
          least_cosine_(options.fit.normal_angle < pi / 2 ? std::cos(options.fit.normal_angle) : -1),
          score_(points, model_, parts_.scoring, options.threshold, least_cosine_)
    {
        best_.score = best_.of_first = infinity;
    }

    SearchResult run()
    {
        double enough = options_.fit.iterations;  // samples
        for (; static_cast<double>(result_.samples) < enough; ++result_.samples) {
            // The number of samples needed may rise: the share shown never falls.
            done_ = std::max(done_, static_cast<double>(result_.samples) / enough);
            if (result_.samples % 16 == 0 && !options_.on(done_)) break;
            SampledPoint sample[most_sampled];
            if (!draw(sample)) continue;
            Shape solutions[most_solutions];
            const std::size_t count = model_.solve(sample, solutions);
            bool better = false;
            for (std::size_t i = 0; i < count; ++i) {
                if (parts_.pretest && !passes(solutions[i])) continue;
                better = consider(solutions[i]) || (model_.needs_normals && consider_roughly(solutions[i])) || better;
            }
            if (!better) continue;
            improve();
            if (model_.needs_normals)
                near_loosely_ = std::max(near_loosely_, score_.roughly_near(result_.shape, rough_normals_));
            enough = std::min<double>(options_.fit.iterations, samples_needed());
        }
        if (model_.flat_starts > 0) try_flat();
        return result_;
    }

private:
    // Samples do not determine an arc that is a plane within the threshold: least squares starts from that
    // plane then, with the axis in four directions.
    void try_flat()
    {
        const ShapeModel& plane_model = model_of(ShapeKind::plane);
        SampleScore score(points_, plane_model, SampleScoring::count, options_.threshold, least_cosine_);
        SampleScore::Value best{infinity, 0, infinity};
        // Only planes with half of the points at least.
        if (result_.found) best.score = best.of_first = static_cast<double>(points_.size() - best_.inliers / 2);
        Shape plane;
        bool found = false;
        for (unsigned k = 0; k < flat_samples; ++k) {
            SampledPoint sample[3];
            for (SampledPoint& point : sample) point.place = points_.at(random_.below(points_.size()));
            Shape solution;
            if (plane_model.solve(sample, &solution) == 0) continue;
            if (!score.is_near(solution, random_.below(points_.size()))) continue;
            const SampleScore::Value value = score.of(solution, best);
            if (!(value.score < best.score)) continue;
            best = value;
            plane = solution;
            found = true;
        }
        if (!found) return;
        PatchBand band{2 * options_.threshold, least_cosine_, improved_points};
        const SurfacePatch flat = improved(plane_model, plane_model.patch_at(plane, {}), points_, band, 4, 0.01);
        for (unsigned k = 0; k < model_.flat_starts; ++k) {
            SurfacePatch patch = models::patch_with_axis(flat.place, flat.a, flat.n);
            models::turn(patch, (k * pi / 4) * patch.n);
            patch.curvature = 1e-3;
            band.threshold = 2 * options_.threshold;
            improve(patch, band);
        }
    }

    bool draw(SampledPoint* sample)
    {
        std::size_t drawn[most_sampled];
        if (!draw_.draw(drawn)) return false;
        for (std::size_t i = 0; i < model_.sampled; ++i) sample[i].place = points_.at(drawn[i]);
        for (std::size_t i = 0; model_.needs_normals && i < model_.sampled; ++i) {
            sample[i].normal = normals_.at(drawn[i]);
            if (!(dot(sample[i].normal, sample[i].normal) > 0)) return false;
        }
        return true;
    }

    bool in_range(const Shape& shape) const
    {
        if (!is_proper(shape)) return false;
        if (!traits_of(shape.kind).has_radius()) return true;
        const double radius = narrowest_radius(shape);
        return radius >= options_.fit.least_radius && radius <= options_.fit.largest_radius && shape.radius < 1e7;
    }

    // Estimated normals lead to shapes that are near the surface, not within the threshold of most of it.
    bool passes(const Shape& shape)
    {
        return score_.is_near(shape, random_.below(points_.size()), model_.needs_normals ? rough_normals_ : 1);
    }

    bool consider(const Shape& shape)
    {
        if (!in_range(shape)) return false;
        const SampleScore::Value value = score_.of(shape, best_);
        if (!(value.score < best_.score)) return false;
        result_.shape = shape;
        best_ = value;
        result_.found = true;
        return true;
    }

    // Most of the surface may be near a shape of inexact normals and beyond the threshold of it: least squares decides.
    bool consider_roughly(const Shape& shape)
    {
        if (!in_range(shape)) return false;
        const std::size_t near = score_.roughly_near(shape, rough_normals_);
        if (near <= near_loosely_) return false;
        near_loosely_ = near;
        const double before = best_.score;
        improve(model_.patch_at(shape, {}), {rough_normals_ * options_.threshold, least_cosine_, improved_points});
        return best_.score < before;
    }

    // A least-squares fit of the points near the best sample.
    void improve()
    {
        improve(model_.patch_at(result_.shape, {}), {2 * options_.threshold, least_cosine_, improved_points});
    }

    void improve(SurfacePatch patch, PatchBand band)
    {
        for (unsigned round = 0; round < 2; ++round) {
            patch = improved(model_, patch, points_, band, 3, 0.1);
            band.threshold = options_.threshold;
            const Shape shape = model_.shape_of(patch);
            if (!in_range(shape)) return;
            consider(shape);
            patch = model_.patch_at(shape, {});
        }
    }

    // Share of the points near the best shape whose normals are about its own.
    double sound_normals()
    {
        const double least_cosine = std::cos(fit_tuning().sampling.sound_normal);
        std::size_t asked = 0, sound = 0;
        PatchBlock block;
        for (std::size_t i = 0; i < points_.size() && asked < most_asked; ++i) {
            const std::size_t of_block = i % patch_block;
            if (of_block == 0)
                model_.distances(result_.shape, &points_.x[i], &points_.y[i], &points_.z[i],
                                 std::min(patch_block, points_.size() - i), block.distance);
            if (!(std::fabs(block.distance[of_block]) <= options_.threshold)) continue;
            if (least_cosine_ > 0 && !score_.is_near(result_.shape, i)) continue;
            ++asked;
            sound += std::fabs(dot(normals_.at(i), normal_at(result_.shape, points_.at(i)))) >= least_cosine;
        }
        return asked > 0 ? std::max(1.0, static_cast<double>(sound)) / static_cast<double>(asked) : 1;
    }

    double samples_needed()
    {
        const double of_all = static_cast<double>(best_.inliers) / static_cast<double>(points_.size());
        const double drawn = draw_.share(of_all, [this](std::size_t i) { return score_.is_near(result_.shape, i); });
        const double sound = model_.needs_normals ? sound_normals() : 1;
        const double good =
            std::pow(drawn * sound, static_cast<double>(model_.sampled)) * (parts_.pretest ? of_all : 1);
        if (good >= 1) return 1;
        return good > 0 ? std::log1p(-options_.fit.probability) / std::log1p(-good) : options_.fit.iterations;
    }

    const WorkingPoints& points_;
    const SearchOptions& options_;
    const ShapeModel& model_;
    const EstimatorParts& parts_;
    SampleNormals normals_;
    SampleDraw draw_;
    SampleNumbers random_;
    double least_cosine_;
    const double rough_normals_ = fit_tuning().sampling.rough_normals;
    SampleScore score_;
    SampleScore::Value best_;
    double done_ = 0;               // share of the samples, as shown
    std::size_t near_loosely_ = 0;  // number near the sample or best shape with most of the first points
    SearchResult result_;
};

}  // namespace

SearchResult search_shape(const WorkingPoints& points, const SearchOptions& options)
{
    return Search(points, options).run();
}

}  // namespace pcm
