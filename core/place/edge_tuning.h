// The numbers, as in tuning.h, of places whose nearest points are not those of one surface: next to edges, on plates,
// and on pipes side by side.
#pragma once

#include <cstddef>

namespace pcm {

// The face of a plate whose other face has more points (face_at_place.h).
struct FaceTuning {
    // Minimum distance between the faces.
    // Chosen: twelve plates of 8 to 25 mm that stations 1.5 mm apart see from both sides; not swept.
    double min_gap = 1.2;  // thresholds
    // Minimum share of the nearest points that lie on the face at the place: those plates have 0.14 to 0.45.
    // Chosen: as min_gap; not swept.
    double min_share = 0.1;  // share of the points
    // Maximum share of points on neither face: edges of plates, noise beyond the thresholds.
    // Chosen: as min_gap; not swept.
    double max_others = 0.25;  // share of the points
};

// Whether stations see a plane from two sides (station_sides.h).
struct SideTuning {
    // Minimum number of points of a station.
    // Chosen: not swept.
    double min_points = 20;  // points
    // Minimum distance between the groups: webs of beams have 5 noises where stations are not apart, other planes up to
    // 1.8 times noise and spread together.
    // Chosen: 80 planes of four ray-cast plants, with stations 1.5 mm apart and none; not swept.
    double min_noises = 2.2;  // standard deviations of the points
    // The same relative to how far stations are apart; both are added in quadrature.
    // Chosen: of single faces that three stations see far apart one of twelve is taken for two; not swept.
    double min_spreads = 2.8;  // standard deviations of the stations
    // Minimum gap between them: those webs have 0.5 to 0.97.
    // Chosen: as min_noises; not swept.
    double min_gap = 0.45;  // distances between the groups
    // Minimum share of the points of the smaller group. Fewer are of an edge, or of what stands next to the plane.
    // Chosen: not swept.
    double min_share = 0.1;  // share of the points
    // Minimum noise of planes that are looked at.
    // Chosen: not swept.
    double min_noise = 1.2;  // noise of smooth surfaces around
    // Maximum noise of a station's points: of 86 good planes on two plants right ones have 0.96 to 2.4, crowns of racks
    // 3.6 to 4.8.
    // Chosen: by those clicks; not swept.
    double max_within = 3;  // noise of smooth surfaces around
};

// The corner at a place (corner_at_place.h).
struct CornerAtPlaceTuning {
    // Maximum distance of a plane's points: less than that of inliers, since the faces of a plate are close together.
    // Chosen: 95 % of normal noise; not swept.
    double plane_noises = 2;  // standard deviations of the noise
    // Maximum distance of the points that belong to a face.
    // Chosen: as evidence.spread_noises; not swept.
    double reach_noises = 3.3;  // standard deviations of the noise
    // Minimum share of the nearest points that lie on the widest face.
    // Chosen: as neighbourhood.min_share; not swept.
    double min_share = 0.2;  // share of the points
    // Share of the points that lie beyond the border of their plane: mixed pixels.
    // Chosen: not swept.
    double beyond_border = 0.01;  // share of the points on the plane
    // Maximum distance of the place from the border, inwards.
    // Chosen: as reach_noises; not swept.
    double max_within = 3;  // standard deviations of the noise
    // Minimum share of the points that the back of a plate has, away from its edge.
    // Chosen: as faces.min_share; not swept.
    double min_back = 0.05;  // share of the points
    // Minimum share of the nearest points that lie on the faces of a corner.
    // Chosen: pipes as corners hold 0.3 to 0.7; narrow faces of beams among others 0.56 and more; not swept.
    double min_held = 0.55;  // share of the points
    // The same where they show that a place on a plane may lie on the face next to it.
    // Chosen: below min_held; not swept.
    double min_held_to_doubt = 0.3;  // share of the points
    // The same where the shape of most points is curved.
    // Chosen: as min_held; not swept.
    double min_held_of_curved = 0.75;  // share of the points
    // Share of the points behind the face that lie on its back where there is one.
    // Chosen: not swept.
    double min_back_near = 0.6;  // share of the points behind the face
    // Minimum standard deviation of the points along a direction in which they tilt a plane.
    // Chosen: as reach_noises; not swept.
    double min_spread = 3;  // standard deviations of the noise
    // Minimum number of points that show a face: noise has few.
    // Chosen: not swept.
    double min_edge_points = 8;  // points
    // Minimum number of these relative to the points of other faces next to it: the noise of those makes 0.2.
    // Chosen: one of six points is a standard deviation behind a face by chance; not swept.
    double min_edge_share = 0.35;  // points next to the face
    // Minimum margin of a place on a face.
    // Chosen: not swept.
    double min_margin = 2;  // standard deviations of the noise
    // Maximum angle between planes that are one.
    // Chosen: not swept.
    double max_angle = 0.35;  // radians
};

// Whether the point that was picked belongs to another surface than the shape found (point_off.h).
struct PointOffTuning {
    // Minimum distance of the point from a curved shape: those on the shape are farther once in three times.
    // Chosen: of 246 right answers on two ray-cast plants three are doubted with these numbers; not swept.
    double min_away = 1;  // standard deviations of the noise
    // Points next to the place that are looked at.
    // Chosen: not swept.
    std::size_t nearest = 10;  // points
    // Minimum number of these that are beyond the threshold.
    // Chosen: with min_away; not swept.
    std::size_t min_off = 2;  // points
    // Minimum distance of points to the same side, that of the point that was picked.
    // Chosen: with min_aside; not swept.
    double far_away = 2;  // standard deviations of the noise
    // Minimum number of these, the picked one included: of independent errors three are at one place in a thousand,
    // and where the picked one is the outermost under the pointer at one in fifty. On eight ray-cast scenes 4 of 25
    // wrong answers and 2 of 453 right ones are doubted; with 2 points one and two more, and in a window far more right
    // ones.
    //
    // Chosen: by those clicks; not swept.
    std::size_t min_aside = 3;  // points
};

// Planes that are fitted without the border along their outline, as faces of posts: there other surfaces meet them, and
// beams hit both (grow_shape.cpp).
struct NarrowFaceTuning {
    // Width of the border along the outline.
    // Chosen: as detect.faces.border; not swept.
    double border = 1.5;  // thresholds
    // Minimum share of the points that are of the border.
    // Chosen: not swept.
    double min_border = 0.05;  // share of the points
    // Error of the angle without the border, for the same noise, from which on it is used, too.
    // Chosen: as detect.faces.max_growth; not swept.
    double max_growth = 3;  // errors with it
    // Minimum difference of the fit to points that are next to no other surface, for the errors to contain it.
    // Chosen: not swept.
    double min_difference = 3;  // errors of that fit
};

// Where the radius of a pipe changes (radius_step.h).
struct RadiusStepTuning {
    // Points that are looked at.
    // Chosen: not swept.
    std::size_t points = 6000;  // points
    // Minimum number of points of a slice across the axis.
    // Chosen: not swept.
    std::size_t slice_points = 60;  // points
    // Maximum number of slices.
    // Chosen: not swept.
    std::size_t max_slices = 40;  // slices
    // Minimum step relative to how far stations are apart: what several see together changes its radius where one of
    // them sees no more of it.
    // Chosen: a reducer of 8.8 mm where the spread was taken for 4.3 mm; not swept.
    double min_spreads = 1.5;  // spreads
    // Minimum step relative to the pipe.
    // Chosen: pipes of standard sizes differ by more than a tenth; not swept.
    double min_radii = 0.05;  // radii
    // Minimum significance.
    // Chosen: not swept.
    double min_significance = 6;  // errors of the difference
    // Minimum share of the slices' differences that it explains: of a cone's it explains three quarters.
    // Chosen: by that; a run of three radii has 0.83.
    double min_share = 0.8;  // share
    // Minimum factor by which errors are larger than independent ones where a step is looked for.
    // Chosen: three pipes of one ray-cast plant that were followed through reducers have 13 to 15; not swept.
    double min_agreement = 2;  // factor
};

// The answer by the points next to the place alone (nearest_answer.h).
//
// Chosen, all of these: 310 clicks on four ray-cast scenes that were not right and good before, of 520.
struct NearPlaceTuning {
    // Points of the smallest neighbourhood.
    // Chosen: with 16, 40 and 100 points 144 are right within three deviations, with 40 and 100 134 (80 before).
    std::size_t smallest = 16;  // points
    // Growth of the neighbourhoods.
    // Chosen: as smallest; six neighbourhoods from 16 to 200 points find as many.
    double widening = 2.5;  // factor
    // Number of neighbourhoods.
    // Chosen: as smallest.
    std::size_t sizes = 3;  // neighbourhoods
    // Points of the smallest ball in which shapes are compared; each next one has twice as many.
    // Chosen: with balls of 12 to 100 points 148 are right, with one of 30 135.
    std::size_t smallest_ball = 12;  // points
    // Points around the place.
    // Chosen: as smallest_ball.
    std::size_t points = 100;  // points
    // Minimum gain on the answer that is not good.
    // Chosen: with 0, 0.5, 1 and 2 of right answers 15, 10, 7 and 6 are lost; right are 144, 143, 142 and 130.
    double min_gain = 1;  // NearLikelihood
    // Maximum loss where the shape is followed.
    // Chosen: with 0, 0.2 and 0.5 9, 20 and 23 good answers are right, 0, 1 and 1 are not.
    double max_loss = 0.3;  // NearLikelihood
    // Maximum distance of the point next to the place.
    // Chosen: with 3 two fewer right answers are lost, all of them next to edges, than without; with 2 as many.
    double max_off = 3;  // standard deviations of the noise
    // Maximum loss of a cylinder on a sphere: ten rims of flanges have up to 0.77, knobs, bodies of valves and heads
    // 0.72 to 12, and the others of 16 of them 1 and more.
    // Chosen: by those; not swept.
    double max_band_loss = 0.65;  // NearLikelihood
    // Maximum difference of their radii: the edge between rim and face is a far thinner cylinder.
    // Chosen: not swept.
    double max_band_radius = 0.2;  // radii of the sphere
    // Minimum noise of a good answer: one level of a depth camera has none, 20 answers of four ray-cast scenes 0.8 and
    // more.
    // Chosen: by those; not swept.
    double min_noise = 0.4;  // noise of smooth surfaces around
};

// Planes that are one level of a depth camera (depth_levels.h).
struct LevelTuning {
    // Maximum noise of a plane that may be one.
    // Chosen: two clouds of depth cameras have none; rounding to a tenth of the spacing leaves 0.03; not swept.
    double max_noise = 0.05;  // spacings
    // Places along the outline, of which half show levels.
    // Chosen: of 74 levels of those clouds 95 % show three at 0.7 of the places and more; not swept.
    std::size_t places = 8;  // number
    // Chosen: with places; they reach levels that are 15 spacings apart; not swept.
    std::size_t points = 1000;  // points around a place
    // Heights without points that divide levels.
    // Chosen: twelve deviations of rounding; not swept.
    double gap_noises = 3;  // standard deviations
    // Chosen: for points without any noise; those levels are 2.4 spacings apart and more; not swept.
    double gap_spacings = 0.001;  // spacings
    // The nearest points of one, of which most lie on its level: of a row on the side of a box two do.
    // Chosen: not swept.
    std::size_t neighbours = 8;  // points
    // Chosen: with neighbours; not swept.
    double min_together = 0.6;  // share of them
    // Two are the faces of a plate.
    // Chosen: not swept.
    std::size_t min_levels = 3;  // number
    // Points that lie on levels.
    // Chosen: those clouds have 0.91 and more at most places; not swept.
    double min_share = 0.9;  // share of the points
};

// A pipe that is thin relative to the distance of points (thin_pipe.h).
struct ThinPipeTuning {
    // Points around the place.
    // Chosen: not swept.
    std::size_t points = 2000;  // points
    // Growth of the step that connects points, from their spacing on.
    // Chosen: not swept.
    double step_growth = 1.2;  // factor
    // Minimum standard deviation of connected points along their line.
    // Chosen: as detect.pipes.min_elongation; not swept.
    double min_elongation = 3;  // standard deviations across it
    // Length of the first piece of a pipe, to both sides of the place.
    // Chosen: not swept.
    double reach = 10;  // spacings
    // Maximum radius: others are found by their points' neighbours.
    // Chosen: not swept.
    double max_radius = 6;  // spacings
    // Ratio of the radii of two sizes, of each of which the best circle is tried.
    // Chosen: not swept.
    double sizes = 1.4;  // factor
    // Minimum radius.
    // Chosen: not swept.
    double min_radius = 3;  // standard deviations of the noise
    // Maximum distance of a point from the first circle.
    // Chosen: not swept.
    double circle_share = 0.2;  // radii
    // Maximum threshold of a pipe.
    // Chosen: not swept.
    double max_threshold = 0.5;  // radii
    // Distance up to which other points count against a pipe, outwards; all inside do.
    // Chosen: not swept.
    double beside = 3;  // thresholds
    // The same relative to the size: in the noise of a surface are thinner pipes by chance.
    // Chosen: gaps of racks are wider; not swept.
    double beside_radii = 0.75;  // radii
    // Maximum number of those.
    // Chosen: not swept.
    double max_beside = 0.4;  // points on the pipe
    // Minimum number of points of its first piece.
    // Chosen: not swept.
    double min_piece = 12;  // points
    // Minimum number of points on it.
    // Chosen: not swept.
    std::size_t min_points = 30;  // points
    // Minimum part of its circle that has points: edges of posts have a quarter and more.
    // Chosen: by one of those; not swept.
    double min_circle = 0.4;  // turns
    // Maximum change of its radius where it is followed.
    // Chosen: not swept.
    double max_change = 1.5;  // factor
    // Minimum noise of a good shape that it is tried for: crowns of racks have 3 and more.
    // Chosen: not swept.
    double min_noise = 2;  // noise of smooth surfaces around
    // Maximum noise relative to that of another shape at the place.
    // Chosen: as neighbourhood.max_noise_ratio; not swept.
    double max_noise = 0.5;  // noise of the other shape
};

}  // namespace pcm
