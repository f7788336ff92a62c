// A sixth kind of shape: its row compiles with all columns, and with none of them left out.
#include "pcm/shapes/command_script.h"
#include "pcm/shapes/fitted_shape.h"
#include "pcm/shapes/outline_area.h"
#include "pcm/shapes/shape_drawing.h"
#include "pcm/shapes/shape_lines.h"
#include "pcm/shapes/shape_solids.h"
#include "pcm/shapes/tube.h"
#include "tests/shapes/row_columns.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

// The half space below a plane through `point`, whose upper side is a square of 2 `second`.
constexpr ShapeSize sizes[] = {
    {&Shape::second, &ShapeErrors::second, "half_side", "side", "half of the side", SizeUnit::length}};

const char* fault(const Shape& shape) { return shape.second > 0 ? nullptr : "the side is not above 0"; }
double distance(const Shape& shape, const Vec3d& p) { return p[2] - shape.point[2]; }
Vec3d normal(const Shape&, const Vec3d&) { return {0, 0, 1}; }
double bend(const Shape&, const Vec3d&) { return 1e300; }
Vec3d place(const Shape&, const Vec3d& p) { return p; }
void in_box(const Shape&, const Box3d&, ShapeBounds&) {}
void by_points(const Shape&, const std::vector<Vec3d>&, const OutlineOptions&, ShapeBounds&) {}
void extend(const Shape& shape, const ShapeBounds&, Box3d& box) { box.extend(shape.point); }
OutlineArea area(const ShapeBounds&, std::uint64_t) { return {}; }
std::vector<ShapeLine> lines(const Shape&, const ShapeBounds&, const ShapeLineOptions&) { return {}; }
void mesh(const Shape&, const ShapeBounds&, const MeshOptions&, const FaceVisitor&) {}
void mesh_lines(const Shape&, const ShapeBounds&, const MeshOptions&, ShapeLines&) {}
std::string draw(const Shape&, const ShapeBounds&, const MeshOptions&, ShapeDrawing&) { return "it has none"; }
void script(const Shape&, const ShapeBounds&, CommandScript& commands) { commands.line("_.BOX"); }
void solid(const Shape& shape, const ShapeBounds&, ShapeSolids& solids) { solids.ball(shape.point, shape.second); }

constexpr auto sixth = static_cast<ShapeKind>(5);
constexpr ShapeTraits row{sixth,
                          "block",
                          "Block",
                          "block X Y Z SIDE",
                          2,
                          {"top", "top", " below "},
                          ShapeAxis::none,
                          ShapeExtent::closed,
                          ShapeSizes(sizes),
                          fault,
                          distance,
                          normal,
                          bend,
                          place,
                          in_box,
                          by_points,
                          extend,
                          area,
                          lines,
                          mesh,
                          mesh_lines,
                          draw,
                          script,
                          solid,
                          no_tube};

using Columns =
    std::tuple<ShapeKind, const char*, const char*, const char*, std::size_t, PlaceWords, ShapeAxis, ShapeExtent,
               ShapeSizes, decltype((fault)), decltype((distance)), decltype((normal)), decltype((bend)),
               decltype((place)), decltype((in_box)), decltype((by_points)), decltype((extend)), decltype((area)),
               decltype((lines)), decltype((mesh)), decltype((mesh_lines)), decltype((draw)), decltype((script)),
               decltype((solid)), decltype((no_tube))>;
static_assert(rows::Table<ShapeTraits, Columns>::is_whole, "a column of the row is not in this list");
static_assert(rows::Table<ShapeTraits, Columns>::optional == 0, "a row compiles without one of its columns");

// What the assertions above rest on finds a column that may be left out.
struct Lax {
    int first;
    const char* second;
};
static_assert(rows::Table<Lax, std::tuple<int, const char*>>::is_whole, "");
static_assert(rows::Table<Lax, std::tuple<int, const char*>>::optional == 1, "the last column has a default");

TEST(SixthKind, ARowIsReadAsAnyOther)
{
    const Shape block{sixth, {1, 2, 3}, {0, 0, 1}, 0, 4};
    EXPECT_EQ(row.signed_distance(block, {0, 0, 5}), 2);
    EXPECT_FALSE(row.has_axis() || row.has_arc() || row.is_flat() || row.has_length() || row.has_radius());
    EXPECT_TRUE(row.has_size(&Shape::second));
    EXPECT_EQ(row.fault(block), nullptr);
    std::string text;
    CommandScript commands([&](const std::string& line) { text += line; });
    row.script(block, {}, commands);
    EXPECT_EQ(text, "_.BOX\r\n");
}

}  // namespace
}  // namespace pcm
