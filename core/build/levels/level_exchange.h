// What the processes that sample the bins of one cloud send each other (threads/team.h). Each works on the bins that it
// owns; the others' are known to it by their boxes and by what is exchanged here. All functions but owns() are
// collective.
#pragma once

#include "pcm/build/levels/bin_neighbours.h"
#include "pcm/build/levels/sorted_points.h"
#include "pcm/threads/team.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace pcm {

template <class Coord>
class LevelExchange {
public:
    using Found = std::vector<Point<Coord>>;
    using Near = typename BinNeighbours<Coord>::Lists;
    // Takes points of a bin of another process.
    using Take = std::function<void(std::size_t bin, const Found& points)>;

    // `owner`: the rank of each bin.
    LevelExchange(Team& team, std::vector<unsigned> owner) : team_(team), owner_(std::move(owner)) {}

    bool owns(std::size_t bin) const { return owner_[bin] == team_.rank(); }
    unsigned owner(std::size_t bin) const { return owner_[bin]; }

    // Before send_borders(): which bins are near each other at this spacing.
    void connect(const Near& near);
    // Whether one of the bins near this one is owned.
    bool touches(const std::vector<std::uint32_t>& near) const;
    // Points of owned bins, each to the owners of those bins near its own that are nearer to it than the spacing.
    void send_borders(const std::vector<std::pair<std::size_t, Found>>& chosen, const Near& near,
                      const BinNeighbours<Coord>& neighbours, const SortedPoints<Coord>& points, double spacing,
                      const Take& take);
    // Points of bins that rank `from` owns, to all.
    void send_all(unsigned from, const std::vector<std::pair<std::size_t, Found>>& chosen, const Take& take);
    // A number of each bin, from its owner.
    void share(std::vector<std::uint64_t>& of_bins);

private:
    Team& team_;
    const std::vector<unsigned> owner_;
    std::vector<unsigned> ranks_;  // partners of send_borders()
};

extern template class LevelExchange<std::uint32_t>;
extern template class LevelExchange<std::uint64_t>;

}  // namespace pcm
