#include "pcm/filter/level_clock.h"

#include <algorithm>
#include <utility>

namespace pcm {

LevelClock::LevelClock(std::vector<double> costs, std::size_t level, double seconds)
    : costs_(std::move(costs)), first_(level), seconds_(seconds), coarsest_(level)
{
}

std::size_t LevelClock::next(double passed, double share, std::size_t units)
{
    const std::lock_guard lock(mutex_);
    const double all = static_cast<double>(units), done = share * all, given = static_cast<double>(given_);
    std::size_t level = passed < seconds_ ? first_ : 0;
    if (done > 0 && given > 0) {
        // On average half of each unit that is under way is done.
        const double cost_done = begun_ / given * (done + (given - done) / 2);
        const double seconds_per_cost = passed / cost_done;
        const double left = seconds_ - passed - seconds_per_cost * begun_ / given * (given - done) / 2;
        while (level > 0 && (all - given) * costs_[level] * seconds_per_cost > left) --level;
    }
    begun_ += costs_[level];
    ++given_;
    if (level < first_) ++coarser_;
    coarsest_ = std::min(coarsest_, level);
    return level;
}

std::size_t LevelClock::units() const
{
    const std::lock_guard lock(mutex_);
    return given_;
}

std::size_t LevelClock::coarser_units() const
{
    const std::lock_guard lock(mutex_);
    return coarser_;
}

std::size_t LevelClock::coarsest() const
{
    const std::lock_guard lock(mutex_);
    return coarsest_;
}

}  // namespace pcm
