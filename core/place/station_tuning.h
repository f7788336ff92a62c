// The numbers, as in tuning.h, of the stations of a scanner: which attribute names them, how far they are apart.
#pragma once

#include <cstddef>

namespace pcm {

// Which points are of which station of a scanner, where no attribute says it (point_stations.h).
struct StationTuning {
    // Parts of a tree whose coarsest points are looked at.
    // Chosen: not swept.
    std::size_t max_parts = 64;  // parts
    // Minimum gap between the times of two stations: moving a tripod takes longer.
    // Chosen: not swept.
    double min_gap = 30;  // seconds
    // Minimum gap where the times of points are far apart.
    // Chosen: with min_gap; not swept.
    double mean_gaps = 50;  // mean gaps between points
    // Mean number of the coarsest points of a station: numbers of fewer points name something else.
    // Chosen: not swept.
    std::size_t min_points = 8;  // points
};

// Patches of surface by which stations are compared (station_survey.h).
struct PatchTuning {
    // With these no larger box around the place is looked at.
    // Chosen: not swept.
    std::size_t enough = 150;  // patches
    // Chosen: with enough; not swept.
    std::size_t enough_stations = 4;  // stations
    // Maximum number of points of a box: of more, every second or third is taken.
    // Chosen: not swept.
    std::size_t box_points = 60000;  // points
    // Points of a cube that holds a surface, approximately.
    // Chosen: not swept.
    std::size_t cube_points = 100;  // points
    // Points of a patch.
    // Chosen: not swept.
    std::size_t min_points = 24;  // points
    // Chosen: with cube_points; not swept.
    std::size_t max_points = 400;  // points
    // Minimum number of points of a station in a patch.
    // Chosen: not swept.
    std::size_t min_station_points = 5;  // points
    // Maximum variance across a patch.
    // Chosen: not swept.
    double max_thickness = 0.05;  // middle variances
    // Minimum variance across its longest direction.
    // Chosen: not swept.
    double min_width = 0.1;  // largest variances
    // What differences show, relative to stations that see all of a patch.
    // Chosen: not swept.
    double min_overlap = 0.6;  // share
    // Maximum noise of a patch, relative to the quarter with the least noise.
    // Chosen: not swept.
    double max_noise = 2;  // noises of that quarter
    // Maximum deviation of a patch from what is known of the shifts before, which is nothing at most places.
    // Chosen: as max_deviation; patches of walls deviate by the whole shift of a station, those of floors by little.
    double max_first_deviation = 3;  // medians of the deviations
    // Maximum deviation of a patch from the shifts that the others give.
    // Chosen: at 49 places of three ray-cast plants, one without registration error: with 4, and without a first step,
    // eight of 20 spreads there were 2.4 to 7.3 mm, as plates are thick.
    double max_deviation = 2.5;  // medians of the deviations
    // Maximum median of the deviations of patches with similar normals.
    // Chosen: levels keep heights better than places; not swept.
    double max_unlike = 2.5;  // medians of all deviations
    // Minimum share of the neighbours by chance that patches have which stations see all of: tiles and objects meet at
    // their borders alone.
    // Chosen: five ray-cast plants have 0.69 to 1, objects of generated sites of 40,000 to 1,000,000 points 0.02 to
    // 0.37.
    double min_seen = 0.5;  // share
    // Minimum number of nearest neighbours of another station in those patches. Ones whose borders stations see have
    // fewer.
    // Chosen: with min_seen; those plants have 0.86 to 2, squares whose points are mixed a little 0.7.
    double min_mixed = 0.78;  // shares of their number by chance
    // Below this number by chance, stations are taken to mix.
    // Chosen: with min_mixed; 500 took the objects of sparse sites for stations, half a metre apart.
    double enough_by_chance = 50;  // neighbours
    // Number of differences between stations below which those of other places count, too.
    // Chosen: of 22 good answers with fewer on two plants 9 were beyond three deviations, of 310 others 10.
    std::size_t enough_freedom = 9;  // differences
    // Chosen: not swept.
    std::size_t places_elsewhere = 6;  // places
};

// Points of curved shapes that are turned away from their stations (turned_points.h).
struct FacingTuning {
    // Cosine between the surface's normal and the direction to the station, below which points are not used.
    // Chosen: thin pipes of two plants, one without registration error: the rms error of positions is 0.38 mm with all
    // points, 0.37, 0.31 and 0.30 with 0, 0.2 and 0.3; not swept.
    double min_cosine = 0.2;  // cosine
};

}  // namespace pcm
