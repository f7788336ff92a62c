// What fitting knows of a kind of shape: samples, distances, derivatives. One file per kind, with its row. All in
// working coordinates: relative to the points' middle, their extent about 1.
#pragma once

#include "pcm/cloud/numbers.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/fit/surface_patch.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace pcm {

inline constexpr std::size_t most_sampled = 4;  // points of a minimal sample
inline constexpr std::size_t most_solutions = 4;

struct SampledPoint {
    Vec3d place{}, normal{};
};

// How a surface bends at a place, as few points around it show.
struct SurfaceBend {
    Vec3d place{}, up{};    // on the surface, and its unit normal there
    Vec3d straight{};       // unit, across the normal: the direction of the lesser curvature
    double k1 = 0, k2 = 0;  // principal curvatures of the height over a plane through the place, |k1| >= |k2|
    double steepness = 1;   // 1 + the square of the slope of the surface to that plane
    double doubt = 0;       // curvature that its error alone may give to a flat surface

    bool is_curved() const { return std::fabs(k1) > 0.5 * doubt && std::isfinite(1 / k1); }
    double radius(double curvature) const { return std::sqrt(steepness) / std::fabs(curvature); }
};

// Sizes in units of their errors.
struct Significance {
    double flat = infinity;   // how far the points are from lying in a plane
    double other = infinity;  // how certain the other sizes are
};

// The model of the Point Cloud Library: fit/pcl_fit.h.
enum class PclModel : std::uint8_t;
struct PclForm {
    PclModel model;
    Shape (&shape_of)(const double* coefficients, const Vec3d& middle);  // coefficients are relative to `middle`
};

// A row. No column has a default, and the last ones are references: a row that lacks a column does not compile.
struct ShapeModel {
    const ShapeTraits& traits;
    std::size_t sampled;  // points of a minimal sample
    bool needs_normals;   // whether sampled points need normals
    int rank;             // the lowest rank is the best among kinds that fit equally well
    // Least squares also starts from a plane through the points, with the axis turned to this number of directions in
    // it: for surfaces of which a thin arc is almost a plane. 0: never.
    unsigned flat_starts;
    // The unit of each parameter is length to this power (angles: 0).
    std::array<int, most_parameters> dimension;
    const PclForm* pcl;  // null: PCL has no such model
    // A shape that bends as the surface does; false where none does. Null: detection does not look for the kind.
    bool (*like)(const SurfaceBend& bend, Shape& shape);

    Significance (&significance)(const Shape& shape, const ShapeErrors& errors);
    // Shapes through a sample; returns how many, at most most_solutions.
    std::size_t (&solve)(const SampledPoint* sample, Shape* solutions);
    // Signed distances as pcm::signed_distance(), by plain formulas.
    void (&distances)(const Shape& shape, const double* x, const double* y, const double* z, std::size_t count,
                      double* out);
    SurfacePatch (&patch_at)(const Shape& shape, const Vec3d& middle);
    Shape (&shape_of)(const SurfacePatch& patch);  // numbers may be out of range: is_proper()
    // At most patch_block points.
    void (&differentiate)(const SurfacePatch& patch, const double* x, const double* y, const double* z,
                          std::size_t count, PatchBlock& out);
    SurfacePatch (&moved)(const SurfacePatch& patch, const double* step);

    ShapeKind kind() const { return traits.kind; }
    std::size_t parameters() const { return traits.parameters; }
};

const ShapeModel& model_of(ShapeKind kind);

// For the models.
namespace models {

// Significance of a size that bends the surface in one direction, or equally in all.
Significance radius_significance(const Shape& shape, const ShapeErrors& errors);

// As the loops take them.
ShapeNumbers numbers_of(const Shape& shape);
PatchNumbers numbers_of(const SurfacePatch& patch);
Vec3d unit_across(const Vec3d& axis);
// Turned about an axis of any length by that many radians; the frame stays orthonormal.
void turn(SurfacePatch& patch, const Vec3d& rotation);
// Frame of a normal, or of an axis and a direction across it.
SurfacePatch patch_with_normal(const Vec3d& place, const Vec3d& normal);
SurfacePatch patch_with_axis(const Vec3d& place, const Vec3d& axis, const Vec3d& across);
// Where the line through p along its normal is nearest to the one through q; false for parallel ones.
bool lines_meet(const Vec3d& p, const Vec3d& np, const Vec3d& q, const Vec3d& nq, Vec3d& on_p);

}  // namespace models
}  // namespace pcm
