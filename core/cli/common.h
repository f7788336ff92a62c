// What the commands share.
#pragma once

#include "pcm/system/progress.h"
#include "pcm/system/text.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <string>

namespace pcm::cli {

using Json = nlohmann::ordered_json;

// Options every command has.
struct Common {
    bool json = false;   // print one JSON object and nothing else
    bool quiet = false;  // no progress
};
void add_common(CLI::App& command, Common& common);

// A line on stderr that is rewritten while the operation runs; nothing when stderr is no terminal, or with --quiet or
// --json. Ctrl-C cancels the operation, which then cleans up behind itself.
ProgressFunction console_progress(const Common& common);
void end_progress(const Common& common);

std::uint64_t peak_rss_bytes();

double points_per_second(const Outcome& outcome);
// points, seconds, points_per_second, peak_rss_bytes: what every command that works through points prints.
void put_outcome(Json& json, const Outcome& outcome);

// Parses, which runs what was asked for and sets `result`; says on stderr what went wrong. Exit codes: 0 all is well; 1
// it is not (the message says what); 2 the command line makes no sense; 130 cancelled. `first` runs before, and may do
// it all.
int run(CLI::App& app, int argc, char** argv, int& result, const std::function<void()>& first = {});

void add_render(CLI::App& app);
void run_render(char** arguments);  // arguments[0] is "render"; does not return. Throws Error(not_found) when the
                                    // program is not there.
void add_build(CLI::App& app, int& result);
void add_convert(CLI::App& app, int& result);
void add_info(CLI::App& app, int& result);
void add_verify(CLI::App& app, int& result);
void add_append(CLI::App& app, int& result);
void add_compact(CLI::App& app, int& result);
void add_delete(CLI::App& app, int& result);
void add_repair(CLI::App& app, int& result);
void add_set(CLI::App& app, int& result);
void add_transform(CLI::App& app, int& result);
void add_query(CLI::App& app, int& result);
void add_generate(CLI::App& app, int& result);

}  // namespace pcm::cli
