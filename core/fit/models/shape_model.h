// What fitting knows of a kind of shape: samples, distances, derivatives. One file per kind, one row in
// shape_models.cpp. All in working coordinates: relative to the points' middle, their extent about 1.
#pragma once

#include "pcm/fit/shape_fit.h"
#include "pcm/fit/surface_patch.h"

#include <array>
#include <cstddef>

namespace pcm {

inline constexpr std::size_t most_sampled = 4;  // points of a minimal sample
inline constexpr std::size_t most_solutions = 4;

struct SampledPoint {
    Vec3d place{}, normal{};
};

struct ShapeModel {
    ShapeKind kind;
    std::size_t parameters;
    std::size_t sampled;  // points of a minimal sample
    bool needs_normals;   // whether sampled points need normals
    // The unit of each parameter is length to this power (angles: 0).
    std::array<int, most_parameters> dimension;

    // Shapes through a sample; returns how many, at most most_solutions.
    std::size_t (*solve)(const SampledPoint* sample, Shape* solutions);
    // Signed distances as pcm::signed_distance(), by plain formulas.
    void (*distances)(const Shape& shape, const double* x, const double* y, const double* z, std::size_t count,
                      double* out);
    SurfacePatch (*patch_at)(const Shape& shape, const Vec3d& middle);
    Shape (*shape_of)(const SurfacePatch& patch);  // numbers may be out of range: is_proper()
    // At most patch_block points.
    void (*differentiate)(const SurfacePatch& patch, const double* x, const double* y, const double* z,
                          std::size_t count, PatchBlock& out);
    SurfacePatch (*moved)(const SurfacePatch& patch, const double* step);
};

const ShapeModel& model_of(ShapeKind kind);

// What check() accepts.
bool is_proper(const Shape& shape);

// For the models.
namespace models {

// As the loops take them.
ShapeNumbers numbers_of(const Shape& shape);
PatchNumbers numbers_of(const SurfacePatch& patch);
Vec3d unit_across(const Vec3d& axis);
// Turned about an axis of any length by that many radians; the frame stays orthonormal.
void turn(SurfacePatch& patch, const Vec3d& rotation);
// Frame of a normal, or of an axis and a direction across it.
SurfacePatch patch_with_normal(const Vec3d& place, const Vec3d& normal);
SurfacePatch patch_with_axis(const Vec3d& place, const Vec3d& axis, const Vec3d& across);
// Where the lines through two points along their normals are nearest to each other; false for parallel ones.
bool lines_meet(const Vec3d& p, const Vec3d& np, const Vec3d& q, const Vec3d& nq, Vec3d& on_p, Vec3d& on_q);

}  // namespace models
}  // namespace pcm
