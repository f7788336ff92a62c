// The sizes of points as radii of splats. No OpenGL here.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/tree/tree.h"
#include "pcm/view/point_shapes.h"

#include <array>
#include <vector>

namespace pcm {

class PointSizes {
public:
    explicit PointSizes(const Tree& tree);

    // The radius of each of the node's points: its own or, where it has none, its size. `chunk` has the sizes and, if
    // the cloud has one, the attribute of radii.
    // Sizes are multiplied by the factors of `shapes`, one per point; may be null.
    void find_radii(NodeId node, const Chunk& chunk, std::vector<float>& radii,
                    const std::vector<PointShape>* shapes = nullptr) const;
    // Replaces each radius of 0 by the size of that point of the node, source units. Points whose size is not known get
    // the largest spacing of the leaves below the node. No size is larger than a twentieth of the cloud, so that a
    // handful of points stay points.
    void fill_in(NodeId node, const Column& codes, std::vector<float>& radii,
                 const std::vector<PointShape>* shapes = nullptr) const;

private:
    float unknown_radius(NodeId node) const;

    const Schema schema_;
    const NodeTable nodes_;
    const std::vector<double> spacings_;
    double most_ = 0;                  // source units
    std::array<float, 256> radius_{};  // radius for each code
};

}  // namespace pcm
