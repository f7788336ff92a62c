// What MeshLab's tools have done to the sample of a tree.
//
// Tools work on the vertices that a layer has: of a tree, on its sample. What they do is of no effect on the cloud, and
// MeshLab's messages ("Deleted 5506 vertices") suggest that it was. GUI thread.
#pragma once

#include "plugin/meshlab/registry.h"
#include "plugin/scene/proxy.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm::host {

struct SampleChange {
    enum class Kind : std::uint8_t {
        none,
        moved,    // all vertices by one matrix, and nothing else: a matrix was frozen
        deleted,  // vertices are missing, and nothing else changed
        other,
    } kind = Kind::none;
    std::string text;                    // what a user did: "5,506 of 48,947 vertices were deleted"
    std::array<Vec3d, 3> linear{};       // for `moved`: position -> linear * position + shift, in MeshLab's coordinates
    Vec3d shift{};                       // for `moved`
    std::vector<std::uint32_t> deleted;  // for `deleted`: indices in the sample, ascending
};

// The difference between the layer's vertices and its sample. Exact for deleted vertices; a matrix is found if all
// vertices agree with it to within the rounding of floats, and if the sample is not flat.
SampleChange find_change(const MeshModel& layer, const Proxy& sample);

// The same as a sentence for the log, with what the user can do; empty if the layer shows no tree or nothing has
// changed.
std::string sample_warning(const MeshModel& layer);

// Puts a frozen matrix back: the sample has its positions again and the layer's matrix moves all of the cloud.
void unfreeze(MeshModel& layer, const Proxy& sample, const SampleChange& moved);

// The layer has the vertices of its sample again, and nothing else.
void restore_sample(MeshModel& layer, const Proxy& sample);

}  // namespace pcm::host
