#include "pcm/fit/shape_search.h"

#include "pcm/fit/least_squares.h"
#include "pcm/fit/point_normals.h"
#include "pcm/fit/random_numbers.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t score_block = 512, improved_points = 4096;

class Search {
public:
    Search(const WorkingPoints& points, const SearchOptions& options)
        : points_(points),
          options_(options),
          model_(model_of(options.fit.kind)),
          normals_(points),
          random_(options.fit.seed),
          least_cosine_(options.fit.normal_angle < pi / 2 ? std::cos(options.fit.normal_angle) : -1)
    {
        limit_ = options.threshold * options.threshold;
        result_.score = std::numeric_limits<double>::infinity();
    }

    SearchResult run()
    {
        double enough = options_.fit.iterations;  // samples
        for (; static_cast<double>(result_.samples) < enough; ++result_.samples) {
            if (result_.samples % 16 == 0 && !options_.on(static_cast<double>(result_.samples) / enough)) break;
            SampledPoint sample[most_sampled];
            if (!draw(sample)) continue;
            Shape solutions[most_solutions];
            const std::size_t count = model_.solve(sample, solutions);
            bool better = false;
            for (std::size_t i = 0; i < count; ++i) better = consider(solutions[i]) || better;
            if (!better) continue;
            improve();
            enough = std::min<double>(options_.fit.iterations, samples_needed());
        }
        return result_;
    }

private:
    bool draw(SampledPoint* sample)
    {
        std::size_t drawn[most_sampled];
        for (std::size_t i = 0; i < model_.sampled; ++i) {
            drawn[i] = random_.below(points_.size());
            if (std::find(drawn, drawn + i, drawn[i]) != drawn + i) return false;
            sample[i].place = points_.at(drawn[i]);
        }
        for (std::size_t i = 0; model_.needs_normals && i < model_.sampled; ++i) {
            sample[i].normal = normals_.at(drawn[i]);
            if (!(dot(sample[i].normal, sample[i].normal) > 0)) return false;
        }
        return true;
    }

    bool in_range(const Shape& shape) const
    {
        const double radius = shape.kind == ShapeKind::torus ? shape.second : shape.radius;
        if (!is_proper(shape)) return false;
        if (!traits_of(shape.kind).radius) return true;
        return radius >= options_.fit.least_radius && radius <= options_.fit.largest_radius && shape.radius < 1e7;
    }

    bool consider(const Shape& shape)
    {
        if (!in_range(shape)) return false;
        const double score = score_of(shape);
        if (!(score < result_.score)) return false;
        result_.shape = shape;
        result_.score = score;
        result_.found = true;
        return true;
    }

    // Sum of the lesser of square and squared threshold; at least the best one so far where it is given up early.
    double score_of(const Shape& shape)
    {
        double score = 0, distances[score_block];
        inliers_ = 0;
        for (std::size_t first = 0; first < points_.size() && score < result_.score; first += score_block) {
            const std::size_t count = std::min(score_block, points_.size() - first);
            model_.distances(shape, &points_.x[first], &points_.y[first], &points_.z[first], count, distances);
            for (std::size_t i = 0; i < count; ++i) {
                const double square = distances[i] * distances[i];
                score += square < limit_ ? square : limit_;
                inliers_ += square < limit_;
            }
        }
        if (score < result_.score) best_inliers_ = inliers_;
        return score;
    }

    // Least squares of the points near the best sample.
    void improve()
    {
        PatchBand band{2 * options_.threshold, least_cosine_, improved_points};
        SurfacePatch patch = model_.patch_at(result_.shape, {});
        for (unsigned round = 0; round < 2; ++round) {
            patch = polish(model_, patch, points_, band, 4).patch;
            band.threshold = options_.threshold;
            const Shape shape = model_.shape_of(patch);
            if (!in_range(shape)) return;
            consider(shape);
            patch = model_.patch_at(shape, {});
        }
    }

    double samples_needed() const
    {
        const double share = static_cast<double>(best_inliers_) / static_cast<double>(points_.size());
        const double good = std::pow(share, static_cast<double>(model_.sampled));
        if (good >= 1) return 1;
        return good > 0 ? std::log1p(-options_.fit.probability) / std::log1p(-good) : options_.fit.iterations;
    }

    const WorkingPoints& points_;
    const SearchOptions& options_;
    const ShapeModel& model_;
    SampleNormals normals_;
    SampleNumbers random_;
    double least_cosine_, limit_ = 0;
    std::size_t inliers_ = 0, best_inliers_ = 0;
    SearchResult result_;
};

}  // namespace

SearchResult search_shape(const WorkingPoints& points, const SearchOptions& options)
{
    return Search(points, options).run();
}

}  // namespace pcm
