// What the commands share.
#pragma once

#include "pcm/cli/command_line.h"
#include "pcm/system/progress.h"
#include "pcm/system/text.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>

namespace pcm::cli {

using Json = nlohmann::ordered_json;

// Options every command has.
struct Common {
    bool json = false;   // print one JSON object and nothing else
    bool quiet = false;  // no progress
};
void add_common(Options& options, Common& common);

// A line on stderr that is rewritten while the operation runs; nothing when stderr is no terminal, or with --quiet or
// --json. Ctrl-C cancels the operation, which then cleans up behind itself.
ProgressFunction console_progress(const Common& common);
void end_progress(const Common& common);

std::uint64_t peak_rss_bytes();

double points_per_second(const Outcome& outcome);
// points, seconds, points_per_second, peak_rss_bytes: what every command that works through points prints.
void put_outcome(Json& json, const Outcome& outcome);

}  // namespace pcm::cli
