#include "pcm/filter/filter_report.h"

#include <cstdio>

namespace pcm {

std::string outcome_text(const std::string& what, const FilterReport& report)
{
    char seconds[40];
    std::snprintf(seconds, sizeof seconds, ": %.1f s", report.outcome.seconds);
    return what + seconds + ", exact";
}

}  // namespace pcm
