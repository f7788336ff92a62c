#include "plugin/meshlab/placement.h"

#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/sample_change.h"

namespace pcm::host {

std::optional<Affine> placement_of(const MeshModel& layer, const TreeLayer& tree)
{
    // position -> linear * position + shift, in MeshLab's coordinates
    std::array<Vec3d, 3> linear;
    Vec3d shift;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) linear[std::size_t(r)][std::size_t(c)] = double(layer.cm.Tr[r][c]);
        shift[std::size_t(r)] = double(layer.cm.Tr[r][3]);
    }
    bool moved = layer.cm.Tr != Matrix44m::Identity();
    if (tree.sample && !(state_of(layer, Watched::sample) == tree.state)) {
        const SampleChange change = find_change(layer, *tree.sample);
        if (change.kind == SampleChange::Kind::moved) {
            moved = true;
            const std::array<Vec3d, 3> outer = linear;
            for (std::size_t r = 0; r < 3; ++r) {
                shift[r] += dot(outer[r], change.shift);
                for (std::size_t c = 0; c < 3; ++c)
                    linear[r][c] = outer[r][0] * change.linear[0][c] + outer[r][1] * change.linear[1][c] +
                                   outer[r][2] * change.linear[2][c];
            }
        }
    }
    if (!moved) return std::nullopt;
    Affine map;
    map.linear = linear;
    map.pivot = tree.origin;
    for (std::size_t a = 0; a < 3; ++a) map.target[a] = shift[a] + tree.origin[a];
    return map;
}

std::optional<Affine> matrix_map_of(const MeshModel& layer)
{
    if (layer.cm.Tr == Matrix44m::Identity()) return std::nullopt;
    Affine map;
    map.pivot = Registry::instance().origin_of(document_of(layer)).value_or(Vec3d{0, 0, 0});
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) map.linear[std::size_t(r)][std::size_t(c)] = double(layer.cm.Tr[r][c]);
        map.target[std::size_t(r)] = map.pivot[std::size_t(r)] + double(layer.cm.Tr[r][3]);
    }
    return map;
}

}  // namespace pcm::host
