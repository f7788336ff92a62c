// Maps the fields of all scans of an E57 file to attributes.
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

// The destination of one field of a scan.
struct E57Target {
    std::size_t field = 0;
    std::size_t attribute = 0;
    std::uint32_t component = 0;
    // Integer attributes come from integer fields and get the raw numbers, clamped to their type; float attributes get
    // value * factor.
    double factor = 1;
    bool widened = false;  // 8-bit colours for a 16-bit attribute: clamped to 0..255, times 257
};

struct E57ScanPlan {
    std::optional<std::array<std::size_t, 3>> cartesian, spherical;  // fields: x y z; range azimuth elevation
    std::optional<std::size_t> cartesian_state, spherical_state;     // fields: 0 where the coordinates are valid
    std::vector<E57Target> targets;                                  // attributes without a target are 0
};

struct E57Plan {
    Schema schema;
    std::vector<E57ScanPlan> scans;
    std::optional<std::size_t> scan_number;  // the attribute with the scan's number, when there are several scans
    std::vector<std::string> notes;
};

// Fields of the same name become one attribute, of a type that holds all of them: integers of the smallest type for the
// declared range, scaled integers with their scale and offset, floats unchanged; doubles where scans differ in kind or
// scale. Red, green and blue become "rgb": u8 when the maximum is 255, else u16, and 0..1 for floats. "normal" is
// normalX, normalY and normalZ of an extension. Throws Error(bad_format | unsupported).
E57Plan plan_e57(const std::filesystem::path& path, const std::vector<E57Scan>& scans);

}  // namespace pcm
