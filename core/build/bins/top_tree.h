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
    // Cells are cubes on grids that are equally fine along all axes; those at the sides of the grid extend without
    // limit. Empty: begin at the root.
    static constexpr int grid_bits = 16;  // the number of cells is at most 2 to this power
    std::vector<std::uint32_t> starts;
    std::array<Coord, 3> grid_low{};
    std::array<int, 3> grid_shift{};           // the width of a cell along an axis is 2 to this power
    std::array<std::uint64_t, 3> grid_last{};  // number of the last cell along an axis
    std::array<int, 3> grid_place{};           // lowest bit of a coordinate in a cell's number

    // For a grid over the box from `low` to `high`.
    void make_starts(const std::array<Coord, 3>& low, const std::array<Coord, 3>& high, const AxisShift& finer)
    {
        grid_low = low;
        int bits = grid_bits + 1;  // size of a cell's number
        for (int shift = 0; bits > grid_bits; ++shift) {
            bits = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                grid_shift[a] = std::min(static_cast<int>(sizeof(Coord)) * 8 - 1, shift + finer[a]);
                grid_last[a] = static_cast<std::uint64_t>(high[a] - low[a]) >> grid_shift[a];
                grid_place[a] = bits;
                if (grid_last[a]) bits += 64 - __builtin_clzll(grid_last[a]);
            }
        }
        starts.assign(std::size_t(1) << bits, 0);
        std::array<std::uint64_t, 3> cell{};
        for (cell[2] = 0; cell[2] <= grid_last[2]; ++cell[2])
            for (cell[1] = 0; cell[1] <= grid_last[1]; ++cell[1])
                for (cell[0] = 0; cell[0] <= grid_last[0]; ++cell[0]) starts[number_of(cell)] = deepest_around(cell);
    }
    std::uint32_t start_of(const std::array<Coord, 3>& c) const
    {
        std::array<std::uint64_t, 3> cell;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::uint64_t steps = c[a] > grid_low[a] ? static_cast<std::uint64_t>(c[a] - grid_low[a]) : 0;
            cell[a] = std::min(steps >> grid_shift[a], grid_last[a]);
        }
        return starts[number_of(cell)];
    }
    std::size_t bin_of(const std::array<Coord, 3>& c) const { return bin_of(c, starts.empty() ? 0 : start_of(c)); }
    std::size_t bin_of(const std::array<Coord, 3>& c, std::uint32_t from) const
    {
        // Most points are done after two steps. Which they need cannot be predicted, so these are taken without asking.
        std::uint32_t n = from;
        for (int step = 0; step < 2; ++step) {
            const std::uint32_t next = nodes[n].children[static_cast<std::size_t>(c[nodes[n].axis] >= nodes[n].value)];
            n = next | (n & (next ? 0u : ~0u));
        }
        while (nodes[n].children[0]) n = nodes[n].children[c[nodes[n].axis] < nodes[n].value ? 0 : 1];
        return nodes[n].bin;
    }

private:
    std::size_t number_of(const std::array<std::uint64_t, 3>& cell) const
    {
        return static_cast<std::size_t>(cell[0] << grid_place[0] | cell[1] << grid_place[1] | cell[2] << grid_place[2]);
    }
    std::uint32_t deepest_around(const std::array<std::uint64_t, 3>& cell) const
    {
        std::array<Coord, 3> first, last;  // coordinates in the cell
        for (std::size_t a = 0; a < 3; ++a) {
            const std::uint64_t room = std::numeric_limits<Coord>::max() - grid_low[a];
            const std::uint64_t from = cell[a] << grid_shift[a], to = from + (std::uint64_t(1) << grid_shift[a]) - 1;
            first[a] = cell[a] == 0 ? Coord(0) : static_cast<Coord>(grid_low[a] + std::min(from, room));
            last[a] = cell[a] == grid_last[a] || to < from ? std::numeric_limits<Coord>::max()
                                                           : static_cast<Coord>(grid_low[a] + std::min(to, room));
        }
        std::uint32_t n = 0;
        while (nodes[n].children[0]) {
            const Node& node = nodes[n];
            const bool left = last[node.axis] < node.value;
            if (!left && first[node.axis] < node.value) break;
            n = node.children[left ? 0 : 1];
        }
        return n;
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
            top_.make_starts(low, high, finer_);
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
