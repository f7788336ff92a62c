// Options that choose points by a region.
#pragma once

#include "cloud/region.h"

#include <CLI/CLI.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pcm::cli {

// --sphere, --oriented-box, --ray, --cone, --frustum, --planes, and --region with any of them in words; one of them.
class RegionOptions {
public:
    void add_to(CLI::App& command, const char* group);
    // Throws Error(invalid_argument) for more than one region, and what parse_region() throws.
    std::optional<Region> get() const;

private:
    std::map<std::string, std::vector<std::string>> given_;  // by option, without dashes
};

}  // namespace pcm::cli
