#include "pcm/cache/load_times.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcm {

void LoadTimes::add(double seconds)
{
    const double microseconds = seconds * 1e6;
    std::size_t bucket = 0;
    if (microseconds >= 2) {
        int exponent = 0;
        std::frexp(microseconds, &exponent);  // microseconds lie in [2^(exponent-1), 2^exponent)
        bucket = std::isfinite(microseconds) ? static_cast<std::size_t>(exponent - 1) : buckets.size();
    }
    ++buckets[std::min(bucket, buckets.size() - 1)];
}

std::uint64_t LoadTimes::count() const { return std::accumulate(buckets.begin(), buckets.end(), std::uint64_t(0)); }

double LoadTimes::quantile(double q) const
{
    const double wanted = std::clamp(q, 0.0, 1.0) * static_cast<double>(count());
    double before = 0;
    double end = 0;
    for (std::size_t b = 0; b < buckets.size(); ++b) {
        if (buckets[b] == 0) continue;
        const auto here = static_cast<double>(buckets[b]);
        const double first = b == 0 ? 0 : std::ldexp(1e-6, static_cast<int>(b));
        end = std::ldexp(1e-6, static_cast<int>(b) + 1);
        if (before + here >= wanted) return first + (end - first) * std::max(0.0, wanted - before) / here;
        before += here;
    }
    return end;
}

LoadTimes& LoadTimes::operator+=(const LoadTimes& other)
{
    for (std::size_t b = 0; b < buckets.size(); ++b) buckets[b] += other.buckets[b];
    return *this;
}

}  // namespace pcm
