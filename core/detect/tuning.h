// The numbers of detection that no theory gives: each was chosen on scenes, and "Chosen" says on which. A benchmark
// draws the curve of a value again by its name (bench_detect --sweep detect.pieces.min_bend; bench/README.md). Sizes of
// units and of patches stand where they are used. Numbers that estimation has too are in fit/tuning.h.
#pragma once

#include <cstddef>

namespace pcm {

// Noise and threshold of a whole cloud.
struct SurveyTuning {
    // Noise varies with the distance and the angle that a scanner sees a surface at, and patches of trees are not
    // surfaces: the larger part of the noise of surfaces is estimated by the lesser of two quantiles, times what they
    // differ by where all patches are surfaces.
    // Chosen: not swept.
    double lower_quantile = 0.35;  // share of the patches
    // Chosen: with lower_quantile; not swept.
    double upper_quantile = 0.5;  // share of the patches
    // Chosen: with lower_quantile; not swept.
    double lower_factor = 1.5;  // factor on the lower quantile
    // Chosen: with lower_quantile; not swept.
    double upper_factor = 1.25;  // factor on the upper quantile
    // Minimum width of a patch, so that the noise does not choose the patch's points.
    // Chosen: not swept.
    double min_patch_width = 8;  // noise
    // Threshold of a detection. More than fit.thresholds.inlier_noises: the noise is that of a whole cloud, and differs
    // from place to place.
    // Chosen: not by a curve; from 3 to 5 recall is the same (bench_detect, bench/results/fitting/tuning.md).
    double threshold_noises = 4;  // standard deviations
    // Noise below which a part of the cloud is searched by itself, with its own threshold: a plant scanned on the
    // ground within a drone's cloud, say.
    // Chosen: noises of such scanners differ by ten and more, of one scanner's ranges by less; not swept.
    double quiet_share = 0.15;  // share of the cloud's noise
    // Noise below which a place is of such a part where the cloud has one.
    // Chosen: pipes and edges of a plant in a drone's cloud raise its noise to 0.3, terrain has 0.58 and more; not
    // swept.
    double quiet_beside = 0.4;  // share of the cloud's noise
    // Spacing of a place that is of such a part whatever its noise: pipes and edges show none that is low.
    // Chosen: with quiet_beside; not swept.
    double dense_beside = 0.25;  // share of the cloud's spacing
    // Patches of bushes in such a part have more.
    // Chosen: with quiet_share; not swept.
    double quiet_quantile = 0.15;  // share of the patches
};

// How dense the samples are in which shapes are searched, and how far a shape reaches in them.
struct ResolutionTuning {
    // Shapes need many points, but none nearer than their noise is wide.
    // Chosen: not swept.
    double cell_noises = 5;  // standard deviations
    // Chosen: not swept.
    double cell_spacings = 0.5;  // spacings
    // One resolution and the next one.
    // Chosen: not swept.
    double coarser = 4;  // factor on the cell
    // Where a shape was found its samples have no normals at their edges.
    // Chosen: not swept.
    double edge_cells = 4;  // cells of the resolution that found it
    // Distance that a shape may reach beyond where it was found.
    // Chosen: not swept.
    double reach_cells = 20;  // cells
    // Minimum number of sample points of a shape at all resolutions but the finest.
    // Chosen: not swept.
    std::size_t min_coarse_points = 60;  // points
    // Longest edge between neighbours where none was asked for.
    // Chosen: not swept.
    double edge_spacings = 2.5;  // spacings
};

// Shapes among the points of a sample.
struct ShapeSearchTuning {
    // Points up to this distance from a shape belong to no other one of the same normal.
    // Chosen: not swept.
    double shadow = 2;  // thresholds
    // Minimum share of a patch's points near its paraboloid.
    // Chosen: not swept.
    double smooth_share = 0.8;  // share of the patch
    // Maximum roughness of a patch.
    // Chosen: not swept.
    double max_rough = 0.5;  // thresholds
    // A curved shape has more points than the plane by this factor.
    // Chosen: not by a curve; flat from 1.05 to 1.3 (bench_detect, bench/results/fitting/tuning.md).
    double curved_gain = 1.15;  // factor
    // Minimum turn of a curved shape's normals.
    // Chosen: not swept.
    double min_arc = 0.5;  // radians
    // Sagitta of a curved shape where its points are (sagitta.h), and width of a plane: below, the threshold hides what
    // bends there, and a plane or several shapes have the points as well.
    // Chosen: a third of the sagitta is the largest threshold at which pipes seen from one side keep their radius; not
    // swept.
    double sagitta_thresholds = 3;  // thresholds
    // Chosen: the chord within a threshold of a plane in a pipe of three thresholds' radius, the thinnest one that is
    // not refused, is 5.7; not swept.
    double width_thresholds = 6;  // thresholds
    // Bend across a narrow plane from which on a cylinder along it is tried: what a threshold cuts out of a pipe bends
    // by two.
    // Chosen: half of that, for pipes of which a part is hidden; not swept.
    double min_strip_bend = 0.5;  // thresholds
    // Radius of a pipe below which normals of its points, out of 16 neighbours, show nothing of it.
    // Chosen: 16 points are 4.5 spacings across; not swept.
    double thin_spacings = 5;  // spacings
    // Points around a seed without a shape that are not tried again.
    // Chosen: not swept.
    std::size_t tried_points = 12;  // points
};

// Thin pipes among the points that belong to nothing (pipe_search.h).
struct PipeTuning {
    // Threshold of the second search, for pipes and all kinds, among the points that the first one left.
    // Chosen: two standard deviations of the survey's noise, an upper estimate; not swept.
    double threshold_share = 0.5;  // share of the first search's threshold
    // Size of the cells of its sample.
    // Chosen: pipes have few points, none to lose; not swept.
    double cell = 0.5;  // thresholds
    // Standard deviations of a patch along and across its line.
    // Chosen: not swept.
    double min_elongation = 2;  // factor
    // A pipe's threshold is this share of the largest one that does not hide its bend: its radius is not known yet.
    // Chosen: not swept.
    double kept_threshold = 0.9;  // share
    // Below this threshold least squares sees noise alone.
    // Chosen: a pipe of five noises' radius, seen from one side, has 1.5; not swept.
    double min_noises = 1.25;  // standard deviations
    // Chosen: a scanner sees half of a pipe, pi, less where it is grazed; not swept.
    double min_turn = 1.4;  // radians
    // Share of a pipe's points that the turn is measured at.
    // Chosen: a strip of a post's side with 4 % of its points around the edge has a turn of 2.5 of all points, 1.3 of
    // these; not swept.
    double arc_share = 0.9;  // share of the points
    // Chosen: three diameters; not swept.
    double min_length = 6;  // radii
    // Points up to this distance that are not the pipe's.
    // Chosen: not swept.
    double alone_thresholds = 4;  // thresholds
    // Chosen: Gaussian noise of two thirds of the threshold leaves 0.15; not swept.
    double max_others = 0.35;  // share of the pipe's points
    // Points around a seed without a pipe that are not tried again.
    // Chosen: with detect.search.tried_points; not swept.
    std::size_t tried_points = 24;  // points
};

// Which parts of surfaces the threshold cuts out of something bent (assign_points.h).
struct PieceTuning {
    // Minimum share of the edge where the surface of a piece continues.
    // Chosen: not swept.
    double min_edge = 0.2;  // share of the edge
    // Minimum root of the share of squared distances that is left in means of 17; noise leaves 0.24. As a share that is
    // 0.16, where a fit at a place needs place.beyond.max_bend, 0.4: a piece here must also continue along much of its
    // outline.
    // Chosen: not by a curve; flat from 0.2 to 0.4, more ground at 0.6 (bench_detect, bench/results/fitting/tuning.md).
    double min_bend = 0.4;  // rms of the means per rms of the distances
    // Minimum length of the outline where it continues.
    // Chosen: not swept.
    double min_outline = 1.5;  // roots of the number of points
    // Rms of distances below which the threshold cuts no bend: a piece then continues along flat_outline, and a surface
    // within a wider threshold is whole.
    // Chosen: not swept.
    double flat_rms = 0.2;  // thresholds
    // Chosen: with flat_rms; not swept.
    double flat_outline = 4;  // roots of the number of points
    // Sagitta of a curved shape as wide as its part's box, from which on a piece is kept, as doubtful: vessels between
    // round heads, pipes between elbows.
    // Chosen: a vessel of a plant has 100, a crest of hills about 5; not swept.
    double kept_sagitta = 10;  // thresholds
    // Share of its edge where a surface continues, and bend as min_bend, from which on a primitive is doubted.
    // Chosen: with curved_bend, of 85 good primitives of hills 2 are left, and those of a plant; not swept.
    double doubtful_edge = 0.05;  // share of the edge
    // Chosen: with doubtful_edge; not swept.
    double doubtful_bend = 0.49;  // rms of the means per rms of the distances
    // Bend from which on a primitive that is curved, or has more noise than the cloud, is doubted whether its surface
    // continues or not.
    // Chosen: right cylinders and spheres of a plant whose stations are apart by their noise have up to 0.58, most of
    // hills and cones that are taken for cylinders 0.63 to 0.95; not swept.
    double curved_bend = 0.6;  // rms of the means per rms of the distances
    // Mean width of a plane's part, its area by its box's diagonal, from which on a piece is kept, as doubtful: floors,
    // ceilings and walls.
    // Chosen: keeps a floor of an indoor scan of 80,000 points, and few pieces of hills; not swept.
    double kept_width = 50;  // thresholds
    // A surface continues at a point where this many neighbours' surroundings are next to the threshold.
    // Chosen: not swept.
    std::size_t min_neighbours = 3;  // points
    // Distances from the shape that are next to the threshold.
    // Chosen: not swept.
    double min_beyond = 0.7;  // thresholds
    // Chosen: with min_beyond; not swept.
    double max_beyond = 4;  // thresholds
    // Step between means of neighbours on a shape and beyond it, more than their slope makes, from which on they are
    // on two surfaces, as the faces of a plate are.
    // Chosen: two standard deviations of the noise; not swept.
    double max_step = 0.5;  // thresholds
};

// Wider thresholds of cut-outs of rough surfaces (wider_shapes.h).
struct WideningTuning {
    // Cells of the samples in which larger thresholds are tried, and of the coarse ones among them.
    // Chosen: not swept.
    double cells = 3;  // cells of the finest sample
    // Chosen: not swept.
    double coarse_cells = 9;  // cells of the finest sample
    // Share of the points of two layers that a shape for both has.
    // Chosen: not swept.
    double joined_share = 0.9;  // share of the points
    // Maximum share of its edge where a whole surface may seem to continue.
    // Chosen: not swept.
    double max_open_edge = 0.1;  // share of the edge
    // Minimum share of a piece's points on a shape with the widest threshold.
    // Chosen: not swept.
    double kept_share = 0.5;  // share of the points
    // Minimum number of sample points of a part that is looked at.
    // Chosen: not swept.
    std::size_t min_sampled = 100;  // points
};

// Planes over several surfaces, whose points the second search looks at again (FinalFit::contested).
struct ContestTuning {
    // Noise of a plane over several pipes or steps, of the cloud's.
    // Chosen: 95 % of a plant's right planes have up to 1.04, strips of pipes and steps of 10 mm 1.15 and more; not
    // swept.
    double min_noise = 1.15;  // share of the cloud's noise
    // Mean width of a plane's part, as for detect.pieces.kept_width, up to which it is searched again: floors and walls
    // are not.
    // Chosen: the sides of two posts and of a beam between them, 10 mm apart, have about 45; not swept.
    double max_width = 100;  // thresholds
    // Share of its points from which on what the second search has found replaces it.
    // Chosen: not swept.
    double max_lost = 0.5;  // share of the points
    // Share of a good shape's points that good shapes of the second search have, below which it keeps its points.
    // Chosen: one of two faces has half; not swept.
    double min_taken = 0.75;  // share of the points
};

// Which hypotheses are one surface (hypotheses.h), and the final fit of its points.
struct MergingTuning {
    // Maximum rms distance of a shape's points from another that is the same.
    // Chosen: not swept.
    double same_rms = 1.35;  // rms distance from their own shape
    // Minimum share of a shape's points on a larger one that explains it.
    // Chosen: not swept.
    double explained_share = 0.8;  // share of the points
    // Minimum share of points inside a part, below which those at edges are used too.
    // Chosen: not swept.
    double min_interior = 0.5;  // share of the points
};

// Points of faces that other surfaces meet (face_interior.h), which their final fit leaves out.
struct FaceBorderTuning {
    // Width of the border along a face's outline.
    // Chosen: with 1.5 and 2 the angles of 178 planes of three plants without registration error have an rms of 1.3 and
    // 1.2 standard deviations, with 1 and 0.5 of 1.6 and 2.8, with all their points of 4.2; 1.5 leaves 88 % of the
    // points of a face in the middle; not swept.
    double border = 1.5;  // thresholds
    // Distance from another surface up to which points may be its own.
    // Chosen: from 0.5 to 1.5 positions of those planes have an rms of 1.2 standard deviations, 1.4 without; not swept.
    double reach = 1;  // thresholds of that surface
    // Planes nearer to parallel do not meet: they are the other face of a plate, or another part of it.
    // Chosen: 20 degrees, the largest angle of normals; not swept.
    double max_cosine = 0.94;  // cosine of the angle between normals
    // Error of the angle without those points, for the same noise, from which on they are used, too.
    // Chosen: faces of six thresholds, the narrowest, have half of their width left; of scan lines along a face few may
    // be left; not swept.
    double max_growth = 3;  // errors with them
};

// Parts of one plane or pipe that something before it divides (part_joining.h).
struct JoiningTuning {
    // Widest gap between parts of a plane.
    // Chosen: posts of 0.25 m before beams whose spacing is 16 to 50 mm; not swept.
    double max_gap = 40;  // spacings of the cloud
    // Share of the hull of both parts that their own hulls have; of cylinders, of the length.
    // Chosen: more than half is seen; not swept.
    double min_filled = 0.5;  // share of the area or length
    // Difference of two cylinders' radii.
    // Chosen: of 511 pairs of parts of one pipe in seven scenes 92 % differ by up to 4, of nine pairs of two pipes
    // between which there is a reducer 3; not swept.
    double max_errors = 4;  // standard deviations
    // Rms distance of points from the plane of both parts, from which on they fill the threshold.
    // Chosen: evenly spread points have 0.577, Gaussian ones that the threshold cuts at 1.7 deviations 0.47; not swept.
    double max_rms = 0.48;  // thresholds
    // Points of a part among points within its threshold that belong to no surface.
    // Chosen: parts of a plant have up to 0.06, planes in noise 0.2 and more; not swept.
    double max_mixed = 0.1;  // share of the part
};

// Planes over both faces of a thin plate (plate_faces.h).
struct PlateTuning {
    // Normals of planes that show how far stations are apart along the plate's.
    // Chosen: a shift across those has a tenth of the effect along these, squared less than a fifth; not swept.
    double min_cosine = 0.9;  // cosine of the angle between normals
    // Standard deviation of a station's mean distance in addition to that on other planes: beams that graze a surface
    // or hit its edge.
    // Chosen: webs of a plant have means 0.5 mm from those of their other stations; not swept.
    double least_left = 0.25;  // share of the cloud's noise
    // Distance of two faces, from which on they are two.
    // Chosen: webs of 7 and 10 mm seen from 9 stations that are 1.5 mm apart have 6.5 to 17, and up to 21 where these
    // are not apart; the best division of other planes, with max_noise, up to 4.9; not swept.
    double min_certainty = 5;  // standard deviations
    // Noise of both faces.
    // Chosen: the faces of those webs have 0.32 to 0.8, divisions of other planes 0.9 to 1; not swept.
    double max_noise = 0.8;  // share of the noise about the one plane
    // Noise of a shape's points where their stations most probably were, up to which layers of the others are stations.
    // Chosen: layers 4.5 mm apart with a noise of 1.5 mm have 0.58, planes over pipes 0.98 to 1; not swept.
    double max_moved_noise = 0.85;  // share of their noise where they are
};

// Points within outlines (outline_points.h).
struct OutlineTuning {
    // Number of points of parts that are given them.
    // Chosen: faces of posts of 550 points have parts of 350 to 490; not swept.
    double min_points = 0.5;  // share of the minimum of a primitive
    // Chosen: with min_points, parts with more are found without; not swept.
    double max_points = 2;  // share of the minimum of a primitive
};

// Elbows that are looked for between two pipes (elbow_search.h).
struct ElbowTuning {
    // How far behind the nearer end an arc may begin: pipes whose points reach into the bend.
    // Chosen: elbows of three radii in a plant scanned from ten stations reach 1.7; twice as much; not swept.
    double max_reach = 3.5;  // radii
    // Distance of points from the arc that is tried, at least: the axes' errors move it.
    // Chosen: half of the step between tangents that are tried; not swept.
    double threshold = 0.05;  // radii
    // Points on the middle half of the arc.
    // Chosen: fits of a torus to fewer have errors of the radius' size; not swept.
    double min_points = 30;  // number
    // Radius of a bend behind a pipe, as the first points off the pipe show it.
    // Chosen: of 89 such bends on four plants and an indoor scan, 43 are elbows, of 2.2 to 7; not swept.
    double min_bend = 1.7;  // radii
    // Chosen: with min_bend.
    double max_bend = 8;  // radii
    // Length of a cylinder up to which it may be a piece of an elbow.
    // Chosen: 46 pieces of elbows of three halls have up to 4.3; not swept.
    double max_piece = 6;  // radii
    // Distance of its points from the elbow, from which on it is none.
    // Chosen: those pieces have 0.27 to 0.54, with a point of something else among them 0.8, pipes next to elbows 1
    // and more; not swept.
    double max_piece_rms = 0.75;  // rms distances from the cylinder
};

// Shapes whose points lie on others, too (shared_points.h).
struct SharingTuning {
    // Points of planes on a curved shape, relative to its own.
    // Chosen: a cylinder through the four faces of a post has 2.3, one through a beam's web 0.9; of 90 right ones of
    // two plants, one has 0.64, the others up to 0.25; not swept.
    double max_others = 1;  // share of its points
    // Share of a plane's points on a cylinder, from which on it may be a strip of that.
    // Chosen: not swept.
    double min_strip = 0.8;  // share of the points
    // Share of such a cylinder's points on the plane, up to which it is more than that strip.
    // Chosen: not swept.
    double max_own = 0.5;  // share of the points
};

struct DetectTuning {
    SurveyTuning survey;
    ResolutionTuning resolution;
    ShapeSearchTuning search;
    PipeTuning pipes;
    PieceTuning pieces;
    WideningTuning widening;
    ContestTuning contest;
    MergingTuning merging;
    FaceBorderTuning faces;
    JoiningTuning joining;
    PlateTuning plates;
    OutlineTuning outlines;
    ElbowTuning elbows;
    SharingTuning sharing;
};

// The values above, unless a benchmark has set one (tuned_values.h). Constant while anything works. A loop over points
// reads a value before it begins.
const DetectTuning& detect_tuning();

}  // namespace pcm
