#include "pcm/gl/tuning.h"

#include "pcm/gl/tuned_values.h"

#include <array>

namespace pcm {
namespace {

GlTuning gl_values;

}  // namespace

const GlTuning& gl_tuning() { return gl_values; }

// A value without a row does not compile.
std::vector<TunedValue> gl_tuned_values()
{
    GlTuning& gl = gl_values;
    const std::array<TunedValue, sizeof(GlTuning) / sizeof(double)> all{{
        PCM_TUNED(gl.budget.first_points),
        PCM_TUNED(gl.budget.min_points),
        PCM_TUNED(gl.budget.min_points_in_view),
        PCM_TUNED(gl.budget.nearly_empty),
        PCM_TUNED(gl.budget.max_growth),
        PCM_TUNED(gl.budget.min_growth),
        PCM_TUNED(gl.budget.overhead_share),
        PCM_TUNED(gl.budget.max_rest_ms),
        PCM_TUNED(gl.budget.unmeasured_frames),
        PCM_TUNED(gl.cost.vertex),
        PCM_TUNED(gl.cost.splat),
        PCM_TUNED(gl.cost.pixel),
        PCM_TUNED(gl.cost.first_deviation),
        PCM_TUNED(gl.cost.change),
        PCM_TUNED(gl.cost.noise),
        PCM_TUNED(gl.cost.max_surprise),
        PCM_TUNED(gl.cost.min_factor),
        PCM_TUNED(gl.late.first_margin),
        PCM_TUNED(gl.late.min_margin),
        PCM_TUNED(gl.late.max_margin),
        PCM_TUNED(gl.late.up),
        PCM_TUNED(gl.late.down),
        PCM_TUNED(gl.late.first_frames),
        PCM_TUNED(gl.splats.paraboloid_radius),
        PCM_TUNED(gl.splats.fill),
        PCM_TUNED(gl.splats.max_fill),
        PCM_TUNED(gl.splats.one_place),
        PCM_TUNED(gl.splats.by_groups),
        PCM_TUNED(gl.smoothing.min_frames),
        PCM_TUNED(gl.smoothing.max_points),
        PCM_TUNED(gl.memory.protected_frames),
        PCM_TUNED(gl.memory.max_share),
        PCM_TUNED(gl.memory.min_share),
        PCM_TUNED(gl.memory.after_refusal),
        PCM_TUNED(gl.memory.after_success),
        PCM_TUNED(gl.loading.window),
        PCM_TUNED(gl.loading.rest_window),
        PCM_TUNED(gl.loading.retry_after),
        PCM_TUNED(gl.loading.max_lost),
        PCM_TUNED(gl.sample.points_per_classified),
        PCM_TUNED(gl.radii.box_megabytes),
        PCM_TUNED(gl.radii.dispatch_pairs),
    }};
    return {all.begin(), all.end()};
}

}  // namespace pcm
