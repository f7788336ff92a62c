// Bins in Morton order, each in a file of its own, sorted by the ranks of a team.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/levels/sorted_bins.h"
#include "pcm/cluster/bin_rows.h"
#include "pcm/cluster/team_work.h"

#include <memory>

namespace pcm {

template <class Coord>
class BinFiles {
public:
    BinFiles(const TeamWork& team_work, const Ingested& cloud, std::size_t bins);
    // Bins that have been sorted, as save() wrote them.
    BinFiles(const TeamWork& team_work, const Ingested& cloud, ByteReader& in);

    // Collective: sorts the bins. Then the boxes of all of them are known.
    void sort(const BinRows& rows);
    void save(ByteWriter& out) const;  // the boxes
    // Before the points of a bin are read: finds where they lie. One thread a bin.
    void load(std::size_t bin);
    const SortedBins<Coord>& bins() const { return sorted_; }
    std::size_t count() const { return count_; }
    std::uint64_t rows(std::size_t bin) const { return sorted_.rows(bin); }

private:
    void sort_bin(std::size_t bin, const BinRows& rows);

    const TeamWork& all_;
    const Ingested& cloud_;
    const AxisShift finer_;
    SortedBins<Coord> sorted_;
    const std::size_t count_;
};

extern template class BinFiles<std::uint32_t>;
extern template class BinFiles<std::uint64_t>;

}  // namespace pcm
