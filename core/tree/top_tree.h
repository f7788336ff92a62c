// The top of the tree: cuts chosen from a sample, down to bins that fit in memory.
#pragma once

#include "tree/cut.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

template <class Coord>
struct TopTree {
    struct Node {
        std::size_t axis = 0;
        Coord value = 0;
        std::array<std::uint32_t, 2> children{0, 0};  // 0: this is a bin
        std::size_t bin = 0;
    };
    std::vector<Node> nodes{Node()};  // the root; one bin until it is divided

    std::size_t bin_of(const std::array<Coord, 3>& c) const { return bin_of(c, 0); }
    std::size_t bin_of(const std::array<Coord, 3>& c, std::uint32_t from) const
    {
        std::uint32_t n = from;
        while (nodes[n].children[0]) n = nodes[n].children[c[nodes[n].axis] < nodes[n].value ? 0 : 1];
        return nodes[n].bin;
    }
};

template <class Coord>
class TopPlanner {
public:
    using Sample = std::vector<std::array<Coord, 3>>;
    TopPlanner(TopTree<Coord>& top, const AxisShift& finer, std::uint64_t bin_points)
        : top_(top), finer_(finer), bin_points_(bin_points)
    {
    }
    // Divides node `at`, which stands for `points` points of which `sample` is a part; bins are numbered from `first_bin`.
    // Returns how many bins there are. One bin means that the node could not be divided.
    std::size_t plan(std::uint32_t at, Sample& sample, std::uint64_t points, std::size_t first_bin)
    {
        next_bin_ = first_bin;
        divide(at, sample.data(), sample.size(), points, 0);
        return next_bin_ - first_bin;
    }

private:
    void divide(std::uint32_t at, std::array<Coord, 3>* sample, std::size_t count, std::uint64_t points, int depth)
    {
        std::optional<Cut<Coord>> cut;
        // A sample of a few points says too little to cut by.
        if (points > bin_points_ && count >= 16 && depth < 64)
            cut = choose_cut<Coord>(count, finer_, [&](std::size_t i, std::size_t axis) { return sample[i][axis]; });
        if (!cut) {
            top_.nodes[at].bin = next_bin_++;
            return;
        }
        auto* middle = std::partition(sample, sample + count, [&](const auto& c) { return c[cut->axis] < cut->value; });
        const auto left = static_cast<std::size_t>(middle - sample);
        const auto left_points =
            static_cast<std::uint64_t>(static_cast<double>(points) * static_cast<double>(left) / static_cast<double>(count));
        const auto first = static_cast<std::uint32_t>(top_.nodes.size());
        top_.nodes.resize(top_.nodes.size() + 2);
        top_.nodes[at].axis = cut->axis;
        top_.nodes[at].value = cut->value;
        top_.nodes[at].children = {first, first + 1};
        divide(first, sample, left, left_points, depth + 1);
        divide(first + 1, middle, count - left, points - left_points, depth + 1);
    }
    TopTree<Coord>& top_;
    const AxisShift& finer_;
    std::uint64_t bin_points_;
    std::size_t next_bin_ = 0;
};

// Keeps every n-th of what it is shown, n doubling when it is full: a strided sample of a stream of unknown length.
template <class T>
class StridedSample {
public:
    explicit StridedSample(std::size_t capacity) : capacity_(std::max<std::size_t>(capacity, 64)) {}
    void see(const T& item)
    {
        if (seen_++ % stride_ != 0) return;
        if (items_.size() == capacity_) {
            for (std::size_t i = 0; 2 * i < items_.size(); ++i) items_[i] = items_[2 * i];
            items_.resize((items_.size() + 1) / 2);
            stride_ *= 2;
            if ((seen_ - 1) % stride_ != 0) return;
        }
        items_.push_back(item);
    }
    std::vector<T>& items() { return items_; }

private:
    std::size_t capacity_;
    std::uint64_t seen_ = 0, stride_ = 1;
    std::vector<T> items_;
};

}  // namespace pcm
