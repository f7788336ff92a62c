// Options that select points.
#pragma once

#include "pcm/cli/command_line.h"
#include "pcm/cloud/selection.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pcm::cli {

// --box; one of --sphere, --oriented-box, --ray, --cone, --frustum, --planes, --polygon, or --region with any region in
// words; --clip and --clip-outside; --where.
class RegionOptions {
public:
    void add_to(Options& options, const char* group);
    // --clip, --clip-outside and --where alone.
    void add_limits_to(Options& options, const char* group);
    // Throws Error(invalid_argument) for more than one region, for a box that no point can be in, and everything that
    // parse_region() and parse_condition() throw.
    Selection get() const;

private:
    std::optional<Region> region() const;
    std::vector<double> box_;
    std::vector<std::string> where_, clips_, clips_outside_;
    std::map<std::string, std::vector<std::string>> given_;  // by option, without dashes
};

}  // namespace pcm::cli
