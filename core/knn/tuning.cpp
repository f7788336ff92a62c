#include "pcm/knn/tuning.h"

#include "pcm/knn/tuned_values.h"

#include <array>

namespace pcm {
namespace {

KnnTuning knn_values;

}  // namespace

const KnnTuning& knn_tuning() { return knn_values; }

// A value without a row does not compile.
std::vector<TunedValue> knn_tuned_values()
{
    KnnTuning& knn = knn_values;
    const std::array<TunedValue, sizeof(KnnTuning) / sizeof(double)> all{{
        PCM_TUNED(knn.margin.first_points),
        PCM_TUNED(knn.margin.first_quantile),
        PCM_TUNED(knn.margin.first_factor),
        PCM_TUNED(knn.margin.next_quantile),
        PCM_TUNED(knn.margin.next_factor),
        PCM_TUNED(knn.widen.min_points),
        PCM_TUNED(knn.widen.points_per_unresolved),
        PCM_TUNED(knn.widen.large_share),
        PCM_TUNED(knn.widen.middle_share),
        PCM_TUNED(knn.widen.small_share),
        PCM_TUNED(knn.widen.blind_growth),
        PCM_TUNED(knn.widen.max_unit_multiple),
        PCM_TUNED(knn.widen.max_more_points),
        PCM_TUNED(knn.single.spare_neighbours),
    }};
    return {all.begin(), all.end()};
}

}  // namespace pcm
