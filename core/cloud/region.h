// A part of space for selecting points: box, oriented box, sphere, convex volume, ray with a radius, cone, prism over a
// polygon, lasso on the screen.
//
// contains() is the definition. It works on d = p - centre, where the centre belongs to the region (apex of a cone,
// origin of a ray, eye of a frustum), so map coordinates cost no precision: the boundary of a region is where the
// formulas below put it, exactly for a box, else to within 16 eps * |d| (eps = 2^-53; |d| is the distance of the point
// from the centre). A lasso's boundary is that far off on the screen, in units of the view's size at that distance.
//
// relation() of a box is conservative: `inside` only when contains() holds for all doubles in the box, `outside` only
// when it holds for none. Boxes, spheres and single half-spaces are classified exactly; for other regions, a box within
// 64 eps * (largest |d| of the box) of the boundary, or just outside of a corner or an edge, may be reported as
// `crosses`.
//
// Immutable; any number of threads. Lengths are in source units, angles in degrees.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/polygon.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

enum class BoxRelation : std::uint8_t { outside, crosses, inside };

// The relation of a box to the intersection of two regions, from its relations to each.
inline BoxRelation both(BoxRelation a, BoxRelation b) { return a < b ? a : b; }

class Region {
public:
    enum class Kind : std::uint8_t { box, oriented_box, sphere, convex, ray, cone, polygon };

    // All makers throw Error(invalid_argument), which names what is wrong, for numbers that are not finite or violate a
    // condition below.

    // Faces included; a box with min > max contains nothing. Corners may be infinite, not NaN.
    static Region box(const Box3d& box);

    // |axis[k] . d| <= half[k]. Axes of any length but 0, perpendicular to each other to 1e-6 (the second and the third
    // are corrected to be exactly perpendicular); halves >= 0.
    static Region oriented_box(const Vec3d& centre, const std::array<Vec3d, 3>& axes, const Vec3d& half);

    // |d| <= radius; radius >= 0.
    static Region sphere(const Vec3d& centre, double radius);

    // The points with normal . (p - centre) + offset >= 0 for all planes. 1 to 64 planes, no normal zero.
    struct Plane {
        Vec3d normal{};
        double offset = 0;
    };
    static Region convex(const Vec3d& centre, const std::vector<Plane>& planes);

    // What a view shows: column-major matrices like OpenGL's; `modelview`, affine and invertible, maps p - origin to
    // eye space, and a point is visible when `projection` maps it to -w <= x, y, z <= w.
    static Region frustum(const std::array<double, 16>& modelview, const std::array<double, 16>& projection,
                          const Vec3d& origin);
    // The same from an eye that looks at a target: the full vertical angle of view, the aspect width / height, the
    // distances of the near and the far plane, 0 < near < far. `up` is not parallel to the direction of view.
    static Region frustum(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double view_angle, double aspect,
                          double near, double far);

    // A cylinder: with u the unit direction and t = u . d: 0 <= t <= length (unbounded when absent) and
    // |d - t u| <= radius. Radius and length >= 0.
    static Region ray(const Vec3d& origin, const Vec3d& direction, double radius, std::optional<double> length = {});

    // With u the unit axis and t = u . d: 0 <= t <= length and |d - t u| cos(half_angle) <= t sin(half_angle);
    // 0 < half_angle < 90.
    static Region cone(const Vec3d& apex, const Vec3d& axis, double half_angle, std::optional<double> length = {});

    // The points for which (u . d, v . d) is in the polygon (cloud/polygon.h: even-odd rule, lower and left borders
    // included): unbounded along the third direction. Axes as of an oriented box; corners in source units, relative to
    // the centre. With the centre 0 and the axes x and y, source coordinates are compared with the corners as they are.
    static Region prism(const Vec3d& centre, const Vec3d& axis_u, const Vec3d& axis_v,
                        const std::vector<Vec2d>& polygon);

