// Normals of points by their neighbours.
#pragma once

#include "pcm/fit/near_tree.h"
#include "pcm/fit/working_points.h"

#include <memory>
#include <vector>

namespace pcm {

struct PlaneNear {
    Vec3d normal{};  // 0 0 0 where the points are on one line
    double rms = 0;  // root mean square of their distances from the plane
};
// The plane through the nearest points.
PlaneNear plane_near(const NearTree& tree, const std::vector<double>& x, const std::vector<double>& y,
                     const std::vector<double>& z, const Vec3d& place, std::size_t neighbours,
                     std::vector<NearTree::Near>& near);

// Normals of sampled points: the cloud's, or by neighbours when they are asked for. One thread.
class SampleNormals {
public:
    explicit SampleNormals(const WorkingPoints& points) : points_(points) {}
    Vec3d at(std::size_t i);
    // Root mean square of the neighbours' distances from the plane through them; infinite for too few.
    double unevenness(std::size_t i);

private:
    const NearTree& tree();

    const WorkingPoints& points_;
    std::unique_ptr<NearTree> tree_;
    std::vector<Vec3d> known_;
    std::vector<bool> is_known_;
    std::vector<NearTree::Near> near_;
};

}  // namespace pcm
