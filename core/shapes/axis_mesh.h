// Faces and lines of surfaces that turn about an axis, for drawings.
#pragma once

#include "pcm/shapes/axis_bounds.h"
#include "pcm/shapes/shape_mesh.h"

#include <cstddef>
#include <vector>

namespace pcm::shapes {

// Segments of an arc of this radius that are nowhere farther than `chord` from it.
std::size_t segments(double radius, double chord, double arc);
// Throws Error(invalid_argument) for more than 1,000,000 faces.
void check_faces(std::size_t across, std::size_t along, double chord);

// Directions across the axis at equal angles of an arc.
class Fan {
public:
    Fan(const Shape& shape, const ShapeBounds& bounds, bool whole, double radius, double chord);
    std::size_t count() const { return count_; }
    bool whole() const { return whole_; }
    Vec3d at(std::size_t i) const;

private:
    Vec3d v_, u_;
    double begin_, arc_;
    bool whole_;
    std::size_t count_;
};

// A flat polygon as triangles from its first corner.
void cap(const std::vector<Vec3d>& corners, bool reversed, const FaceVisitor& visit);

// At the beginning, the quarters and the end of an arc of this number of segments.
std::vector<std::size_t> quarters(std::size_t segments, bool whole);
// A circle of this number of corners through two directions.
ShapeLines::Line ring(const Vec3d& centre, const Vec3d& u, const Vec3d& v, double radius, std::size_t count);

// Nothing where the length is not known.
void mesh_along_axis(const Shape& shape, const ShapeBounds& bounds, RadiusAt radius, const MeshOptions& options,
                     const FaceVisitor& visit);
// Rims, and straight lines between them.
void mesh_lines_along_axis(const Shape& shape, const ShapeBounds& bounds, RadiusAt radius, const MeshOptions& options,
                           ShapeLines& found);

}  // namespace pcm::shapes
