// Which bins of a build are near enough that what one of them chooses matters to the other.
#pragma once

#include "pcm/build/levels/sorted_points.h"
#include "pcm/cloud/box_tree.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// Bounds of distances are computed with rounding, and decide only by more than this share of their squares.
inline constexpr double distance_margin = 1e-9;

// Squares of distances between points and the boxes of bins, source units. Any thread.
template <class Coord>
class BinNeighbours {
public:
    // `points` must outlive this and has all bins.
    BinNeighbours(const SortedPoints<Coord>& points, const Lattice& lattice);

    using Box = typename SortedPoints<Coord>::Box;
    double to_nearest(const Point<Coord>& p, const Box& box) const;
    double to_farthest(const Point<Coord>& p, const Box& box) const;
    double between(std::size_t bin, std::size_t other) const;

    // For each bin those that may be nearer to it than the spacing, ascending: other bins with points. Absent where
    // they are more than most_near for each bin on average, as at coarse spacings: lists of all would take memory and
    // time with the square of their number.
    static constexpr std::size_t most_near = 64;
    using Lists = std::vector<std::vector<std::uint32_t>>;
    std::optional<Lists> lists(double spacing) const;

    // All bins with points in groups, so that no two of a group are near each other, as the lists say.
    std::vector<std::vector<std::size_t>> apart(const Lists& lists) const;

    // Some of the bins, to find those that may be nearer to a bin than the spacing. One thread at a time.
    class Subset {
    public:
        explicit Subset(const BinNeighbours& all) : all_(all), boxes_(all.tree_) {}
        void add(std::size_t bin) { boxes_.add(all_.place_[bin]); }  // a bin with points
        std::vector<std::uint32_t> near(std::size_t bin, double spacing) const
        {
            return all_.near(bin, boxes_.touching(all_.reach(bin, spacing)), spacing);
        }

    private:
        const BinNeighbours& all_;
        BoxTree::Subset boxes_;
    };

private:
    Box3d reach(std::size_t bin, double spacing) const;
    std::vector<std::uint32_t> near(std::size_t bin, const std::vector<std::uint32_t>& touching, double spacing) const;

    const SortedPoints<Coord>& points_;
    Vec3d squared_scale_, scale_;
    Point<Coord> origin_{};             // lowest coordinates of all bins
    double rounding_ = 0;               // bound of the rounding errors in boxes_, source units
    std::vector<std::uint32_t> bins_;   // bins with points
    std::vector<std::uint32_t> place_;  // index in bins_, by bin
    std::vector<Box3d> boxes_;          // boxes of bins_, source units from the origin
    BoxTree tree_;                      // holds boxes_
};

extern template class BinNeighbours<std::uint32_t>;
extern template class BinNeighbours<std::uint64_t>;

}  // namespace pcm
