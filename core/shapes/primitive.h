// A shape that was found in a cloud, with what is known of it: what lists show and files keep.
#pragma once

#include "pcm/shapes/bounds.h"
#include "pcm/shapes/fitted_shape.h"
#include "pcm/shapes/station_facts.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace pcm {

struct Primitive {
    std::string name;  // "Cylinder 3"
    std::array<std::uint8_t, 3> colour{255, 200, 0};
    bool hidden = false;
    std::string cloud;                     // path or name of the cloud
    ShapeFit fit;                          // without is_inlier
    std::optional<StationFacts> stations;  // what the errors contain of them; nothing: the noise alone, not looked at
    ShapeBounds bounds;
    std::uint64_t points = 0;  // number of points of the cloud that belong to it
    std::uint32_t label = 0;   // value of its points in an attribute; 0: none
    std::string estimator;     // "msac"
};

}  // namespace pcm
