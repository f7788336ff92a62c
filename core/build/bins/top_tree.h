// The top of the tree: cuts chosen from a sample, down to bins that fit in memory.
#pragma once

#include "pcm/build/bins/cut.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
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

    // Where bin_of() begins, so that it passes fewer nodes: for each cell of a grid, the deepest node that contains it.
    // Cells at the sides of the grid extend without limit. Empty: begin at the root.
    static constexpr int grid_bits = 5;
    static constexpr std::uint64_t grid_last = (1u << grid_bits) - 1;  // 32 cells along an axis
    std::vector<std::uint32_t> starts;
    std::array<Coord, 3> grid_low{};
    std::array<int, 3> grid_shift{};

    // For a grid over the box from `low` to `high`.
    void make_starts(const std::array<Coord, 3>& low, const std::array<Coord, 3>& high)
    {
        grid_low = low;
        for (std::size_t a = 0; a < 3; ++a)
            for (grid_shift[a] = 0; static_cast<std::uint64_t>(high[a] - low[a]) >> grid_shift[a] > grid_last;)
                ++grid_shift[a];
        starts.resize(std::size_t(1) << (3 * grid_bits));
        for (std::size_t cell = 0; cell < starts.size(); ++cell) {
            std::array<Coord, 3> first, last;  // coordinates in the cell
            for (std::size_t a = 0; a < 3; ++a) {
                const std::uint64_t along = cell >> (a * grid_bits) & grid_last;
                const std::uint64_t room = std::numeric_limits<Coord>::max() - low[a];
                const std::uint64_t from = along << grid_shift[a], to = from + (std::uint64_t(1) << grid_shift[a]) - 1;
                first[a] = along == 0 ? Coord(0) : static_cast<Coord>(low[a] + std::min(from, room));
                last[a] = along == grid_last || to < from ? std::numeric_limits<Coord>::max()
                                                          : static_cast<Coord>(low[a] + std::min(to, room));
            }
            std::uint32_t n = 0;
            while (nodes[n].children[0]) {
                const Node& node = nodes[n];
                const bool left = last[node.axis] < node.value;
                if (!left && first[node.axis] < node.value) break;
                n = node.children[left ? 0 : 1];
            }
            starts[cell] = n;
        }
    }
    std::uint32_t start_of(const std::array<Coord, 3>& c) const
    {
        std::size_t cell = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::uint64_t steps = c[a] > grid_low[a] ? static_cast<std::uint64_t>(c[a] - grid_low[a]) : 0;
            cell |= static_cast<std::size_t>(std::min(steps >> grid_shift[a], grid_last)) << (a * grid_bits);
        }
        return starts[cell];
    }
    std::size_t bin_of(const std::array<Coord, 3>& c) const { return bin_of(c, starts.empty() ? 0 : start_of(c)); }
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
    // Divides node `at` of `points` points, given a sample of them; bins are numbered from `first_bin`. Reorders the
    // sample. Returns the number of bins; 1 means that the node could not be divided.
    std::size_t plan(std::uint32_t at, Sample& sample, std::uint64_t points, std::size_t first_bin)
    {
        next_bin_ = first_bin;
        divide(at, sample.data(), sample.size(), points, 0);
        if (at == 0 && !sample.empty()) {
            std::array<Coord, 3> low = sample[0], high = sample[0];
            for (const auto& c : sample)
                for (std::size_t a = 0; a < 3; ++a) {
                    low[a] = std::min(low[a], c[a]);
                    high[a] = std::max(high[a], c[a]);
                }
            top_.make_starts(low, high);
        }
        return next_bin_ - first_bin;
    }

private:
    void divide(std::uint32_t at, std::array<Coord, 3>* sample, std::size_t count, std::uint64_t points, int depth)
    {
        std::optional<Cut<Coord>> cut;
        // A few points are too small a sample for a cut.
        if (points > bin_points_ && count >= 16 && depth < 64)
            cut = choose_cut<Coord>(count, finer_, [&](std::size_t i, std::size_t axis) { return sample[i][axis]; });
        if (!cut) {
            top_.nodes[at].bin = next_bin_++;
            return;
        }
        auto* middle = std::partition(sample, sample + count, [&](const auto& c) { return c[cut->axis] < cut->value; });
        const auto left = static_cast<std::size_t>(middle - sample);
        const auto left_points = static_cast<std::uint64_t>(static_cast<double>(points) * static_cast<double>(left) /
                                                            static_cast<double>(count));
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

}  // namespace pcm
