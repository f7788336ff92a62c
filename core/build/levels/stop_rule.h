// When the points chosen for the levels of a cloud are enough.
#pragma once

#include <cmath>
#include <cstdint>

namespace pcm {

// Sampling ends when a bin has at most ten times its chosen points, in the geometric mean over all points. Surfaces
// have four times the points at half the spacing, so the step to the whole cloud is like that between levels. Few
// points in much denser places are not waited for; many are, until the step there is as small.
class StopRule {
public:
    // A bin of `points` > 0, of which `chosen` are chosen.
    void see(std::uint64_t points, std::uint64_t chosen)
    {
        all_ += static_cast<double>(points);
        sum_ += static_cast<double>(points) * doublings(points, chosen);
    }
    bool reached() const { return sum_ <= most_doublings * all_; }

private:
    static constexpr double most_doublings = 3.25;   // doublings(10, 1)
    static constexpr double none_chosen = 1.0 / 16;  // counts as that many: a bin of one point, not chosen, is not done

    // How often `chosen` is doubled until it is `points`: the logarithm to base 2, linear between powers of two. Made
    // of operations that IEEE 754 defines to the last bit, because it decides the bytes of a tree.
    static double doublings(std::uint64_t points, std::uint64_t chosen)
    {
        const double ratio = static_cast<double>(points) / (chosen ? static_cast<double>(chosen) : none_chosen);
        const int whole = std::ilogb(ratio);
        return whole + (std::ldexp(ratio, -whole) - 1);
    }

    double all_ = 0, sum_ = 0;  // points; points times doublings
};

}  // namespace pcm
