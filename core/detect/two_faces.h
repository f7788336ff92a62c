// The two faces of a thin plate among the points of one plane, by the stations of a scanner that see them.
#pragma once

#include "pcm/fit/ray_errors.h"
#include "pcm/shapes/shape.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace pcm {

struct TwoFaces {
    std::array<Shape, 2> planes;                   // parallel
    std::map<std::uint32_t, std::size_t> face_of;  // face that each station sees
    double apart = 0;                              // distance of the faces, source units
    double certainty = 0;                          // distance in its standard deviations
    double noise = 0;                              // standard deviation of the points from their faces, source units
    double noise_as_one = 0;                       // the same from the one plane
};

// A station sees one face of an opaque plate. So the stations' mean distances from the one plane are in two groups that
// differ by the plate's thickness, and within a group by what the registration has left.
// `plane`: near the points; `left`: standard deviation of a station's mean distance from a surface, source units, above
// 0. Nothing where there are fewer than two stations, or the points determine no planes. Two means (Lloyd 1982) from
// each division of the stations in the order of their means. One thread; O(points + stations^3).
std::optional<TwoFaces> two_faces(const Shape& plane, const std::vector<PointOfStation>& points, double left);

}  // namespace pcm
