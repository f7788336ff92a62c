// The numbers of fits at a place that no theory gives: each was chosen on scenes, and "Chosen" says on which. A
// benchmark draws the curve of a value again by its name (bench_place --sweep place.evidence.max_two_peaks;
// bench/README.md). Sizes and numbers of rounds stand where they are used. Numbers that estimation has too are in
// fit/tuning.h: the distance of an inlier, the share of chance points.
#pragma once

#include "pcm/place/edge_tuning.h"
#include "pcm/place/station_tuning.h"

#include <cstddef>

namespace pcm {

// Which neighbourhood of a place is fitted, and with which threshold.
struct NeighbourhoodTuning {
    // Points around a place that are looked at first, and that a place next to the surface leaves out.
    // Chosen: not swept.
    std::size_t first_points = 500;  // points
    // Points where wider neighbourhoods hold more of another surface.
    // Chosen: not swept.
    std::size_t closer_points = 125;  // points
    // Growth of the neighbourhood.
    // Chosen: not swept.
    std::size_t widening = 4;  // factor on the number of points
    // Nearest points of a place, that a shape at it passes through.
    // Chosen: not swept.
    std::size_t core_points = 50;  // points
    // Minimum gain of a threshold that is doubled.
    // Chosen: not swept.
    double min_gain = 0.02;  // logarithm of the number of false alarms per inlier
    // Maximum growth of the noise when the threshold is doubled; that of one surface is doubled at most.
    // Chosen: not swept.
    double max_noise_raised = 2.5;  // factor
    // Maximum noise relative to a fit at the same place that holds a fifth of the points: others are of several
    // surfaces. Posts as cylinders have 2.2 times and more that of a face, racks as planes 3; kinds that fit a mug by
    // stereo 1.5.
    // Chosen: by those three scenes; not swept.
    double max_noise_ratio = 2;  // factor
    // The same for a kind with more sizes in a wider neighbourhood: two slopes of a roof as a cylinder have twice the
    // noise of one slope.
    // Chosen: by roofs; not swept.
    double max_noise_wider = 1.3;  // factor
    // Minimum share of the points that a fit must hold to be compared with.
    // Chosen: with max_noise_ratio; not swept.
    double min_share = 0.2;  // share of the neighbourhood
    // Maximum noise of a threshold that does not cut it: a third where the threshold is three standard deviations, 0.58
    // where distances are even.
    // Chosen: not swept.
    double max_noise_share = 0.45;  // thresholds
    // Maximum noise at the first threshold with which no wider one is tried: noise within three standard deviations has
    // a third.
    // Chosen: 270 clicks on plants of two generators, and the Tango scan; not swept.
    double max_sure_noise = 0.37;  // thresholds
    // Maximum bend of the same: true shapes have 0.03 to 0.09. Errors that neighbours share are larger than those of
    // neighbours, and need the wider threshold.
    // Chosen: as max_sure_noise; not swept.
    double max_sure_bend = 0.1;  // share of the squared distances
};

// Whether points are those of one surface (one_surface.h).
struct EvidenceTuning {
    // Neighbours, the point itself among them, in whose means shared errors remain. Here and for CutOutTuning;
    // detection has means of a point and its 16 neighbours, which are as many.
    // Chosen: not swept.
    std::size_t neighbours = 17;  // points
    // Distance up to which points are the surface's. Growth raises a threshold to it, too. A little more than
    // fit.thresholds.inlier_noises: the noise was measured on points that a threshold had cut.
    // Chosen: not swept.
    double spread_noises = 3.3;  // standard deviations
    // Maximum of the coefficient of bimodality, to which two_peaks_by_chance is added. Fits to one surface have 0.27 to
    // 0.39 where there are 400 points (table by stereo: 0.40), and up to 0.48 of 60 points; plates, racks and posts
    // 0.43 to 0.87 of 500 points and more.
    // Chosen: 180 clicks on ray-cast plants, shapes among clutter, canopies, and the scans of GROUND_TRUTH.csv; 270
    // clicks on plants of two generators.
    double max_two_peaks = 0.43;  // coefficient
    // The root of the number of points is how chance spreads it: by 0.54 for Gaussian noise.
    // Chosen: as max_two_peaks; not swept.
    double two_peaks_by_chance = 0.5;  // coefficient times the root of the number of points
    // Coordinates that are exact up to their rounding have no peaks.
    // Chosen: not swept.
    double min_spread = 0.03;  // thresholds
    // A mug by stereo, whose errors neighbours share, has a bend of 0.58 to 0.79 with a slope of 0.39 at most, and of
    // 0.84 to 0.87 with 0.58 where all of it was reached; canopies called planes or spheres have slopes of 0.83
    // to 1.33.
    // Chosen: as max_two_peaks; not swept.
    double min_turned_bend = 0.3;  // share of the squared distances
    // Slope above which a surface is turned, where it has that bend.
    // Chosen: as max_two_peaks; not swept.
    double max_slope = 0.7;  // tangent
    // The same where a scanner's errors, which neighbours share, do not explain the bend: true shapes have slopes up to
    // 0.2 there, racks as planes and as wide cylinders 0.56.
    // Chosen: 180 clicks on a ray-cast and a sampled plant; not swept.
    double min_own_bend = 0.25;  // share of the squared distances
    // Chosen: with min_own_bend; not swept.
    double max_own_slope = 0.45;  // tangent
    // Above this bend errors are those of a scanner that neighbours share. Plates, racks and posts have bends up to
    // 0.39, the whole mug 0.47 to 0.53 of two_peaks.
    // Chosen: as max_two_peaks; not swept.
    double shared_bend = 0.6;  // share of the squared distances
    // Distance of a place from the surface that was picked there.
    // Chosen: 1.2 * spread_noises are four standard deviations; not swept.
    double place_spreads = 1.2;  // spreads of the fit
    // The same where the spread is far within the threshold.
    // Chosen: not swept.
    double place_share = 0.3;  // thresholds
};

// Whether points are a cut-out of another surface (cut_out_evidence.h).
struct CutOutTuning {
    // Minimum way from a point outside of the threshold to the next one within it, if the surface continues next to the
    // points; with a shorter way it is above them.
    // Chosen: not swept.
    double min_slant = 1.2;  // distances from the threshold
    // Way to the next point that the spacing explains.
    // Chosen: not swept.
    double gap = 1.5;  // spacings
    // Maximum overshoot of a shape's own points.
    // Chosen: not swept.
    double max_overshoot = 0.12;  // points outside of the threshold per point within it
    // Maximum bend of a surface that continues. A share of squares: detect.pieces.min_bend is its root.
    // Chosen: not swept.
    double max_bend = 0.4;  // share of the squared distances
    // Minimum share that the band next to the threshold has of the fullest one where a surface crosses the shape: the
    // face of a plate that is two thresholds thick has 0.15, for noise of a third of the threshold.
    // Chosen: twice that; not swept.
    double min_crossing = 0.3;  // points of the fullest band
    // Maximum noise of a surface that continues.
    // Chosen: not swept.
    double max_noise = 2;  // noise of the surface at the place
};

// Whether another kind fits the same points better (best_kind.h).
struct KindTuning {
    // Noise of another kind that fits far better.
    // Chosen: not swept.
    double far_less_noise = 0.3;  // noise of the fit
    // Noise that leaves nothing to explain, where it is also less than half_noise.
    // Chosen: not swept.
    double surface_noise = 1.25;  // noise of the surface at the place
    // Chosen: with surface_noise; not swept.
    double half_noise = 0.45;  // noise of the fit
    // Minimum share of the points that the other kind has.
    // Chosen: not swept.
    double min_share = 0.5;  // share of the points
    // Maximum radius of another kind than a plane: a weaker bend may be a scanner's error.
    // Chosen: not swept.
    double max_radius = 200;  // noise of the fit
    // Minimum gain of a kind of higher rank on a plane, whatever the number of points: walls are not quite flat. An arc
    // of 20 degrees that is 62 standard deviations from flat gains 1.2 where the neighbourhood is small.
    // Chosen: 270 clicks on a ray-cast and a sampled plant; not swept.
    double gain_on_plane = 1.1;  // factor on the likelihood per point
    // Minimum gain of a kind of higher rank on a curved one: cones of 10 degrees as cylinders.
    // Chosen: as gain_on_plane; not swept.
    double gain_on_curved = 1.02;  // factor on the likelihood per point
    // Evidence that a kind of higher rank needs on top of what its parameters cost.
    // Chosen: half the square of five standard deviations.
    double min_evidence = 12.5;  // logarithm of the likelihood ratio
    // Cubes in which errors are compared with those of their neighbours, for the number of independent points. Wide
    // ones, since what a shape is not bends over its whole extent.
    // Chosen: not swept.
    double agreement_cubes = 6;  // cubes per extent
};

// Whether points leave their shape together (departure.h).
struct DepartureTuning {
    // Minimum share of what is out of round, bulged or dented. Points of true shapes have 0 to 0.1, ovals of nine to
    // ten 0.3 to 0.8, and 0.18 where their flat side alone was reached; a wall of 1000 m radius 0.5 to 0.8.
    // Chosen: 430 clicks on ray-cast plants and sampled surfaces; not swept.
    double min_share = 0.15;  // share of the squared distances
    // Minimum share of what shifts of stations hide: elbows have 0.21 there where stations are 1.5 mm apart, by what a
    // scanner's beam does at their sides; pipes of 560 mm whose half axes differ by 20 mm 0.4 and more.
    // Chosen: 85 clicks on such plants; not swept.
    double min_hidden_share = 0.35;  // share of the squared distances
    // Maximum noise about the smooth surface: those scenes leave 0.7 to 1.2, scans with errors that neighbours share
    // 2.4 to 4.2 (Tango).
    // Chosen: as min_share; not swept.
    double max_rest = 1.6;  // noise of the points at the place
    // Maximum share where stations are known, beyond their shifts, whatever is left: of 185 good answers on three
    // ray-cast plants right ones have up to 0.35, pipes and reducers as a torus or a cylinder, and the legs of an angle
    // as a cylinder 0.42 to 0.86.
    //
    // Chosen: by those clicks; not swept.
    double max_share = 0.39;  // share of the squared distances
    // Maximum agreement of neighbours about the smooth surface.
    // Chosen: as following.max_other_agreement; not swept.
    double max_agreement = 1.35;  // factor on the errors
    // Minimum share of a departure that is doubted whatever it leaves: a tank whose half axes differ by 21 mm from
    // their mean has 0.94 where its rest is 3 times the noise.
    //
    // Chosen: between that and scans with errors that neighbours share; not swept.
    double min_dominant_share = 0.8;  // share of the squared distances
    // Minimum size of such a departure: that tank has 7.5 times.
    // Chosen: with min_dominant_share; not swept.
    double min_dominant_size = 4;  // noise of the points at the place and spread of the stations
    // Minimum size of a departure where stations are apart: pipes that three stations see are out of round by 0.5 to
    // 0.9 of that.
    // Chosen: by those; not swept.
    double min_station_spreads = 2;  // spread of the stations
};

// How a shape is followed through the cloud (grow_shape.h), and which points at its edges are left out.
struct GrowthTuning {
    // Maximum threshold that growth raises.
    // Chosen: not swept.
    double max_raised = 2.5;  // first thresholds
    // A threshold above this was raised to its limit. Slightly below max_raised, for rounding.
    // Chosen: with max_raised; not swept.
    double raised_limit = 2.4;  // first thresholds
    // Threshold above which it is lowered.
    // Chosen: of 282 good answers on two ray-cast plants 15 have more, half of them with points of other surfaces; not
    // swept.
    double max_wide = 4.5;  // standard deviations of the noise
    // Fewer inner points are not used alone.
    // Chosen: not swept.
    double min_inner = 0.5;  // share of the points
    // Fewer inner points show nothing of what edges do to a fit.
    // Chosen: not swept.
    std::size_t min_compared = 24;  // points
    // A shape that changes by less has converged.
    // Chosen: not swept.
    double settled_change = 0.25;  // standard deviations of its errors
    // Maximum share of points next to the shape where its points are inner ones; noise leaves less.
    // Chosen: not swept.
    double max_edge_share = 0.1;  // share of the points on the shape
    // Fewer points next to the shape may be noise.
    // Chosen: not swept.
    std::size_t min_edge_points = 2;  // points
    // Edge of the cubes in which points are counted: wider than the noise.
    // Chosen: not swept.
    double edge_cube = 2;  // thresholds
    // Mean number of points of a cube, below which cubes are doubled.
    // Chosen: not swept.
    double min_cube_points = 4;  // points
    // Error of what crossing surfaces are found to add to a plane (crossing_surfaces.h).
    // Chosen: chance alone makes a quarter where a web has 26 points of a flange; not swept.
    double crossing_error = 0.35;  // share of the correction
    // Cubes in which errors are compared with those of their neighbours. Detection has them, too.
    // Chosen: not swept.
    double agreement_cubes = 16;  // cubes per extent
    // Gap that a torus leaves, below which it is a ring without ends.
    // Chosen: not swept.
    double min_swept_gap = 0.35;  // radians
    // Fewer points of a torus show no ends.
    // Chosen: elbows of 60 to 200 points on three ray-cast scenes; not swept.
    std::size_t min_bent_points = 60;  // points
    // Minimum number of points of a cone or torus that is preferred to what was found first (fit_again.h).
    // Chosen: not swept.
    std::size_t min_swept_points = 200;  // points
    // Minimum gain of straight tubes at a torus's ends. Elbows of 90 degrees have radii 3 to 25 standard deviations off
    // with their pipes' points, and within three without.
    // Chosen: chance gives two ends 20 once in ten thousand.
    double min_tangent_gain = 20;  // variances of the noise
    // How far within the ends found points are the elbow's.
    // Chosen: not swept.
    double end_errors = 2;  // standard deviations of an end
    // Minimum share of the points that the swept part has.
    // Chosen: elbows of three radii with pipes of ten; not swept.
    double min_swept = 0.1;  // share of the points
};

// A narrower neighbourhood, beyond which the noise rises (even_noise.h).
struct EvenNoiseTuning {
    // Points of the narrowest one.
    // Chosen: not swept.
    std::size_t first_points = 24;  // points
    // Growth of the neighbourhood.
    // Chosen: not swept.
    double widening = 1.5;  // factor on the number of points
    // Level of the test of two variances.
    // Chosen: once in a thousand.
    double level = 3.0902;  // standard deviations of a normal deviate
};

// Whether the surface of points is turned away from the shape (turned_surface.h).
struct TurnedTuning {
    // Distance up to which points count: half a block, because a steep surface has points there, too.
    // Chosen: not swept.
    double counted = 1.5;  // edges of a cube
    // Minimum radius of a pipe whose surface blocks show. Racks of pipes up to 0.75 lose points where they are
    // compared; a pipe of 1.45 takes in points of other surfaces where they are not.
    //
    // Chosen: by those, ray-cast and sampled; not swept.
    double min_shown = 1.2;  // edges of a cube
    // A block is three cubes wide: its direction is known to a few degrees.
    // Chosen: not swept.
    double cube_noises = 6;  // standard deviations of the noise
    // Minimum number of points of a block with a direction.
    // Chosen: not swept.
    std::size_t min_block_points = 6;  // points
    // Minimum deviation of a direction that is turned.
    // Chosen: not swept.
    double deviations = 3;  // standard deviations of the direction
};

// The verdict on what was followed (fit_at.h).
struct FollowingTuning {
    // Fewer points of a neighbourhood that was chosen by its noise may be leaves: of 18 such fits of 216 clicks the
    // four on bushes, ray-cast and sampled, reached 57 to 106 points, those on surfaces 249 and more.
    // Chosen: by those clicks; not swept.
    std::size_t min_narrow_points = 120;  // points
    // Fewer points on a small surface may be a leaf: of 1,480 good answers on plants and bushes of two generators the
    // 13 on leaves have 39 to 432 points within 0.2 m, those on planes 483 and more, on pipes 300 and more along them.
    // Chosen: by those clicks; not swept.
    std::size_t min_small_points = 450;  // points
    // Chosen: with min_small_points; not swept.
    double max_small = 0.2;  // metres, diagonal of the box of the points
    // Maximum noise of a shape that still changes when all rounds are over, and whose neighbours share errors: ovals
    // that stations 1.5 mm apart see are followed around bit by bit.
    // Chosen: 1,360 clicks, of which two on ovals, one on a dented tank and one on a round one have more; not swept.
    double max_unsettled_noise = 0.4;  // thresholds
    // Maximum noise of a surface whose noise differs from place to place.
    // Chosen: not swept.
    double max_noise_growth = 3;  // noise at the place
    // Racks as planes and wide cylinders leave these by 4.5 to 6 times the noise of the closest points, and edges of
    // plates as cylinders by more than 3, with bends of 0.04 to 0.23 mostly; scans of real things by as much, with
    // bends of 0.27 (Tango) to 0.95 (a mug). True shapes leave these by 0.7 to 2.5 times that: noise across a surface
    // that is seen at a grazing angle is less than elsewhere.
    //
    // Chosen: by those scenes, and 270 clicks on plants of two generators; not swept.
    double max_close_noise = 3;  // noise of the closest points
    // Maximum noise of a surface whose two peaks are two stations that are apart: the two faces of a plate of 8 mm
    // leave the plane between them by 4 mm, where noise and stations are 1.5 mm each.
    //
    // Chosen: a pipe seen by two stations 4 mm apart; not swept.
    double max_station_noise = 1.5;  // noise of the closest points and spread of the stations, together
    // Maximum variance that such stations leave when their shifts are removed, relative to the part that does not lie
    // between two peaks: 0.7 to 1.1 for a beam, a plate and elbows that stations 1.5 mm apart see, 2.2 for crowns of a
    // rack.
    // Chosen: by those, of 120 clicks on a ray-cast plant; not swept.
    double max_left_by_stations = 1.5;  // factor on the variance
    // Chosen: with max_close_noise; not swept.
    double min_shared_bend = 0.25;  // share of the squared distances
    // Maximum noise where the threshold does not cut it. It decides a verdict on all points, which
    // place.neighbourhood.max_noise_share does not: of 105 good answers two of 93 right ones are above, and three of 12
    // wrong ones.
    // Chosen: by those clicks; not swept.
    double max_noise_share = 0.46;  // thresholds
    // Maximum noise of points that neighbours share, where stations are known: of 100 good answers on a ray-cast plant
    // right ones have up to 1.0, crowns of racks as planes 2.5 and 5.4, an elbow with its pipes 3.1.
    // Chosen: as departure.max_rest; not swept.
    double max_shared_noise = 1.6;  // noise of the closest points and spread of the stations, together
    // The same where stations are not known: shifts of these are among what neighbours share, as are errors of
    // scanners, which bend a surface smoothly. A square post of 200 mm as a cylinder has 6.3.
    //
    // Chosen: by that post, scans of real things have less; not swept.
    double max_unknown_noise = 4;  // noise of the closest points
    // Maximum noise of one surface, without what stations add to it. A plane over the crowns of a rack has 10.
    // Chosen: grazing angles double the noise; not swept.
    double max_smooth_noise = 2;  // noise of smooth surfaces around
    // Maximum noise of a curved shape where stations are known: of 185 good answers on three ray-cast plants right ones
    // have up to 0.98, square posts, angles and pipes with their reducers as cylinders 1.5 to 2.4.
    //
    // Chosen: by those clicks; not swept.
    double max_curved_noise = 1.3;  // StationsAround::surface_noise()
    // The same of the points of each station by itself, which shifts of stations do not hide. Of 230 good answers on
    // six ray-cast scenes right ones have up to 2.07, beams of 100 and 189 points as cone and cylinder 2.4 and 2.7.
    //
    // Chosen: by those clicks; not swept.
    double max_noise_within = 2.25;  // noise of smooth surfaces around
    // Maximum angle by which surfaces next to a narrow plane may have turned it (narrow_strip.h): right planes of two
    // ray-cast plants have up to 0.021, one of 60 has 0.037; oblique ones through a face 5 to 10 mm wide and the faces
    // next to it have 0.058 to 0.13, strips of pipes 0.037.
    // Chosen: by those; not swept.
    double max_strip_turn = 0.035;  // radians
    // Minimum share of the points next to which the cloud does not leave the shape, where they are few and others cross
    // it. On two ray-cast plants right planes and cones of fewer points have 0.19 and more, strips over pipes and
    // through faces 0 to 0.13, of 19 to 590 points; faces of posts and plates with a share of 0 have 1,345 and more.
    // Chosen: by those, of 266 good answers; not swept.
    double min_inner_share = 0.16;  // share of the points
    // The same where they lie along it, as the other face of a plate does.
    // Chosen: with min_inner_share: four of those have 0, faces of plates 0.3.
    double min_inner_along = 0.01;  // share of the points
    // Chosen: with min_inner_share.
    std::size_t max_few_points = 1000;  // points
    // Agreement of errors above which another kind is looked for.
    // Chosen: true shapes among 250 clicks have 1 to 1.34, most of them 1; not swept.
    double min_agreement = 1.05;  // factor on the errors
    // Maximum noise of another kind that is followed in its turn: more of it is that of more surfaces.
    // Chosen: an edge of a beam as a cone; not swept.
    double max_other_noise = 1.1;  // noise of the fit
    // Minimum number of its points.
    // Chosen: with max_other_noise; not swept.
    double min_other_share = 0.9;  // points of the fit
    // Maximum agreement of its errors, which it must explain, and relative to those of the first kind.
    // Chosen: a dent as a cone of 89 degrees has 0.9 of the plane's; not swept.
    double max_other_agreement = 1.35;  // factor on the errors
    // Chosen: with max_other_agreement; not swept.
    double less_agreement = 0.5;  // factor on the agreement of the first kind
};

struct PlaceTuning {
    NeighbourhoodTuning neighbourhood;
    EvidenceTuning evidence;
    CutOutTuning cut_outs;
    KindTuning kinds;
    DepartureTuning departure;
    GrowthTuning growth;
    EvenNoiseTuning even_noise;
    TurnedTuning turned;
    FollowingTuning following;
    FaceTuning faces;
    SideTuning sides;
    CornerAtPlaceTuning corners;
    PointOffTuning point_off;
    NarrowFaceTuning narrow_faces;
    NearPlaceTuning near_place;
    LevelTuning levels;
    RadiusStepTuning radius_steps;
    ThinPipeTuning thin_pipes;
    StationTuning stations;
    PatchTuning patches;
    FacingTuning facing;
};

// The values above, unless a benchmark has set one (tuned_values.h). Constant while anything works. A loop over points
// reads a value before it begins.
const PlaceTuning& place_tuning();

}  // namespace pcm
