#include "cli/common.h"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace pcm::cli {
namespace {

std::atomic<bool> interrupted{false};

void on_interrupt(int) { interrupted = true; }

}  // namespace

void add_common(CLI::App& command, Common& common)
{
    command.add_flag("--json", common.json, "Print one JSON object instead of text");
    command.add_flag("-q,--quiet", common.quiet, "Show no progress");
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
        }
        return !interrupted;
    };
}

void end_progress(const Common& common)
{
    if (!common.quiet && !common.json && isatty(STDERR_FILENO)) std::fprintf(stderr, "\r%60s\r", "");
}

std::uint64_t peak_rss_bytes()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::string grouped(std::uint64_t number)
{
    std::string text = std::to_string(number);
    for (auto i = static_cast<int>(text.size()) - 3; i > 0; i -= 3) text.insert(static_cast<std::size_t>(i), ",");
    return text;
}

std::string bytes_text(std::uint64_t bytes)
{
    static const char* units[] = {"bytes", "kB", "MB", "GB", "TB"};
    auto value = static_cast<double>(bytes);
    int unit = 0;
    while (value >= 1000 && unit < 4) {
        value /= 1000;
        ++unit;
    }
    char text[32];
    std::snprintf(text, sizeof text, unit ? "%.2f %s" : "%.0f %s", value, units[unit]);
    return text;
}

std::string exact(double value)
{
    // Coordinates are read by people: no exponent where the number fits without.
    const double magnitude = std::fabs(value);
    const bool plain = magnitude == 0 || (magnitude >= 1e-6 && magnitude < 1e15);
    char text[64];
    const auto end =
        std::to_chars(text, text + sizeof text, value, plain ? std::chars_format::fixed : std::chars_format::scientific).ptr;
    return std::string(text, end);
}

}  // namespace pcm::cli
