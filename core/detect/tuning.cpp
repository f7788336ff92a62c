#include "pcm/detect/tuning.h"

#include "pcm/detect/tuned_values.h"

#include <array>
#include <cstddef>
#include <tuple>

namespace pcm {
namespace {

DetectTuning detect_values;

template <class... Groups>
constexpr std::size_t values_of = (sizeof(Groups) + ...) / sizeof(double);

// A value without a row does not compile.
using SearchValues = std::array<TunedValue, values_of<SurveyTuning, ResolutionTuning, ShapeSearchTuning, PipeTuning>>;
SearchValues search_values(DetectTuning& detect)
{
    return {{
        PCM_TUNED(detect.survey.lower_quantile),
        PCM_TUNED(detect.survey.upper_quantile),
        PCM_TUNED(detect.survey.lower_factor),
        PCM_TUNED(detect.survey.upper_factor),
        PCM_TUNED(detect.survey.min_patch_width),
        PCM_TUNED(detect.survey.threshold_noises),
        PCM_TUNED(detect.survey.quiet_share),
        PCM_TUNED(detect.survey.quiet_beside),
        PCM_TUNED(detect.survey.dense_beside),
        PCM_TUNED(detect.survey.quiet_quantile),
        PCM_TUNED(detect.resolution.cell_noises),
        PCM_TUNED(detect.resolution.cell_spacings),
        PCM_TUNED(detect.resolution.coarser),
        PCM_TUNED(detect.resolution.edge_cells),
        PCM_TUNED(detect.resolution.reach_cells),
        PCM_TUNED(detect.resolution.min_coarse_points),
        PCM_TUNED(detect.resolution.edge_spacings),
        PCM_TUNED(detect.search.shadow),
        PCM_TUNED(detect.search.smooth_share),
        PCM_TUNED(detect.search.max_rough),
        PCM_TUNED(detect.search.curved_gain),
        PCM_TUNED(detect.search.min_arc),
        PCM_TUNED(detect.search.sagitta_thresholds),
        PCM_TUNED(detect.search.width_thresholds),
        PCM_TUNED(detect.search.min_strip_bend),
        PCM_TUNED(detect.search.thin_spacings),
        PCM_TUNED(detect.search.tried_points),
        PCM_TUNED(detect.pipes.threshold_share),
        PCM_TUNED(detect.pipes.cell),
        PCM_TUNED(detect.pipes.min_elongation),
        PCM_TUNED(detect.pipes.kept_threshold),
        PCM_TUNED(detect.pipes.min_noises),
        PCM_TUNED(detect.pipes.min_turn),
        PCM_TUNED(detect.pipes.arc_share),
        PCM_TUNED(detect.pipes.min_length),
        PCM_TUNED(detect.pipes.alone_thresholds),
        PCM_TUNED(detect.pipes.max_others),
        PCM_TUNED(detect.pipes.tried_points),
    }};
}

using ResultValues =
    std::array<TunedValue, values_of<PieceTuning, WideningTuning, ContestTuning, MergingTuning, FaceBorderTuning,
                                     JoiningTuning, ElbowTuning, PlateTuning, OutlineTuning, SharingTuning>>;
static_assert(std::tuple_size_v<SearchValues> + std::tuple_size_v<ResultValues> == values_of<DetectTuning>);
ResultValues result_values(DetectTuning& detect)
{
    return {{
        PCM_TUNED(detect.pieces.kept_sagitta),
        PCM_TUNED(detect.pieces.doubtful_edge),
        PCM_TUNED(detect.pieces.doubtful_bend),
        PCM_TUNED(detect.pieces.curved_bend),
        PCM_TUNED(detect.pieces.kept_width),
        PCM_TUNED(detect.pieces.min_edge),
        PCM_TUNED(detect.pieces.min_bend),
        PCM_TUNED(detect.pieces.min_outline),
        PCM_TUNED(detect.pieces.flat_rms),
        PCM_TUNED(detect.pieces.flat_outline),

        PCM_TUNED(detect.pieces.min_neighbours),
        PCM_TUNED(detect.pieces.min_beyond),
        PCM_TUNED(detect.pieces.max_beyond),
        PCM_TUNED(detect.pieces.max_step),
        PCM_TUNED(detect.widening.cells),
        PCM_TUNED(detect.widening.coarse_cells),
        PCM_TUNED(detect.widening.joined_share),
        PCM_TUNED(detect.widening.max_open_edge),
        PCM_TUNED(detect.widening.kept_share),
        PCM_TUNED(detect.widening.min_sampled),
        PCM_TUNED(detect.contest.min_noise),
        PCM_TUNED(detect.contest.max_width),
        PCM_TUNED(detect.contest.max_lost),
        PCM_TUNED(detect.contest.min_taken),
        PCM_TUNED(detect.merging.same_rms),
        PCM_TUNED(detect.merging.explained_share),
        PCM_TUNED(detect.merging.min_interior),
        PCM_TUNED(detect.faces.border),
        PCM_TUNED(detect.faces.reach),
        PCM_TUNED(detect.faces.max_cosine),
        PCM_TUNED(detect.faces.max_growth),
        PCM_TUNED(detect.joining.max_gap),
        PCM_TUNED(detect.joining.min_filled),
        PCM_TUNED(detect.joining.max_rms),
        PCM_TUNED(detect.joining.max_errors),
        PCM_TUNED(detect.joining.max_mixed),
        PCM_TUNED(detect.plates.min_cosine),
        PCM_TUNED(detect.plates.least_left),
        PCM_TUNED(detect.plates.min_certainty),
        PCM_TUNED(detect.plates.max_noise),
        PCM_TUNED(detect.plates.max_moved_noise),
        PCM_TUNED(detect.outlines.min_points),
        PCM_TUNED(detect.outlines.max_points),
        PCM_TUNED(detect.elbows.max_reach),
        PCM_TUNED(detect.elbows.threshold),
        PCM_TUNED(detect.elbows.min_points),
        PCM_TUNED(detect.elbows.min_bend),
        PCM_TUNED(detect.elbows.max_bend),
        PCM_TUNED(detect.elbows.max_piece),
        PCM_TUNED(detect.elbows.max_piece_rms),
        PCM_TUNED(detect.sharing.max_others),
        PCM_TUNED(detect.sharing.min_strip),
        PCM_TUNED(detect.sharing.max_own),
    }};
}

}  // namespace

const DetectTuning& detect_tuning() { return detect_values; }

std::vector<TunedValue> detect_tuned_values()
{
    const SearchValues search = search_values(detect_values);
    const ResultValues result = result_values(detect_values);
    std::vector<TunedValue> all(search.begin(), search.end());
    all.insert(all.end(), result.begin(), result.end());
    return all;
}

}  // namespace pcm
