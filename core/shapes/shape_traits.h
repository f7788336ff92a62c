// All that the library knows of a kind of shape, estimation aside: one row per kind, each in a source of its own in
// shapes/kinds/. Files, drawings, lists and messages ask the row and compare no kinds.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/vector.h"
#include "pcm/shapes/shape_kinds.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

class CommandScript;
class ShapeDrawing;
class ShapeSolids;
struct MeshOptions;
struct OutlineArea;
struct OutlineOptions;
struct Shape;
struct ShapeBounds;
struct ShapeErrors;
struct ShapeLine;
struct ShapeLineOptions;
struct ShapeLines;
struct Tube;

// What Shape::axis is.
enum class ShapeAxis : std::uint8_t {
    none,
    normal,      // the shape is flat
    revolution,  // the surface turns about it, and may cover an arc only
};

// What bounds the part of a shape that there is.
enum class ShapeExtent : std::uint8_t {
    outline,           // a polygon
    length,            // two places along the axis
    length_from_apex,  // two places along the axis, none before Shape::point
    closed,            // nothing: the surface ends nowhere
};

enum class SizeUnit : std::uint8_t { length, angle };

// A number of a shape in addition to its place and its axis.
struct ShapeSize {
    double Shape::*value;
    double ShapeErrors::*error;
    const char* key;    // in files: "tube_radius"
    const char* name;   // in the output of commands: "tube"
    const char* label;  // in panels: "tube's radius"
    SizeUnit unit;
};

// Sizes of one kind: lengths before angles, the greatest length first.
class ShapeSizes {
public:
    constexpr ShapeSizes() = default;
    template <std::size_t N>
    constexpr explicit ShapeSizes(const ShapeSize (&sizes)[N]) : first_(sizes), count_(N)
    {
    }
    constexpr const ShapeSize* begin() const { return first_; }
    constexpr const ShapeSize* end() const { return first_ + count_; }
    constexpr std::size_t size() const { return count_; }

private:
    const ShapeSize* first_ = nullptr;
    std::size_t count_ = 0;
};

// How people call Shape::point.
struct PlaceWords {
    const char* name;   // in the output of commands: "point"
    const char* label;  // in panels: "point of the axis"
    const char* in;     // between the shape's name and the numbers: " through "
};

using FaceVisitor = std::function<void(const std::array<Vec3d, 4>&)>;  // called with the corners of a MeshFace

// A row. No column has a default, and the last ones are references: a row that lacks a column does not compile.
struct ShapeTraits {
    ShapeKind kind;
    const char* name;        // in commands and files: "plane"
    const char* label;       // for people: "Plane"
    const char* form;        // what text_of() writes: "plane X Y Z NX NY NZ"
    std::size_t parameters;  // degrees of freedom
    PlaceWords place;
    ShapeAxis axis;
    ShapeExtent extent;
    ShapeSizes sizes;

    // What is wrong with the sizes of a shape whose radius is a number above 0, a sentence; null: nothing.
    const char* (&fault)(const Shape& shape);
    double (&signed_distance)(const Shape& shape, const Vec3d& p);  // shapes/shape.h
    Vec3d (&normal_at)(const Shape& shape, const Vec3d& p);
    double (&bend_radius)(const Shape& shape, const Vec3d& p);  // narrowest bend near p; infinite: flat
    // Shape::point moved within the shape to where it is nearest to p; itself where it has one place only.
    Vec3d (&place_near)(const Shape& shape, const Vec3d& p);
    // shapes/bounds.h. Arcs are bounded by the points of every kind with an axis of revolution.
    void (&bound_in_box)(const Shape& shape, const Box3d& box, ShapeBounds& bounds);
    void (&bound_points)(const Shape& shape, const std::vector<Vec3d>& points, const OutlineOptions& options,
                         ShapeBounds& bounds);
    void (&extend)(const Shape& shape, const ShapeBounds& bounds, Box3d& box);  // adds a box around the part
    OutlineArea (&area)(const ShapeBounds& bounds, std::uint64_t points);       // shapes/outline_area.h
    std::vector<ShapeLine> (&lines)(const Shape& shape, const ShapeBounds& bounds, const ShapeLineOptions& options);
    void (&mesh)(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, const FaceVisitor& visit);
    void (&mesh_lines)(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, ShapeLines& lines);
    // All of a DXF file's entities. Returns why there are no faces, the end of a sentence about the shape; empty: there
    // are.
    std::string (&draw)(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options,
                        ShapeDrawing& drawing);
    void (&script)(const Shape& shape, const ShapeBounds& bounds, CommandScript& script);  // the solid, by commands
    void (&solid)(const Shape& shape, const ShapeBounds& bounds, ShapeSolids& solids);     // the solid itself
    // As a part of a pipe, shapes/tube.h; nothing where it is none, or where its ends are not known.
    std::optional<Tube> (&tube)(const Shape& shape, const ShapeBounds& bounds, const ShapeErrors& errors);

    constexpr bool is_flat() const { return axis == ShapeAxis::normal; }
    constexpr bool has_axis() const { return axis != ShapeAxis::none; }
    constexpr bool has_arc() const { return axis == ShapeAxis::revolution; }
    constexpr bool has_length() const
    {
        return extent == ShapeExtent::length || extent == ShapeExtent::length_from_apex;
    }
    constexpr const char* axis_name() const { return is_flat() ? "normal" : "axis"; }
    bool has_size(double Shape::*value) const;
    bool has_radius() const;  // Shape::radius is one of the sizes
};

#define PCM_SHAPE_ROW(name) extern const ShapeTraits name##_shape;
PCM_SHAPE_KINDS(PCM_SHAPE_ROW)
#undef PCM_SHAPE_ROW

extern const ShapeTraits* const shape_rows[];  // in the order of the enumerators
inline const ShapeTraits& traits_of(ShapeKind kind) { return *shape_rows[static_cast<std::size_t>(kind)]; }
// In the order of the enumerators.
const std::vector<std::reference_wrapper<const ShapeTraits>>& shape_kinds();

}  // namespace pcm
