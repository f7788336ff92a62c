#include "plugin/meshlab/2020/placement.h"

#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/sample_change.h"

namespace pcm::host {

std::optional<Affine> placement_of(const MeshModel& layer, const TreeLayer& tree)
{
    // position -> linear * position + shift, in MeshLab's coordinates
    const LayerMatrix matrix = layer_of(layer).matrix();
    std::array<Vec3d, 3> linear;
    Vec3d shift;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) linear[r][c] = double(matrix[r][c]);
        shift[r] = double(matrix[r][3]);
    }
    bool moved = matrix != identity_matrix;
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

}  // namespace pcm::host
