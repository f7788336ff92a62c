// Which level each point of a cloud belongs to.
//
// Levels lie on one ladder of spacings for the whole cloud, each half of the one before. The points of levels 0..k
// together are a maximal Poisson-disk sample at the spacing of k: no two of them are nearer, and every input point has
// one of them nearer than that, across the borders of bins too. The last level, the rest, holds all others, with
// spacing 0.
//
// Points can be added to a cloud that has its levels already and keeps them (`GivenLevels`). Then
// - both clouds' levels 0..k together have no two points nearer than the spacing of k, as above;
// - no point of the cloud that was there is as far from them (it has its own);
// - an added point is as far as the spacing only if all levels up to k were barred to it: where a given point of a
// finer level
//   m is nearer than the spacing of m, the added one may come only after m. It is then nearer than 1.5 spacings,
//   because that given point has one of level 0..k near. No choice of levels does without this while the given ones
//   stay.
#pragma once

#include "pcm/build/levels/bin_neighbours.h"
#include "pcm/build/levels/given_levels.h"
#include "pcm/build/levels/level_exchange.h"
#include "pcm/build/levels/levels_of_bins.h"
#include "pcm/build/levels/list_file.h"
#include "pcm/build/levels/sorted_points.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

template <class Coord>
class LevelSampler final : public LevelsOfBins {
public:
    // `points` must not change and must outlive the sampler. `scratch`: the sampler's own file; with Mode::create_new
    // it is removed in the end, otherwise it stays.
    LevelSampler(const SortedPoints<Coord>& points, const Lattice& lattice, Sampling sampling,
                 const std::filesystem::path& scratch, File::Mode mode = File::Mode::create_new);

    // Before run(), which is collective then: other processes sample other bins of the cloud. `points` has the boxes of
    // all bins, and the points of those that this one owns, of which alone levels() may be asked.
    void share(LevelExchange<Coord> exchange) { exchange_.emplace(std::move(exchange)); }

    // Before run(): the points are added to these. Throws Error(invalid_argument) for spacings that are not the
    // lattice's.
    void add_to(GivenLevels<Coord> given);

    // `progress(fraction)` is called now and then on the calling thread and may throw.
    void run(unsigned threads, const std::function<void(double)>& progress);

    // The result of run(); and load() instead of run(), on the same file. load() throws Error(corrupt).
    void save(ByteWriter& out) const;
    void load(ByteReader& in);
    void sync() { file_.sync(); }
    // Size of the sampler's file.
    std::uint64_t bytes() const { return file_.bytes(); }
    // Spacing by level; 0 for the rest. With given levels: theirs, and the rest where they had none and it is needed.
    const std::vector<double>& spacings() const { return spacings_; }
    const std::vector<std::uint64_t>& histogram(std::size_t bin) const override { return bins_[bin].histogram; }
    std::vector<std::uint8_t> levels(std::size_t bin) const override;

private:
    struct List {  // indices that one pass chose; in a sample by grid, their number alone
        int size;
        ListFile::Place place;
    };
    struct Bin {
        std::vector<List> lists;
        std::vector<Point<Coord>> border;  // chosen points, at least those nearer than the spacing to another bin
        std::uint64_t chosen = 0;
        std::vector<std::uint64_t> histogram;
        // Offset in the file of one byte per point, if the bin has these. Poisson: the smallest size that given points
        // bar to the point, as they do all larger ones; 255 for none. Grid, with a given cloud: the point's level.
        std::uint64_t bytes = no_bytes;
    };
    using Found = std::vector<Point<Coord>>;
    static constexpr std::uint64_t no_bytes = ~std::uint64_t(0);

    void run_by_poisson(unsigned threads);
    void run_by_grid(unsigned threads);
    void run_beside_given(unsigned threads);
    int coarsest_size() const;
    void for_each_bin(unsigned threads, const std::function<void(std::size_t)>& work);
    void pass(int size, unsigned threads);
    void pass_in_groups(int size, unsigned threads, const typename BinNeighbours<Coord>::Lists& near);
    void pass_one_by_one(int size);
    void report_pass(std::size_t bins_done);
    bool owns(std::size_t bin) const { return !exchange_ || exchange_->owns(bin); }
    void forget_far_borders(int size, const typename BinNeighbours<Coord>::Lists& near);
    void share_lists(int size);
    // Returns the points that it chooses, ...
    Found sample_bin(std::size_t bin, int size, const std::vector<std::uint32_t>& neighbours);
    std::vector<std::uint32_t> chosen_in(const Bin& bin, std::uint64_t points) const;
    // ... of which it keeps those that are near one of its neighbours, and returns them.
    Found keep_border(std::size_t bin, int size, const std::vector<std::uint32_t>& neighbours, const Found& found);
    void sample_given_bin_by_grid(std::size_t bin);
    void bar_points(std::size_t bin);
    std::vector<Point<Coord>> given_near(std::size_t bin, int size, std::size_t first_level, std::size_t last_level,
                                         typename SortedPoints<Coord>::Reader& points) const;
    bool fine_enough() const;
    void choose_sizes(const std::vector<int>& sizes);
    void count_levels();

    const SortedPoints<Coord>& points_;
    const Lattice lattice_;
    const Sampling sampling_;
    const BinNeighbours<Coord> neighbours_;
    GivenLevels<Coord> given_;
    std::optional<LevelExchange<Coord>> exchange_;  // absent: all bins are this process's
    ListFile file_;
    std::vector<Bin> bins_;
    std::vector<double> spacings_;
    std::vector<int> sizes_;  // cell size of each level but the rest
    std::function<void(double)> progress_;
    double fraction_ = 0;
};

extern template class LevelSampler<std::uint32_t>;
extern template class LevelSampler<std::uint64_t>;

}  // namespace pcm
