// Units of a cloud's numbers, for people.
#pragma once

#include "pcm/cloud/metadata.h"

#include <string>
#include <vector>

namespace pcm::host {

// Of heights, as the coordinate system in the cloud's metadata states it: "m", "ft", "US survey foot"; else "source
// units".
std::string height_unit(const std::vector<Metadata>& metadata);

// Of an attribute by its usual name: "s" of gps_time, "°" of scan angles; empty for numbers without a unit, and where
// it is not known.
std::string attribute_unit(const std::string& name);

}  // namespace pcm::host
