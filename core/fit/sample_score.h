// How well a shape explains all points; smaller is better.
#pragma once

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/working_points.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

enum class SampleScoring : std::uint8_t {
    count,       // points beyond the threshold
    squares,     // squared distances in units of the threshold, at most 1
    likelihood,  // minus the logarithm of the likelihood of Gaussian noise and uniform outliers; their share is found
                 // by expectation maximisation. The threshold is three standard deviations.
};

// One thread.
class SampleScore {
public:
    // `least_cosine` of the angle between a point's normal and the surface's; below 0: not compared.
    SampleScore(const WorkingPoints& points, const ShapeModel& model, SampleScoring scoring, double threshold,
                double least_cosine);

    struct Value {
        double score = 0;
        std::size_t inliers = 0;
        // Score of the first few of many points, which a worse shape fails by as much as chance does not explain.
        double of_first = 0;
    };
    // Gives up, with a score of at least best.score, where the shape is worse beyond chance.
    Value of(const Shape& shape, const Value& best);
    // Number of the first few points that are within this multiple of the threshold.
    std::size_t roughly_near(const Shape& shape, double thresholds);
    bool is_near(const Shape& shape, std::size_t i, double thresholds = 1) const;

private:
    Value summed(const Shape& shape, const Value& best);
    Value likelihood(const Shape& shape);
    std::size_t distances(const Shape& shape, std::size_t first);
    bool fits_normal(const Shape& shape, std::size_t i) const;

    const WorkingPoints& points_;
    const ShapeModel& model_;
    SampleScoring scoring_;
    double threshold_, least_cosine_;
    std::vector<double> distances_;
    std::vector<std::uint32_t> bins_;
};

}  // namespace pcm
