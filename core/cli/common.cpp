#include "pcm/cli/common.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>

namespace pcm::cli {
namespace {

std::atomic<bool> interrupted{false};
std::atomic<bool> line_is_open{false};  // the cursor is behind the progress

void on_interrupt(int) { interrupted = true; }

}  // namespace

void add_common(Options& options, Common& common)
{
    options.flag("--json", common.json, "Print one JSON object instead of text");
    options.flag("-q,--quiet", common.quiet, "Show no progress");
}

ProgressFunction console_progress(const Common& common)
{
    struct sigaction action {};
    action.sa_handler = on_interrupt;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C ends the program at once
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    const bool show = !common.quiet && !common.json && isatty(STDERR_FILENO);
    return [show](const ProgressUpdate& update) {
        if (show) {
            std::fprintf(stderr, "\r%-28.*s %3.0f %%", static_cast<int>(update.stage.size()), update.stage.data(),
                         update.fraction * 100);
            if (update.seconds_left >= 0) std::fprintf(stderr, ", %.0f s left   ", update.seconds_left);
            std::fflush(stderr);
            line_is_open = true;
        }
        return !interrupted;
    };
}

void end_progress(const Common& common)
{
    if (!common.quiet && !common.json && isatty(STDERR_FILENO)) std::fprintf(stderr, "\r%60s\r", "");
    line_is_open = false;
}

void leave_progress_line()
{
    if (line_is_open.exchange(false)) std::fputs("\n", stderr);
}

std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

void print_json(const Json& json) { std::fputs(text_of(json).c_str(), stdout); }

int finished(const Outcome& outcome)
{
    for (const std::string& warning : outcome.warnings) std::fprintf(stderr, "pcmlab: warning: %s\n", warning.c_str());
    return outcome.warnings.empty() ? 0 : done_with_warnings;
}

}  // namespace pcm::cli
