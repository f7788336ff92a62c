#include "pcm/fit/tuning.h"

#include "pcm/fit/tuned_values.h"

#include <array>

namespace pcm {
namespace {

FitTuning fit_values;

}  // namespace

const FitTuning& fit_tuning() { return fit_values; }

// A value without a row does not compile.
std::vector<TunedValue> fit_tuned_values()
{
    FitTuning& fit = fit_values;
    const std::array<TunedValue, sizeof(FitTuning) / sizeof(double)> all{{
        PCM_TUNED(fit.thresholds.inlier_noises),
        PCM_TUNED(fit.thresholds.residual_cut),
        PCM_TUNED(fit.thresholds.max_local_noise),
        PCM_TUNED(fit.thresholds.unknown_noise),
        PCM_TUNED(fit.thresholds.polish_noises),
        PCM_TUNED(fit.thresholds.max_polish_widening),
        PCM_TUNED(fit.consensus.max_chance),
        PCM_TUNED(fit.consensus.harmless_chance),
        PCM_TUNED(fit.consensus.harmless_influence),
        PCM_TUNED(fit.consensus.max_flat_noise),
        PCM_TUNED(fit.consensus.max_flat_chance),
        PCM_TUNED(fit.halving.narrow_share),
        PCM_TUNED(fit.halving.wide_share),
        PCM_TUNED(fit.halving.max_share),
        PCM_TUNED(fit.halving.min_improvement),
        PCM_TUNED(fit.halving.clear_log_false_alarms),
        PCM_TUNED(fit.halving.log_false_alarm_limit),
        PCM_TUNED(fit.halving.few_by_chance),
        PCM_TUNED(fit.halving.even_noise),
        PCM_TUNED(fit.halving.dense_bands),
        PCM_TUNED(fit.halving.settled_share),
        PCM_TUNED(fit.judgement.min_significance),
        PCM_TUNED(fit.judgement.good_significance),
        PCM_TUNED(fit.judgement.min_bend),
        PCM_TUNED(fit.judgement.error_factor),
        PCM_TUNED(fit.judgement.flat_curvature),
        PCM_TUNED(fit.mixture.min_points),
        PCM_TUNED(fit.mixture.min_reach),
        PCM_TUNED(fit.mixture.max_share),
        PCM_TUNED(fit.chance_test.tests_per_parameter),
        PCM_TUNED(fit.chance_test.max_share),
        PCM_TUNED(fit.chance_test.min_side),
        PCM_TUNED(fit.support.min_inliers),
        PCM_TUNED(fit.support.min_block_points),
        PCM_TUNED(fit.support.blocks),
        PCM_TUNED(fit.support.min_support),
        PCM_TUNED(fit.sampling.sound_normal),
        PCM_TUNED(fit.sampling.rough_normals),
        PCM_TUNED(fit.sampling.score_deviations),
        PCM_TUNED(fit.sampling.even_samples),
        PCM_TUNED(fit.sampling.min_share_points),
        PCM_TUNED(fit.ray_errors.min_mean_normal),
        PCM_TUNED(fit.ray_errors.min_along),
        PCM_TUNED(fit.ray_errors.left),
        PCM_TUNED(fit.ray_errors.min_beam_cosine),
        PCM_TUNED(fit.ray_errors.widest_beam),
        PCM_TUNED(fit.ray_errors.min_evidence),
    }};
    return {all.begin(), all.end()};
}

}  // namespace pcm
