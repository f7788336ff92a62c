// A number that a benchmark's curve decides, by its name, so that the benchmark can draw the curve again.
#pragma once

#include <cmath>
#include <cstddef>

namespace pcm {

// Refers to a value of a room's tuning.h. Values are changed by benchmarks alone, before anything works: nothing locks
// them.
class TunedValue {
public:
    TunedValue(const char* name, double& value) : name_(name), real_(&value) {}
    TunedValue(const char* name, std::size_t& value) : name_(name), count_(&value) {}

    const char* name() const { return name_; }  // "fit.consensus.max_chance"
    bool is_count() const { return count_ != nullptr; }
    double get() const { return real_ ? *real_ : static_cast<double>(*count_); }
    // A count is rounded.
    void set(double value) const
    {
        if (real_)
            *real_ = value;
        else
            *count_ = static_cast<std::size_t>(std::llround(value));
    }

private:
    const char* name_;
    double* real_ = nullptr;
    std::size_t* count_ = nullptr;
};

}  // namespace pcm

// A row of a room's table, named like the value.
#define PCM_TUNED(value) pcm::TunedValue(#value, value)
