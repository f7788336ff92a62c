#include "pcm/build/bins/divide_bins.h"

#include "pcm/bpc/checksum.h"
#include "pcm/build/bins/distribute.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <vector>

namespace pcm {
namespace {

template <class Coord>
class BinDivision {
public:
    BinDivision(Bins<Coord>& bins, Workspace& work, const AxisShift& finer, std::uint64_t bin_points)
        : top_(bins.top), scratch_(*bins.scratch), work_(work), finer_(finer), bin_points_(bin_points)
    {
    }

    std::vector<Division> run()
    {
        for (std::uint32_t n = 0; n < top_.nodes.size(); ++n) {  // new nodes are appended and visited too
            if (top_.nodes[n].children[0] || !is_large_bin(scratch_.rows(top_.nodes[n].bin), bin_points_)) continue;
            const Division division{n, static_cast<std::uint32_t>(top_.nodes.size()), scratch_.bins()};
            divide(n);
            if (top_.nodes[n].children[0]) divisions_.push_back(division);
        }
        return std::move(divisions_);
    }

private:
    void divide(std::uint32_t n)
    {
        const std::size_t bin = top_.nodes[n].bin, first = scratch_.bins();
        auto sample = sample_of(bin);
        const std::size_t bins =
            TopPlanner<Coord>(top_, finer_, bin_points_).plan(n, sample, scratch_.rows(bin), first);
        if (bins == 1) {
            top_.nodes[n].bin = bin;
            return divide_pile(n);
        }
        scratch_.add_bins(bins);
        move_rows(bin, first, bins, [&](const std::byte* row) { return top_.bin_of(coordinates_of<Coord>(row), n); });
    }

    // Rows lie in the order in which threads wrote them; a sample by the rows' hashes is the same whatever the order.
    typename TopPlanner<Coord>::Sample sample_of(std::size_t bin) const
    {
        typename TopPlanner<Coord>::Sample sample;
        const std::uint64_t keep_one_in = std::max<std::uint64_t>(1, scratch_.rows(bin) / 100000);
        std::vector<std::byte> rows;
        for (std::size_t e = 0; e < scratch_.extents(bin); ++e) {
            rows.clear();
            scratch_.read(bin, e, rows);
            for (std::size_t at = 0; at < rows.size(); at += scratch_.row_bytes())
                if (checksum(rows.data() + at, scratch_.row_bytes()) % keep_one_in == 0)
                    sample.push_back(coordinates_of<Coord>(rows.data() + at));
        }
        return sample;
    }

    // All rows of a bin to bins [first, first + bins), each to the one that bin_of(row) says.
    template <class BinOf>
    void move_rows(std::size_t bin, std::size_t first, std::size_t bins, const BinOf& bin_of)
    {
        distribute(
            work_, scratch_.extents(bin),
            [&](std::size_t e, std::vector<std::byte>& rows) { scratch_.read(bin, e, rows); },
            [&](std::size_t e) { scratch_.give_back(bin, e); }, scratch_.row_bytes(), scratch_, first, bins,
            [&](unsigned, const std::byte* row, Scratch::Writer& writer) { writer.add(bin_of(row), row); });
        scratch_.forget(bin);
    }

    // Divides the bin of node `n`, most of whose points lie in one place, into bins that overlap: by the rows' hashes,
    // or, where all rows are the same, in turn.
    void divide_pile(std::uint32_t n)
    {
        constexpr unsigned most_rounds = 16;  // each leaves few rows in addition to those that are often the same
        const std::size_t row_bytes = scratch_.row_bytes(), bin = top_.nodes[n].bin;
        rounds_.resize(top_.nodes.size());
        const unsigned round = rounds_[n] + 1;
        if (round > most_rounds) return;
        int bits = 1;
        while (scratch_.rows(bin) >> bits > bin_points_) ++bits;
        const bool same = all_rows_are_the_same(bin);
        const std::size_t bins = std::size_t(1) << bits, first = scratch_.add_bins(bins);
        std::atomic<std::uint64_t> turn{0};
        // Odd multiples, another one each round: rows that one round leaves together are parted by the next.
        const std::uint64_t multiple = 0x9e3779b97f4a7c15u + 2 * std::uint64_t(round);
        move_rows(bin, first, bins, [&](const std::byte* row) {
            const std::uint64_t hash = checksum(row, row_bytes) * multiple;
            return first + (same ? turn++ % bins : hash >> (64 - bits));
        });
        add_leaves(n, first, bins, round);
    }

    bool all_rows_are_the_same(std::size_t bin) const
    {
        const std::size_t row_bytes = scratch_.row_bytes();
        std::vector<std::byte> rows, model;
        for (std::size_t e = 0; e < scratch_.extents(bin); ++e) {
            rows.clear();
            scratch_.read(bin, e, rows);
            if (model.empty()) model.assign(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(row_bytes));
            for (std::size_t at = 0; at < rows.size(); at += row_bytes)
                if (std::memcmp(rows.data() + at, model.data(), row_bytes) != 0) return false;
        }
        return true;
    }

    // A balanced subtree under node `n`, whose leaves are the bins; `bins` is a power of two.
    void add_leaves(std::uint32_t n, std::size_t first, std::size_t bins, unsigned round)
    {
        auto& nodes = top_.nodes;
        std::vector<std::uint32_t> leaves{n};
        while (leaves.size() < bins) {
            std::vector<std::uint32_t> below;
            for (const std::uint32_t parent : leaves) {
                const auto child = static_cast<std::uint32_t>(nodes.size());
                nodes.resize(nodes.size() + 2);
                nodes[parent].children = {child, child + 1};
                below.insert(below.end(), {child, child + 1});
            }
            leaves = std::move(below);
        }
        rounds_.resize(nodes.size());
        for (std::size_t k = 0; k < bins; ++k) {
            nodes[leaves[k]].bin = first + k;
            rounds_[leaves[k]] = round;
        }
    }

    TopTree<Coord>& top_;
    Scratch& scratch_;
    Workspace& work_;
    const AxisShift& finer_;
    const std::uint64_t bin_points_;
    std::vector<unsigned> rounds_;  // number of divided piles above each node
    std::vector<Division> divisions_;
};

}  // namespace

template <class Coord>
std::vector<Division> divide_large_bins(Bins<Coord>& bins, Workspace& work, const AxisShift& finer,
                                        std::uint64_t bin_points)
{
    return BinDivision<Coord>(bins, work, finer, bin_points).run();
}

template std::vector<Division> divide_large_bins(Bins<std::uint32_t>&, Workspace&, const AxisShift&, std::uint64_t);
template std::vector<Division> divide_large_bins(Bins<std::uint64_t>&, Workspace&, const AxisShift&, std::uint64_t);

}  // namespace pcm
