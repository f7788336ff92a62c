// The levels of the points of bins, chosen by the ranks of a team and kept in a file a bin.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/levels/level_sampler.h"
#include "pcm/cluster/sort_jobs.h"
#include "pcm/cluster/team_work.h"

#include <vector>

namespace pcm {

class LevelFiles final : public LevelsOfBins {
public:
    LevelFiles(const TeamWork& team_work, std::size_t bins) : all_(team_work), histograms_(bins), points_(bins) {}

    // Collective.
    template <class Coord>
    void choose(const Ingested& cloud, const TopTree<Coord>& top, BinFiles<Coord>& bins);

    const std::vector<double>& spacings() const { return spacings_; }
    const std::vector<std::uint64_t>& histogram(std::size_t bin) const override { return histograms_[bin]; }
    std::vector<std::uint8_t> levels(std::size_t bin) const override;

private:
    template <class Coord>
    std::vector<std::byte> sample(const Ingested& cloud, const TopTree<Coord>& top, BinFiles<Coord>& bins);

    const TeamWork& all_;
    std::vector<double> spacings_;
    std::vector<std::vector<std::uint64_t>> histograms_;
    std::vector<std::uint64_t> points_;
};

// The owner of each bin: bins that follow one another in the tree have one, and all owners about as many points.
template <class Coord>
std::vector<unsigned> owners_of_bins(const TopTree<Coord>& top, const BinFiles<Coord>& bins, unsigned ranks);

}  // namespace pcm
