// What the commands that compute attributes from neighbours have in common.
#pragma once

#include "pcm/cli/common.h"
#include "pcm/cli/target_options.h"
#include "pcm/filter/neighbour_attributes.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm::cli {

// Neighbours, precision, memory and threads.
struct NeighbourOptions {
    std::uint32_t neighbours = 16;
    std::optional<double> max_distance;
    std::optional<std::uint16_t> level;
    std::optional<double> time_limit, error_target;
    std::uint64_t memory = std::uint64_t(512) << 20;
    std::uint32_t threads = 0;
    bool flann = false;
    void add_to(Options& options);
    void put_into(NeighbourAttributeOptions& options) const;
};

// Throws Error(invalid_argument) for a memory limit that the command cannot keep; otherwise makes the allocator return
// large blocks, so that it does.
void keep_memory_limit(std::uint64_t bytes, std::uint64_t least);

// Adds a note where the process took more memory than the limit.
void note_memory(FilterReport& report, std::uint64_t limit);

// points, seconds, ..., level, errors, notes.
void put_report(Json& json, const FilterReport& report);

// The same and what attributes have of their own; as JSON and as text.
void put_attribute_report(Json& json, const WantedValues& wanted, const NeighbourAttributeReport& report);
void print_attribute_report(const std::filesystem::path& tree, const WantedValues& wanted,
                            const NeighbourAttributeReport& report);

// Runs the filter on `tree` and prints its report. Returns the exit code.
int run_attribute_filter(const Common& common, const std::string& tree, const TargetOptions& target,
                         NeighbourAttributeOptions options);

}  // namespace pcm::cli
