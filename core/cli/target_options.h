// Where the result of a command that changes a tree goes: -o COPY, --in-place and --overwrite.
#pragma once

#include "pcm/cli/command_line.h"
#include "pcm/update/target.h"

#include <string>

namespace pcm::cli {

struct TargetOptions {
    std::string output;
    bool in_place = false;
    bool overwrite = false;  // see add_overwrite()
    void add_to(Options& options);
    // For an existing output, and for attributes of these names that the command did not make: "curvature,
    // mean_distance"; empty: it writes none.
    void add_overwrite(Options& options, const std::string& names);
    // Throws UsageError unless exactly one of the two was given.
    TargetChoice get() const;
};

}  // namespace pcm::cli
