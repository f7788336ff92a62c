#include "pcm/place/tuning.h"

#include "pcm/place/tuned_values.h"

#include <array>
#include <cstddef>
#include <tuple>

namespace pcm {
namespace {

PlaceTuning place_values;

template <class... Groups>
constexpr std::size_t values_of = (sizeof(Groups) + ...) / sizeof(double);

// A value without a row does not compile.
using ValuesAtPlace =
    std::array<TunedValue, values_of<NeighbourhoodTuning, EvidenceTuning, CutOutTuning, KindTuning, DepartureTuning>>;
ValuesAtPlace values_at_place(PlaceTuning& place)
{
    return {{
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
        PCM_TUNED(place.neighbourhood.max_sure_noise),
        PCM_TUNED(place.neighbourhood.max_sure_bend),
        PCM_TUNED(place.evidence.neighbours),
        PCM_TUNED(place.evidence.spread_noises),
        PCM_TUNED(place.evidence.max_two_peaks),
        PCM_TUNED(place.evidence.two_peaks_by_chance),
        PCM_TUNED(place.evidence.min_spread),
        PCM_TUNED(place.evidence.min_turned_bend),
        PCM_TUNED(place.evidence.max_slope),
        PCM_TUNED(place.evidence.min_own_bend),
        PCM_TUNED(place.evidence.max_own_slope),
        PCM_TUNED(place.evidence.shared_bend),
        PCM_TUNED(place.evidence.place_spreads),
        PCM_TUNED(place.evidence.place_share),
        PCM_TUNED(place.cut_outs.min_slant),
        PCM_TUNED(place.cut_outs.gap),
        PCM_TUNED(place.cut_outs.max_overshoot),
        PCM_TUNED(place.cut_outs.max_bend),
        PCM_TUNED(place.cut_outs.min_crossing),
        PCM_TUNED(place.cut_outs.max_noise),
        PCM_TUNED(place.kinds.far_less_noise),
        PCM_TUNED(place.kinds.surface_noise),
        PCM_TUNED(place.kinds.half_noise),
        PCM_TUNED(place.kinds.min_share),
        PCM_TUNED(place.kinds.max_radius),
        PCM_TUNED(place.kinds.gain_on_plane),
        PCM_TUNED(place.kinds.gain_on_curved),
        PCM_TUNED(place.kinds.min_evidence),
        PCM_TUNED(place.kinds.agreement_cubes),
        PCM_TUNED(place.departure.min_share),
        PCM_TUNED(place.departure.min_hidden_share),
        PCM_TUNED(place.departure.max_share),
        PCM_TUNED(place.departure.max_rest),
        PCM_TUNED(place.departure.max_agreement),
        PCM_TUNED(place.departure.min_dominant_share),
        PCM_TUNED(place.departure.min_dominant_size),
        PCM_TUNED(place.departure.min_station_spreads),
    }};
}

using ValuesOfGrowth = std::array<TunedValue, values_of<GrowthTuning, EvenNoiseTuning, TurnedTuning, FollowingTuning>>;
ValuesOfGrowth values_of_growth(PlaceTuning& place)
{
    return {{
        PCM_TUNED(place.growth.max_raised),
        PCM_TUNED(place.growth.raised_limit),
        PCM_TUNED(place.growth.max_wide),
        PCM_TUNED(place.growth.min_inner),
        PCM_TUNED(place.growth.min_compared),
        PCM_TUNED(place.growth.settled_change),
        PCM_TUNED(place.growth.max_edge_share),
        PCM_TUNED(place.growth.min_edge_points),
        PCM_TUNED(place.growth.edge_cube),
        PCM_TUNED(place.growth.min_cube_points),
        PCM_TUNED(place.growth.crossing_error),
        PCM_TUNED(place.growth.agreement_cubes),
        PCM_TUNED(place.growth.min_swept_gap),
        PCM_TUNED(place.growth.min_bent_points),
        PCM_TUNED(place.growth.min_swept_points),
        PCM_TUNED(place.growth.min_tangent_gain),
        PCM_TUNED(place.growth.end_errors),
        PCM_TUNED(place.growth.min_swept),
        PCM_TUNED(place.even_noise.first_points),
        PCM_TUNED(place.even_noise.widening),
        PCM_TUNED(place.even_noise.level),
        PCM_TUNED(place.turned.counted),
        PCM_TUNED(place.turned.min_shown),
        PCM_TUNED(place.turned.cube_noises),
        PCM_TUNED(place.turned.min_block_points),
        PCM_TUNED(place.turned.deviations),
        PCM_TUNED(place.following.min_narrow_points),
        PCM_TUNED(place.following.min_small_points),
        PCM_TUNED(place.following.max_small),
        PCM_TUNED(place.following.max_unsettled_noise),
        PCM_TUNED(place.following.max_noise_growth),
        PCM_TUNED(place.following.max_close_noise),
        PCM_TUNED(place.following.min_shared_bend),
        PCM_TUNED(place.following.max_shared_noise),
        PCM_TUNED(place.following.max_unknown_noise),
        PCM_TUNED(place.following.max_smooth_noise),
        PCM_TUNED(place.following.max_curved_noise),
        PCM_TUNED(place.following.max_noise_within),
        PCM_TUNED(place.following.max_strip_turn),
        PCM_TUNED(place.following.min_inner_share),
        PCM_TUNED(place.following.min_inner_along),
        PCM_TUNED(place.following.max_few_points),
        PCM_TUNED(place.following.max_noise_share),
        PCM_TUNED(place.following.min_agreement),
        PCM_TUNED(place.following.max_other_noise),
        PCM_TUNED(place.following.min_other_share),
        PCM_TUNED(place.following.max_other_agreement),
        PCM_TUNED(place.following.less_agreement),
        PCM_TUNED(place.following.max_station_noise),
        PCM_TUNED(place.following.max_left_by_stations),
    }};
}

using ValuesOfEdges = std::array<TunedValue, values_of<FaceTuning, SideTuning, CornerAtPlaceTuning, PointOffTuning,
                                                       NarrowFaceTuning, NearPlaceTuning, LevelTuning>>;
ValuesOfEdges values_of_edges(PlaceTuning& place)
{
    return {{
        PCM_TUNED(place.faces.min_gap),
        PCM_TUNED(place.faces.min_share),
        PCM_TUNED(place.faces.max_others),
        PCM_TUNED(place.sides.min_points),
        PCM_TUNED(place.sides.min_noises),
        PCM_TUNED(place.sides.min_spreads),
        PCM_TUNED(place.sides.min_gap),
        PCM_TUNED(place.sides.min_share),
        PCM_TUNED(place.sides.min_noise),
        PCM_TUNED(place.sides.max_within),
        PCM_TUNED(place.corners.plane_noises),
        PCM_TUNED(place.corners.reach_noises),
        PCM_TUNED(place.corners.min_share),
        PCM_TUNED(place.corners.beyond_border),
        PCM_TUNED(place.corners.max_within),
        PCM_TUNED(place.corners.min_back),
        PCM_TUNED(place.corners.min_held),
        PCM_TUNED(place.corners.min_held_to_doubt),
        PCM_TUNED(place.corners.min_held_of_curved),
        PCM_TUNED(place.corners.min_back_near),
        PCM_TUNED(place.corners.min_spread),
        PCM_TUNED(place.corners.min_edge_points),
        PCM_TUNED(place.corners.min_edge_share),
        PCM_TUNED(place.corners.min_margin),
        PCM_TUNED(place.corners.max_angle),
        PCM_TUNED(place.point_off.min_away),
        PCM_TUNED(place.point_off.nearest),
        PCM_TUNED(place.point_off.min_off),
        PCM_TUNED(place.point_off.far_away),
        PCM_TUNED(place.point_off.min_aside),
        PCM_TUNED(place.narrow_faces.border),
        PCM_TUNED(place.narrow_faces.min_border),
        PCM_TUNED(place.narrow_faces.max_growth),
        PCM_TUNED(place.narrow_faces.min_difference),
        PCM_TUNED(place.near_place.smallest),
        PCM_TUNED(place.near_place.widening),
        PCM_TUNED(place.near_place.sizes),
        PCM_TUNED(place.near_place.smallest_ball),
        PCM_TUNED(place.near_place.points),
        PCM_TUNED(place.near_place.min_gain),
        PCM_TUNED(place.near_place.max_loss),
        PCM_TUNED(place.near_place.max_off),
        PCM_TUNED(place.near_place.max_band_loss),
        PCM_TUNED(place.near_place.max_band_radius),
        PCM_TUNED(place.near_place.min_noise),
        PCM_TUNED(place.levels.max_noise),
        PCM_TUNED(place.levels.places),
        PCM_TUNED(place.levels.points),
        PCM_TUNED(place.levels.gap_noises),
        PCM_TUNED(place.levels.gap_spacings),
        PCM_TUNED(place.levels.neighbours),
        PCM_TUNED(place.levels.min_together),
        PCM_TUNED(place.levels.min_levels),
        PCM_TUNED(place.levels.min_share),
    }};
}

using ValuesOfPipes = std::array<TunedValue, values_of<RadiusStepTuning, ThinPipeTuning>>;
ValuesOfPipes values_of_pipes(PlaceTuning& place)
{
    return {{
        PCM_TUNED(place.radius_steps.points),       PCM_TUNED(place.radius_steps.slice_points),
        PCM_TUNED(place.radius_steps.max_slices),   PCM_TUNED(place.radius_steps.min_spreads),
        PCM_TUNED(place.radius_steps.min_radii),    PCM_TUNED(place.radius_steps.min_significance),
        PCM_TUNED(place.radius_steps.min_share),    PCM_TUNED(place.radius_steps.min_agreement),
        PCM_TUNED(place.thin_pipes.points),         PCM_TUNED(place.thin_pipes.step_growth),
        PCM_TUNED(place.thin_pipes.min_elongation), PCM_TUNED(place.thin_pipes.reach),
        PCM_TUNED(place.thin_pipes.max_radius),     PCM_TUNED(place.thin_pipes.sizes),
        PCM_TUNED(place.thin_pipes.min_radius),     PCM_TUNED(place.thin_pipes.circle_share),
        PCM_TUNED(place.thin_pipes.max_threshold),  PCM_TUNED(place.thin_pipes.beside),
        PCM_TUNED(place.thin_pipes.beside_radii),   PCM_TUNED(place.thin_pipes.max_beside),
        PCM_TUNED(place.thin_pipes.min_piece),      PCM_TUNED(place.thin_pipes.min_points),
        PCM_TUNED(place.thin_pipes.min_circle),     PCM_TUNED(place.thin_pipes.max_change),
        PCM_TUNED(place.thin_pipes.min_noise),      PCM_TUNED(place.thin_pipes.max_noise),
    }};
}

using ValuesOfStations = std::array<TunedValue, values_of<StationTuning, PatchTuning, FacingTuning>>;
ValuesOfStations values_of_stations(PlaceTuning& place)
{
    return {{
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
        PCM_TUNED(place.patches.max_first_deviation),
        PCM_TUNED(place.patches.max_deviation),
        PCM_TUNED(place.patches.max_unlike),
        PCM_TUNED(place.facing.min_cosine),
        PCM_TUNED(place.patches.min_seen),
        PCM_TUNED(place.patches.min_mixed),
        PCM_TUNED(place.patches.enough_by_chance),
        PCM_TUNED(place.patches.enough_freedom),
        PCM_TUNED(place.patches.places_elsewhere),
    }};
}

static_assert(std::tuple_size_v<ValuesAtPlace> + std::tuple_size_v<ValuesOfGrowth> + std::tuple_size_v<ValuesOfEdges> +
                  std::tuple_size_v<ValuesOfPipes> + std::tuple_size_v<ValuesOfStations> ==
              values_of<PlaceTuning>);

}  // namespace

const PlaceTuning& place_tuning() { return place_values; }

std::vector<TunedValue> place_tuned_values()
{
    std::vector<TunedValue> all;
    for (const TunedValue& value : values_at_place(place_values)) all.push_back(value);
    for (const TunedValue& value : values_of_growth(place_values)) all.push_back(value);
    for (const TunedValue& value : values_of_edges(place_values)) all.push_back(value);
    for (const TunedValue& value : values_of_pipes(place_values)) all.push_back(value);
    for (const TunedValue& value : values_of_stations(place_values)) all.push_back(value);
    return all;
}

}  // namespace pcm
