// The units of coordinates, for people.
#pragma once

#include "pcm/cloud/metadata.h"

#include <string>
#include <vector>

namespace pcm {

// As the coordinate system in a cloud's metadata states it: "m", "ft", "US survey foot"; else "source units".
std::string height_unit(const std::vector<Metadata>& metadata);
// The same of x and y; "degree" and the like too.
std::string plan_unit(const std::vector<Metadata>& metadata);

}  // namespace pcm
