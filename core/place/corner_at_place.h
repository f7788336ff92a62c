// The corner at a place: the edge of the plane of most of its points, and the face that begins there.
//
// A point at an edge may belong to either face. The surface of a corner is where the greatest of the signed distances
// from its planes is 0, each positive outside; so a point belongs to the plane of the greatest one, and the points of a
// face lie in a wedge whose sides run through the edges at half their angles. The edge of a plate may be narrower than
// the thresholds of its faces, so its plane is not found by its number of points: it passes through the border of the
// points of the widest face, across that face at first.
#pragma once

#include "pcm/cloud/region.h"
#include "pcm/place/local_fit.h"
#include "pcm/shapes/shape.h"

#include <optional>
#include <utility>
#include <vector>

namespace pcm {

struct Corner {
    Shape widest;               // plane of most points; the axis points outwards
    std::optional<Shape> edge;  // plane of the face that begins at its border; nothing: too few points show it
    std::optional<Shape> back;  // plane behind the widest one and parallel to it: the other face of a plate
    // The faces by how near the place is to each: the greatest signed distance less the next one, in standard
    // deviations of the noise. Where no points show the face beyond the border, or it is not near: how far the place
    // lies within the border.
    double margin = 0;
    double away = 0;   // distance of the place from that face, standard deviations
    double held = 0;   // share of the points that lie on the faces
    double noise = 0;  // standard deviation of the points from their own faces, source units
    enum class Face { widest, edge, back } face = Face::widest;  // the one at the place, as far as the margin shows it

    // A face that ends at the place, and another one that it meets elsewhere.
    std::vector<std::pair<Shape, Shape>> outer;

    const Shape& plane_at_place() const;
    // The points that belong to the face at the place; nothing: all that lie on it.
    std::optional<Region> side(const Vec3d& place) const;
};

// `noise`: one standard deviation of the points from their own surface, source units, above 0. Nothing where the points
// show no plane, and where the place is neither on it nor near its border. One thread; a millisecond for 500 points.
std::optional<Corner> corner_at(const Vec3d& place, const FitPoints& points, double noise, const ShapeFitOptions& fit);

// The same for the noise of the nearest points, which may be that of several faces: half of it is tried, too.
std::optional<Corner> corner_near(const Vec3d& place, const NearPoints& close, const ShapeFitOptions& fit);

struct CornerFace {
    Corner corner;
    std::optional<LocalFit> local;  // the plane of the face at the place; nothing where that is not clear
    // Whether that is so narrow that points of other faces within the noise are a large part of its own.
    bool is_narrow = false;
};

// The corner of the nearest points. Nothing where near_faces() has none, and where there is no corner. Throws what
// points_near() and fit_shape() throw.
std::optional<CornerFace> fit_corner(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options);

}  // namespace pcm
