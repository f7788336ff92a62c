// Values of a point from its neighbours: radius, normal, curvature, mean distance.
#pragma once

#include "pcm/cloud/vector.h"

#include <cstddef>
#include <cstdint>

namespace pcm {

// How far a normal can be trusted, by the variances l0 <= l1 <= l2 of the point and its neighbours along their
// principal axes. The values are stored.
enum class NormalConfidence : std::uint8_t {
    good = 0,
    line = 1,     // l1 < l2 / 100: they lie along a line; the normal is across it, but may turn about it
    blob = 2,     // no line, and l0 > 0.4 l1: they are about as thick as wide, so that no plane fits
    too_few = 3,  // fewer than two neighbours, or all at one place: the normal is (0, 0, 0)
    // Good, but the neighbours lie on two surfaces nearer to each other than their points, or nearly so: the line of
    // the normal is right, the side that it points to is a guess. Only of normals that are to be the same along
    // surfaces.
    two_surfaces = 4,
};

// Which of them are wanted.
struct WantedValues {
    bool radius = false;
    bool normal = false;
    bool curvature = false;
    bool confidence = false;
    bool mean_distance = false;
    std::size_t radius_neighbours = 0;  // how many of the nearest a radius covers; 0: all
    bool any() const { return radius || normal || curvature || confidence || mean_distance; }
    bool needs_shape() const { return normal || curvature || confidence; }
};

struct PointValues {
    // Source units. With a normal n: the largest |d - n (n . d)| of the offsets d of the neighbours that it covers;
    // without: the largest |d|. Discs of these radii close a surface from about 6 neighbours on. 0 without neighbours.
    double radius = 0;
    Vec3d normal{};        // unit, of either sign; (0, 0, 0) where it is undefined
    double curvature = 0;  // l0 / (l0 + l1 + l2), 0 for a plane to 1/3; 0 where the normal is undefined
    NormalConfidence confidence = NormalConfidence::too_few;
    double mean_distance = 0;  // mean distance of the neighbours, source units; 0 without neighbours
};

// One point's neighbours: offsets from the point, nearest first, and squared distances; source units.
struct OnePointsNeighbours {
    const double* dx = nullptr;
    const double* dy = nullptr;
    const double* dz = nullptr;
    const double* squared = nullptr;
    std::size_t count = 0;
};

// All values are finite for finite offsets with magnitudes of 0 or 1e-70 to 1e70. The normal is the axis of the
// smallest variance about the centroid of the point and its neighbours (PCA), in double. `known_normal` (unit; may be
// null, or point to (0, 0, 0)) is the one that a radius is measured across when no normal is wanted.
PointValues values_of(const OnePointsNeighbours& neighbours, const WantedValues& wanted, const Vec3d* known_normal);

// The same of the mean distance alone: summed nearest first, divided by the count.
double mean_distance_of(const double* squared, std::size_t count);

}  // namespace pcm
