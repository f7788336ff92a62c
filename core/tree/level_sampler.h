// Which level each point of a cloud belongs to.
//
// Levels lie on one ladder of spacings for the whole cloud, each half of the one before. The points of levels 0..k together
// are a maximal Poisson-disk sample at the spacing of k: no two of them are nearer, no input point is as far from all of
// them, across the borders of bins too. The last level, the rest, holds all others, with spacing 0.
#pragma once

#include "tree/crew.h"
#include "tree/poisson_pass.h"
#include "tree/sorted_points.h"
#include "tree/tree.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace pcm {

template <class Coord>
class LevelSampler {
public:
    // `points` stays as it is and must outlive the sampler. `scratch`: a file for the sampler's own notes.
    LevelSampler(const SortedPoints<Coord>& points, const Lattice& lattice, Sampling sampling,
                 const std::filesystem::path& scratch);
    ~LevelSampler();

    // `progress(fraction)` is called now and then on the calling thread and may throw.
    void run(unsigned threads, const std::function<void(double)>& progress);

    // Of each level; 0 for the rest.
    const std::vector<double>& spacings() const { return spacings_; }
    // Number of points of each level in a bin.
    const std::vector<std::uint64_t>& histogram(std::size_t bin) const { return bins_[bin].histogram; }
    // Level of every point of a bin, in its order. Any thread.
    std::vector<std::uint8_t> levels(std::size_t bin) const;

private:
    struct List {  // indices that one pass chose
        int size;
        std::uint64_t offset;
        std::uint32_t count;
    };
    struct Bin {
        std::vector<List> lists;
        std::vector<Point<Coord>> border;  // chosen points that are nearer than the spacing to another bin
        std::uint64_t chosen = 0;
        std::vector<std::uint64_t> histogram;
    };

    double squared_distance_to(const Point<Coord>& p, const typename SortedPoints<Coord>::Box& box, bool farthest) const;
    double squared_distance_between(std::size_t bin, std::size_t other) const;
    void pass(int size, unsigned threads);
    void sample_bin(std::size_t bin, int size, const std::vector<std::size_t>& neighbours);
    void sample_by_grid(int top, unsigned threads);
    std::vector<std::uint32_t> read(const List& list) const;
    bool fine_enough() const;
    void number_levels(const std::vector<int>& sizes);

    const SortedPoints<Coord>& points_;
    const Lattice lattice_;
    const Sampling sampling_;
    Vec3d squared_scale_;
    File file_;
    std::mutex mutex_;
    std::uint64_t end_ = 0;
    std::vector<Bin> bins_;
    std::vector<double> spacings_;
    std::vector<int> sizes_;  // of the cells, of each level but the rest
    std::function<void(double)> progress_;
    double fraction_ = 0;
};

extern template class LevelSampler<std::uint32_t>;
extern template class LevelSampler<std::uint64_t>;

}  // namespace pcm