    // The points of a view (see frustum(); only its near and its far plane bound it) that are mapped into a
    // polygon in normalised device coordinates: x / w to the right, y / w upwards, -1 to 1 on the screen. Corners may
    // lie outside of the screen.
    static Region lasso(const std::array<double, 16>& modelview, const std::array<double, 16>& projection,
                        const Vec3d& origin, const std::vector<Vec2d>& polygon);

    // What lasso() was given; null for other regions.
    struct View {
        std::array<double, 16> modelview{}, projection{};
        Vec3d origin{};
        std::vector<Vec2d> polygon;
    };
    const View* view() const { return view_.get(); }

    // False for a point that is not finite.
    bool contains(const Vec3d& p) const;
    // `outside` for an empty box; `crosses` for a box that is not finite, unless it is certainly outside.
    BoxRelation relation(const Box3d& box) const;

    // No point outside of this box is contained; ends may be infinite.
    const Box3d& bounds() const { return bounds_; }
    Kind kind() const { return kind_; }
    const Vec3d& centre() const { return centre_; }
    // The half-spaces, relative to centre(), whose intersection the region is; none where it is everything. Absent for
    // a region that is not such an intersection.
    std::optional<std::vector<Plane>> half_spaces() const;
    // In the form that parse_region() reads, with all digits.
    std::string text() const { return text_; }

    // For a ray or a cone: t as defined above, and a lower bound of t in a box that holds for along() of every point of
    // the box, rounding included.
    double along(const Vec3d& p) const;
    double least_along(const Box3d& box) const;

private:
    Region() = default;
    bool radial_contains(const Vec3d& d) const;
    BoxRelation radial_relation(const Box3d& d) const;
    static BoxRelation half_space(const Plane& plane, const Box3d& d);
    BoxRelation polygon_relation(const Box3d& d) const;
    void add_plane(const std::string& name, const Plane& plane);
    void bound_by_planes();
    void bound_prism();
    void bound_radial();
    void set_bounds(const Vec3d& low, const Vec3d& high);

    Kind kind_ = Kind::box;
    Vec3d centre_{};
    Box3d box_, bounds_;
    std::vector<Plane> planes_;
    // Prism, lasso: x, y and w, of which (x / w, y / w) is in the polygon where w > 0.
    std::shared_ptr<const Polygon> polygon_;
    std::array<Plane, 3> rows_;
    std::shared_ptr<const View> view_;
    // Sphere, ray. Lengths are squared after multiplication by inverse_unit_, a power of two near 1 / radius.
    double radius_ = 0, inverse_unit_ = 1, scaled_square_ = 0;
    Vec3d axis_{};
    std::array<Vec3d, 2> across_{};  // perpendicular to the axis and to each other
    double cosine_ = 1, sine_ = 0, length_ = 0;
    std::string text_;
};

// Regions as text, as on the command line; numbers are separated by blanks or commas:
//
//     box X0 Y0 Z0 X1 Y1 Z1
//     oriented-box CX CY CZ HX HY HZ TURN                 half sizes, turned by TURN degrees counter-clockwise about z
//     oriented-box CX CY CZ HX HY HZ UX UY UZ VX VY VZ    first and second axis; the third is perpendicular to both
//     sphere CX CY CZ RADIUS
//     ray OX OY OZ DX DY DZ RADIUS [LENGTH]
//     cone AX AY AZ DX DY DZ HALF_ANGLE [LENGTH]
//     frustum EX EY EZ TX TY TZ ANGLE ASPECT NEAR FAR [UX UY UZ]
//     planes CX CY CZ NX NY NZ OFFSET ...                 four numbers per plane
//     polygon X0 Y0 X1 Y1 X2 Y2 ...                       a prism in plan, unbounded along z
//     prism CX CY CZ UX UY UZ VX VY VZ X0 Y0 X1 Y1 ...    corners along the axes u and v, relative to the centre
//     lasso M0 ... M15 P0 ... P15 OX OY OZ X0 Y0 ...      modelview, projection, origin, corners on the screen
//
// Throws Error(invalid_argument) with what was expected.
Region parse_region(const std::string& text);

}  // namespace pcm
