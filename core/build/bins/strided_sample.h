// The points that decide where the bins of a cloud are: every n-th one, whatever the memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// n is the smallest power of two that leaves at most this many points, ...
inline constexpr std::size_t sample_capacity = std::size_t(1) << 16;
// ... but no larger than this: then each bin, of some hundred thousand points, has enough to be cut by.
inline constexpr std::uint64_t most_sample_stride = 1024;

// n for a cloud of `points`.
inline std::uint64_t sample_stride(std::uint64_t points)
{
    std::uint64_t stride = 1;
    while (stride < most_sample_stride && (points + stride - 1) / stride > sample_capacity) stride *= 2;
    return stride;
}

// The sample of a stream of unknown length: n doubles when there are too many.
template <class T>
class StridedSample {
public:
    void see(const T& item)
    {
        if (seen_++ & (stride_ - 1)) return;  // a power of two
        if (items_.size() == sample_capacity && stride_ < most_sample_stride) {
            for (std::size_t i = 0; 2 * i < items_.size(); ++i) items_[i] = items_[2 * i];
            items_.resize((items_.size() + 1) / 2);
            stride_ *= 2;
            if ((seen_ - 1) & (stride_ - 1)) return;
        }
        items_.push_back(item);
    }
    std::vector<T>& items() { return items_; }

private:
    std::uint64_t seen_ = 0, stride_ = 1;
    std::vector<T> items_;
};

}  // namespace pcm
