// GeoTIFF keys, with which LAS files before 1.4 state their coordinate system (OGC 19-008r4).
#pragma once

#include "pcm/io/crs/coordinate_system.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

struct GeoKey {
    unsigned id = 0;
    unsigned place = 0;  // 0: `value` is the value; else the record that holds it, 34736 doubles or 34737 text
    unsigned count = 0;
    unsigned value = 0;  // or the first index in that record
};

// The keys of a directory (record 34735); fewer where it is cut.
std::vector<GeoKey> geo_keys_of(const std::vector<std::byte>& directory);

// "ProjectedCSType", or "key 3081" where LAS files do not use it.
std::string name_of_geo_key(unsigned id);

// The system that the keys state; `ascii` is record 34737. Nothing when no key says anything of it.
std::optional<CoordinateSystem> decode_geo_keys(const std::vector<std::byte>& directory,
                                                const std::vector<std::byte>& doubles,
                                                const std::vector<std::byte>& ascii);

}  // namespace pcm
