// What travels with a cloud beside its points.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pcm {

// Opaque blocks that travel with a cloud (LAS variable length records, coordinate systems): kept byte for byte.
struct Metadata {
    std::string key;  // "las.vlr/<user id>/<record id>", "las.header", ...
    std::vector<std::byte> value;
    bool operator==(const Metadata& o) const { return key == o.key && value == o.value; }
};

}  // namespace pcm
