// One row of figures, printed as a line of JSON; and the statistics of many times.
#pragma once

#include "pcm/cache/load_times.h"

#include <nlohmann/json.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace pcm::bench {

using Row = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start)
{
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Nearest rank; 0 of nothing.
inline double quantile(std::vector<double> values, double q)
{
    if (values.empty()) return 0;
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
    const std::size_t place = std::min(values.size() - 1, rank ? rank - 1 : 0);
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(place), values.end());
    return values[place];
}

inline double ratio(double part, double whole) { return whole > 0 ? part / whole : 0; }

// NAME_p50, NAME_p99, in milliseconds, and the whole distribution: counts by powers of two of a microsecond, separated
// by spaces.
inline void put_load_times(Row& row, const std::string& name, const LoadTimes& times)
{
    row[name + "_ms_p50"] = 1000 * times.quantile(0.5);
    row[name + "_ms_p99"] = 1000 * times.quantile(0.99);
    std::string counts;
    for (const auto count : times.buckets) counts += (counts.empty() ? "" : " ") + std::to_string(count);
    row[name + "_buckets"] = counts;
}

// Seconds of the processor that this process has used, system's and user's, of all threads.
inline double processor_seconds()
{
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace pcm::bench
