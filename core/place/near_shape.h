// Whether points lie near the surface of a shape, and are turned as it is: a test of places for scans.
#pragma once

#include "pcm/place/normal_column.h"
#include "pcm/select/point_scan.h"
#include "pcm/shapes/shape.h"

#include <optional>
#include <vector>

namespace pcm {

// Any number of threads.
class NearShape final : public PlaceTest {
public:
    // Holds for points p with distance_to(shape, p) <= threshold, source units, and, where the schema has normals and
    // the angle (radians) is below pi / 2, with a normal no farther than that from the surface's, of either sign.
    // Points without a normal are not compared. Throws what check() throws, and Error(invalid_argument) for a threshold
    // that is not positive and finite and an angle that is not positive.
    NearShape(const Shape& shape, double threshold, double normal_angle, const Schema& schema);

    // A distance from a surface changes by no more than the way between two places, so that the distance of a box's
    // centre decides for most boxes; the others are halved a few times. Exact for planes.
    BoxRelation relation(const Box3d& box) const override;
    bool holds(const Vec3d& p) const override { return distance_to(shape_, p) <= threshold_; }
    ColumnSet columns() const override;
    void narrow(const Chunk& chunk, const std::vector<Vec3d>& positions,
                std::vector<std::uint32_t>& some) const override;

private:
    BoxRelation relation_by_distance(const Box3d& box, int halvings) const;
    double rounding_at(const Box3d& box) const;

    const Shape shape_;
    const double threshold_;
    const NormalColumn normals_;
    std::optional<double> least_cosine_;  // absent: normals are not compared
};

}  // namespace pcm
