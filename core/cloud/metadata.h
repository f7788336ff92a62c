// Metadata of a cloud: data that belongs to the whole cloud, not to points.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pcm {

// An opaque block that is copied with the cloud byte for byte: a LAS variable length record, a coordinate system.
struct Metadata {
    std::string key;  // "las.vlr/<user id>/<record id>", "las.header", ...
    std::vector<std::byte> value;
    bool operator==(const Metadata& o) const { return key == o.key && value == o.value; }
};

}  // namespace pcm
