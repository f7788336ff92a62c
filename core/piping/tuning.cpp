#include "pcm/piping/tuning.h"

#include "pcm/piping/tuned_values.h"

#include <array>

namespace pcm {
namespace {

PipingTuning piping_values;

}  // namespace

const PipingTuning& piping_tuning() { return piping_values; }

// A value without a row does not compile.
std::vector<TunedValue> piping_tuned_values()
{
    PipingTuning& piping = piping_values;
    const std::array<TunedValue, sizeof(PipingTuning) / sizeof(double)> all{{
        PCM_TUNED(piping.joints.error_sigmas),
        PCM_TUNED(piping.joints.radius_share),
        PCM_TUNED(piping.joints.max_radius_share),
        PCM_TUNED(piping.joints.offset_share),
        PCM_TUNED(piping.joints.max_offset),
        PCM_TUNED(piping.joints.angle),
        PCM_TUNED(piping.joints.max_angle),
        PCM_TUNED(piping.joints.max_gap),
        PCM_TUNED(piping.joints.max_overlap),
        PCM_TUNED(piping.joints.max_open_arc),
        PCM_TUNED(piping.corners.min_turn),
        PCM_TUNED(piping.corners.max_turn),
        PCM_TUNED(piping.corners.min_bend),
        PCM_TUNED(piping.corners.max_difference),
    }};
    return {all.begin(), all.end()};
}

}  // namespace pcm
