#include "pcm/detect/drawn_points.h"

#include "pcm/fit/random_numbers.h"

#include <algorithm>

namespace pcm {
namespace {

const auto by_draw = [](const auto& a, const auto& b) { return a.first < b.first; };

}  // namespace

void DrawnPoints::add(const Vec3d& p, std::uint64_t number) { add({SampleNumbers(number).next(), p}); }

void DrawnPoints::add(const DrawnPoints& other)
{
    for (const Drawn& one : other.heap_) add(one);
}

void DrawnPoints::add(const Drawn& one)
{
    if (heap_.size() == most_) {
        if (most_ == 0 || one.first >= heap_.front().first) return;
        std::pop_heap(heap_.begin(), heap_.end(), by_draw);
        heap_.pop_back();
    }
    if (heap_.size() == heap_.capacity()) heap_.reserve(std::min(most_, 2 * heap_.size() + 8));  // no more than `most`
    heap_.push_back(one);
    std::push_heap(heap_.begin(), heap_.end(), by_draw);
}

std::vector<Vec3d> DrawnPoints::points() const
{
    std::vector<Drawn> drawn = heap_;
    std::sort(drawn.begin(), drawn.end(), by_draw);
    std::vector<Vec3d> points;
    for (const Drawn& one : drawn) points.push_back(one.second);
    return points;
}

}  // namespace pcm
