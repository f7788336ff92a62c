// The bins of a build in Morton order, packed on disk: positions by themselves, for sampling, and the attributes.
#pragma once

#include "pcm/build/bins/row_packing.h"
#include "pcm/build/bins/scratch_file.h"
#include "pcm/build/levels/sorted_points.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace pcm {

template <class Coord>
class SortedBins {
public:
    // Two files in `folder`, which stay. `reopen`: they exist, and load() says where each bin lies.
    SortedBins(const std::filesystem::path& folder, const RowLayout& layout, const Schema& schema, ScratchSpace& space,
               bool reopen);

    // Bins with a file each, which begins with what packed() returned.
    SortedBins(OpenBin open, const RowLayout& layout, const Schema& schema, ScratchSpace& space);

    void resize(std::size_t bins);
    // Where a bin lies, and the reverse. load() throws Error(corrupt) when it does not lie within the files.
    void save(std::size_t bin, ByteWriter& out) const;
    void load(std::size_t bin, ByteReader& in);
    void sync();
    void set_box(std::size_t bin, const typename SortedPoints<Coord>::Box& box) { points_.set_box(bin, box); }
    const SortedPoints<Coord>& points() const { return points_; }
    std::uint64_t rows(std::size_t bin) const { return points_.box(bin).points; }

    // Any thread, each bin once: its rows (at least one) in this order.
    void put(std::size_t bin, const std::vector<std::byte>& rows, const std::vector<std::uint32_t>& order);
    // The bytes that a bin takes, where each has a file of its own; sets its places. As put() otherwise.
    std::vector<std::byte> packed(std::size_t bin, const std::vector<std::byte>& rows,
                                  const std::vector<std::uint32_t>& order);
    // All rows of a bin, in order. Any thread. Throws Error(corrupt) when the bytes have changed
    // since they were written.
    std::vector<std::byte> read(std::size_t bin) const;

private:
    std::vector<std::byte> pack_attributes(std::size_t bin, const std::vector<std::byte>& rows,
                                           const std::vector<std::uint32_t>& order,
                                           std::vector<Point<Coord>>& positions);
    struct Attributes {  // attributes of a bin, where they lie
        std::uint64_t offset = 0, bytes = 0, checksum = 0;
    };
    const RowLayout& layout_;
    const RowPacking packing_;  // packing of attributes only
    ScratchSpace& space_;
    SortedPoints<Coord> points_;
    const OpenBin open_;  // empty: all attributes are in file_
    std::optional<ScratchFile> file_;
    std::vector<Attributes> attributes_;
};

extern template class SortedBins<std::uint32_t>;
extern template class SortedBins<std::uint64_t>;

}  // namespace pcm
