// Which attributes the fields of an E57 file's scans become, over all of its scans.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/io/e57/e57_file.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Where one field of a scan goes.
struct E57Target {
    std::size_t field = 0;
    std::size_t attribute = 0;
    std::uint32_t component = 0;
    // Attributes of integers, whose fields are integers, get the raw numbers, cut to their type; those of floats get
    // value * factor.
    double factor = 1;
    bool widened = false;  // colours of 8 bits for an attribute of 16: cut to 0..255, times 257
};

struct E57ScanPlan {
    std::optional<std::array<std::size_t, 3>> cartesian, spherical;  // fields: x y z; range azimuth elevation
    std::optional<std::size_t> cartesian_state, spherical_state;     // fields: 0 where the coordinates are valid
    std::vector<E57Target> targets;                                  // attributes that none leads to are 0
};

struct E57Plan {
    Schema schema;
    std::vector<E57ScanPlan> scans;
    std::optional<std::size_t> scan_number;  // the attribute that holds it, where there are several
    std::vector<std::string> notes;
};

// Fields of one name are one attribute in the type that holds all of them: integers of the smallest type that has the
// declared range, scaled integers with their scale and offset, floats as they are; where scans differ in kind or scale,
// doubles. Red, green and blue are "rgb" in u8 when they end at 255, else u16, and 0..1 in floats; "normal" is
// normalX, normalY and normalZ of an extension. Throws Error(bad_format | unsupported).
E57Plan plan_e57(const std::filesystem::path& path, const std::vector<E57Scan>& scans);

}  // namespace pcm
