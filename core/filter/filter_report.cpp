#include "pcm/filter/filter_report.h"

#include <cstdio>

namespace pcm {
namespace {

std::string two_digits(double value)
{
    char text[40];
    std::snprintf(text, sizeof text, value >= 9.95 ? "%.0f" : value >= 0.0995 ? "%.1f" : "%.2g", value);
    return text;
}

}  // namespace

std::string outcome_text(const std::string& what, const FilterReport& report)
{
    std::string text = what;
    if (report.level) text += " at level " + std::to_string(*report.level);
    char seconds[40];
    std::snprintf(seconds, sizeof seconds, ": %.1f s", report.outcome.seconds);
    text += seconds;
    if (!report.level) return text + ", exact";
    const char* separator = ", ";
    for (const SampledError& error : report.errors) {
        text += separator + (report.errors.size() > 1 ? error.what + " " : "") + "median error " +
                two_digits(error.median) + " " + error.unit + ", p95 " + two_digits(error.p95) + " " + error.unit +
                " [" + two_digits(error.p95_low) + " to " + two_digits(error.p95_high) + "]";
        separator = "; ";
    }
    return text + " (" + std::to_string(report.points_checked) + " points checked)";
}

}  // namespace pcm
