#include "pcm/view/point_sizes.h"

#include "pcm/tree/point_size.h"
#include "pcm/view/vertex_discs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace pcm {
namespace {

constexpr double most_of_cloud = 0.05;

// The distance of neighbours in a leaf: the spacing of its finest level, which is half of the one before where it has
// all the rest.
double spacing_of_leaf(const Node& leaf, const std::vector<double>& spacings)
{
    const std::size_t end = std::min(spacings.size(), leaf.first_level + leaf.level_points.size());
    if (end == 0) return 0;
    if (spacings[end - 1] > 0 || end == 1) return spacings[end - 1];
    return spacings[end - 2] / 2;
}

}  // namespace

PointSizes::PointSizes(const Tree& tree)
    : schema_(tree.info().schema), nodes_(tree.nodes()), spacings_(tree.info().spacings)
{
    const Box3d box = tree.info().bounds();
    most_ = std::min<double>(
        std::numeric_limits<float>::max(),
        most_of_cloud * std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]}));
    const double least = least_point_size(tree.info().grid);
    for (std::size_t code = 1; code < radius_.size(); ++code)
        radius_[code] = static_cast<float>(std::min(most_, point_size(static_cast<std::uint8_t>(code), least)));
}

float PointSizes::unknown_radius(NodeId node) const
{
    double coarsest = 0;
    std::vector<NodeId> open{node};
    while (!open.empty()) {
        const Node& next = nodes_[open.back()];
        open.pop_back();
        if (next.is_leaf()) coarsest = std::max(coarsest, spacing_of_leaf(next, spacings_));
        for (const NodeId child : next.children)
            if (child != no_node) open.push_back(child);
    }
    return static_cast<float>(std::min(most_, coarsest));
}

void PointSizes::find_radii(NodeId node, const Chunk& chunk, std::vector<float>& radii,
                            const std::vector<PointShape>* shapes) const
{
    if (const auto place = schema_.find(attribute_name::radius); place && schema_[*place].components > 0)
        make_radii(*chunk.attributes[*place], schema_[*place], radii);
    else
        radii.assign(chunk.points, 0);
    fill_in(node, *chunk.sizes, radii, shapes);
}

void PointSizes::fill_in(NodeId node, const Column& codes, std::vector<float>& radii,
                         const std::vector<PointShape>* shapes) const
{
    const auto* code = codes.as<std::uint8_t>();
    std::optional<float> unknown;  // all nodes below are looked at: only where a size is missing
    for (std::size_t i = 0; i < radii.size(); ++i)
        if (radii[i] == 0) {
            if (code[i] == unknown_size && !unknown) unknown = unknown_radius(node);
            radii[i] = code[i] == unknown_size ? *unknown : radius_[code[i]];
            if (shapes) radii[i] *= static_cast<float>(size_factor((*shapes)[i]));
        }
}

}  // namespace pcm
