// Why a cloud does not fit the clouds that a document already shows.
#pragma once

#include "plugin/scene/scene.h"

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/metadata.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

struct Misfit {
    enum class Kind {
        system,    // another coordinate system, or another unit
        distance,  // so far away that floats round its positions visibly, and a view of everything shows specks
    } kind;
    std::string text;  // a sentence for the log and for a question
};

// For a cloud with this metadata and this box (source coordinates; absent: not known yet), about to be shown in
// `layer`. It is compared with the trees and files of the document's other layers. GUI thread.
std::vector<Misfit> misfits(const SceneLayer& layer, const std::vector<Metadata>& metadata,
                            const std::optional<Box3d>& box);

// Whether positions in `box` are rounded visibly relative to `origin`, though not relative to an origin of their own.
bool rounds_visibly(const Box3d& box, const Vec3d& origin);

}  // namespace pcm::host
