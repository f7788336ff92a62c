// The unit of the lengths in a document's scene.
#pragma once

#include "plugin/scene/scene.h"

#include "pcm/io/crs/coordinate_system.h"

#include <QString>

#include <optional>
#include <string>

namespace pcm::host {

struct LengthUnit {
    std::string symbol;  // "m"; empty: not known
    // The system that the document's clouds state, if they agree.
    std::optional<CoordinateSystem> system;
    bool is_stated = false;  // the clouds state it, or they contradict each other; else it is the user's choice
    QString warning;         // why lengths may mean nothing; empty: they mean what they say
};

// The unit of all layers whose clouds state a coordinate system; where they state no unit, the project's
// (scene/project_unit.h). GUI thread.
LengthUnit length_unit_of(const Scene& scene);

// The same for the systems that are stated, in any order.
LengthUnit common_unit(const std::vector<CoordinateSystem>& systems);

}  // namespace pcm::host
