// How points leave their shape together: an oval pipe, a bulged wall, a dent. What is left of their distances from a
// smooth surface near the shape is noise.
#pragma once

#include "pcm/shapes/shape.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

struct Departure {
    std::size_t points = 0;  // number of points used
    // Share of the squared distances that a smooth surface explains beyond what chance does: 0 for noise.
    double share = 0;
    double size = 0;  // rms distance of that surface from the shape, source units
    double rest = 0;  // one standard deviation of the points from that surface, source units
    // ErrorAgreement::factor() of the rest: above 1 where neighbours share errors that no smooth surface explains, as
    // those of scanners.
    double agreement = 1;
    bool is_chance = true;  // whether noise alone explains the share (the F test of even_noise.h)

    // Whether that is out of round, bulged or dented, for points whose own noise is `noise`, one standard deviation,
    // source units: a large share, which leaves that noise, independent from point to point. Errors of scanners that
    // neighbours share leave more of both.
    bool is_smooth(double noise) const;
    // Whether it is far larger than that noise and nearly all of what the points leave the shape by, whatever is left:
    // a tank that is out of round by many times what stations and edges add to the noise.
    bool is_dominant(double noise) const;
    // What that is, a sentence for people; `shape`: how the shape is called there, such as "cylinder".
    std::string message(const std::string& shape) const;
};

// Fits the distances by least squares with a polynomial of third degree in the place along the shape and in its normal
// there, which describes ovals and bends of pipes as well as bulges of walls and spheres. `points`: source coordinates;
// those farther than the threshold (above 0, source units) are ignored. From 2000 points on every second, third, ...
// one is used; fewer than 60 within the threshold give an empty Departure. One thread; milliseconds.
Departure departure_of(const Shape& shape, double threshold, const std::vector<Vec3d>& points);

// Stations of a scanner, each of which may be shifted as a whole.
struct ShiftedStations {
    std::vector<std::uint32_t> numbers;  // one per point
    double spread = 0;                   // standard deviation of a shift along each axis, above 0, source units
    double noise = 0;                    // standard deviation of the points, above 0, source units
};

// The same beyond what shifts of stations and other sizes of the shape explain, by least squares of all together: a
// registration that leaves stations apart makes a round pipe out of round, and an oval one is out of round for each of
// them. From two stations to StationEvidence::most_stations; for other numbers of stations the Departure is empty.
Departure departure_of(const Shape& shape, double threshold, const std::vector<Vec3d>& points,
                       const ShiftedStations& stations);

}  // namespace pcm
