#include "pcm/place/tuning.h"

#include "pcm/place/tuned_values.h"

#include <array>

namespace pcm {
namespace {

PlaceTuning place_values;

// A value without a row does not compile, neither one of these nor one of the others.
constexpr std::size_t last_values =
    (sizeof(TurnedTuning) + sizeof(FollowingTuning) + sizeof(StationTuning) + sizeof(PatchTuning)) / sizeof(double);

std::array<TunedValue, last_values> last_rows(PlaceTuning& place)
{
    return {{
        PCM_TUNED(place.turned.counted),
        PCM_TUNED(place.turned.cube_noises),
        PCM_TUNED(place.turned.min_block_points),
        PCM_TUNED(place.turned.deviations),
        PCM_TUNED(place.following.min_narrow_points),
        PCM_TUNED(place.following.max_noise_growth),
        PCM_TUNED(place.following.max_close_noise),
        PCM_TUNED(place.following.min_shared_bend),
        PCM_TUNED(place.following.max_noise_share),
        PCM_TUNED(place.stations.max_parts),
        PCM_TUNED(place.stations.min_gap),
        PCM_TUNED(place.stations.mean_gaps),
        PCM_TUNED(place.stations.min_points),
        PCM_TUNED(place.patches.enough),
        PCM_TUNED(place.patches.enough_stations),
        PCM_TUNED(place.patches.box_points),
        PCM_TUNED(place.patches.cube_points),
        PCM_TUNED(place.patches.min_points),
        PCM_TUNED(place.patches.max_points),
        PCM_TUNED(place.patches.min_station_points),
        PCM_TUNED(place.patches.max_thickness),
        PCM_TUNED(place.patches.min_width),
        PCM_TUNED(place.patches.min_overlap),
        PCM_TUNED(place.patches.max_noise),
        PCM_TUNED(place.patches.max_deviation),
        PCM_TUNED(place.patches.min_mixed),
        PCM_TUNED(place.patches.enough_by_chance),
    }};
}

}  // namespace

const PlaceTuning& place_tuning() { return place_values; }

std::vector<TunedValue> place_tuned_values()
{
    PlaceTuning& place = place_values;
    const std::array<TunedValue, sizeof(PlaceTuning) / sizeof(double) - last_values> first{{
        PCM_TUNED(place.neighbourhood.first_points),
        PCM_TUNED(place.neighbourhood.closer_points),
        PCM_TUNED(place.neighbourhood.widening),
        PCM_TUNED(place.neighbourhood.core_points),
        PCM_TUNED(place.neighbourhood.min_gain),
        PCM_TUNED(place.neighbourhood.max_noise_raised),
        PCM_TUNED(place.neighbourhood.max_noise_ratio),
        PCM_TUNED(place.neighbourhood.max_noise_wider),
        PCM_TUNED(place.neighbourhood.min_share),
        PCM_TUNED(place.neighbourhood.max_noise_share),
        PCM_TUNED(place.evidence.neighbours),
        PCM_TUNED(place.evidence.spread_noises),
        PCM_TUNED(place.evidence.max_two_peaks),
        PCM_TUNED(place.evidence.two_peaks_by_chance),
        PCM_TUNED(place.evidence.min_spread),
        PCM_TUNED(place.evidence.min_turned_bend),
        PCM_TUNED(place.evidence.max_slope),
        PCM_TUNED(place.evidence.shared_bend),
        PCM_TUNED(place.evidence.place_spreads),
        PCM_TUNED(place.evidence.place_share),
        PCM_TUNED(place.beyond.min_slant),
        PCM_TUNED(place.beyond.gap),
        PCM_TUNED(place.beyond.max_continued),
        PCM_TUNED(place.beyond.max_bend),
        PCM_TUNED(place.beyond.max_noise),
        PCM_TUNED(place.kinds.far_less_noise),
        PCM_TUNED(place.kinds.surface_noise),
        PCM_TUNED(place.kinds.half_noise),
        PCM_TUNED(place.kinds.min_share),
        PCM_TUNED(place.kinds.max_radius),
        PCM_TUNED(place.kinds.gain_on_plane),
        PCM_TUNED(place.kinds.gain_on_curved),
        PCM_TUNED(place.growth.max_raised),
        PCM_TUNED(place.growth.raised_limit),
        PCM_TUNED(place.growth.min_inner),
        PCM_TUNED(place.growth.settled_change),
        PCM_TUNED(place.growth.max_edge_share),
        PCM_TUNED(place.growth.min_edge_points),
        PCM_TUNED(place.growth.edge_cube),
        PCM_TUNED(place.growth.min_cube_points),
        PCM_TUNED(place.growth.agreement_cubes),
        PCM_TUNED(place.even_noise.first_points),
        PCM_TUNED(place.even_noise.widening),
        PCM_TUNED(place.even_noise.level),
    }};
    const auto last = last_rows(place);
    std::vector<TunedValue> all(first.begin(), first.end());
    all.insert(all.end(), last.begin(), last.end());
    return all;
}

}  // namespace pcm
