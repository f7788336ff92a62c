#include "pcm/build/levels/sorted_bins.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cstring>

namespace pcm {

template <class Coord>
SortedBins<Coord>::SortedBins(const std::filesystem::path& folder, const RowLayout& layout, const Schema& schema,
                              ScratchSpace& space, bool reopen)
    : layout_(layout),
      packing_(layout, schema, false),
      space_(space),
      points_(folder / "points.tmp", reopen ? File::Mode::change : File::Mode::create_or_truncate),
      file_(std::in_place, folder / "attributes.tmp", space, reopen)
{
    space_.take(points_.bytes());
}

template <class Coord>
SortedBins<Coord>::SortedBins(OpenBin open, const RowLayout& layout, const Schema& schema, ScratchSpace& space)
    : layout_(layout), packing_(layout, schema, false), space_(space), points_(open), open_(open)
{
}

template <class Coord>
void SortedBins<Coord>::save(std::size_t bin, ByteWriter& out) const
{
    points_.save(bin, out);
    out.put(attributes_[bin].offset);
    out.put(attributes_[bin].bytes);
    out.put(attributes_[bin].checksum);
}

template <class Coord>
void SortedBins<Coord>::load(std::size_t bin, ByteReader& in)
{
    points_.load(bin, in);
    Attributes& to = attributes_[bin];
    to.offset = in.get<std::uint64_t>();
    to.bytes = in.get<std::uint64_t>();
    to.checksum = in.get<std::uint64_t>();
    if (file_ && (to.offset > file_->bytes() || to.bytes > file_->bytes() - to.offset))
        throw Error(ErrorCode::corrupt, file_->path(), "a bin's attributes lie outside the file");
}

template <class Coord>
void SortedBins<Coord>::sync()
{
    points_.sync();
    file_->sync();
}

template <class Coord>
void SortedBins<Coord>::resize(std::size_t bins)
{
    points_.resize(bins);
    attributes_.resize(bins);
}

template <class Coord>
std::vector<std::byte> SortedBins<Coord>::pack_attributes(std::size_t bin, const std::vector<std::byte>& rows,
                                                          const std::vector<std::uint32_t>& order,
                                                          std::vector<Point<Coord>>& positions)
{
    std::vector<std::byte> packed;
    positions.resize(order.size());
    std::vector<std::byte> block(RowPacking::block_rows * layout_.bytes);
    for (std::size_t from = 0; from < order.size(); from += RowPacking::block_rows) {
        const std::size_t count = std::min(RowPacking::block_rows, order.size() - from);
        gather_rows(rows.data(), order.data() + from, count, layout_.bytes, block.data());
        if (layout_.bytes > 3 * sizeof(Coord)) packing_.pack(block.data(), count, packed);
        for (std::size_t i = 0; i < count; ++i)
            positions[from + i] = coordinates_of<Coord>(block.data() + i * layout_.bytes);
    }
    Attributes& to = attributes_[bin];
    to.bytes = packed.size();
    to.checksum = checksum(packed.data(), packed.size());
    return packed;
}

template <class Coord>
void SortedBins<Coord>::put(std::size_t bin, const std::vector<std::byte>& rows,
                            const std::vector<std::uint32_t>& order)
{
    std::vector<Point<Coord>> positions;
    std::vector<std::byte> packed = pack_attributes(bin, rows, order, positions);
    Attributes& to = attributes_[bin];
    to.offset = file_->reserve(to.bytes);
    file_->take(to.bytes);
    file_->write_at(packed.data(), packed.size(), to.offset);
    packed = {};
    space_.take(points_.put(bin, positions));
}

template <class Coord>
std::vector<std::byte> SortedBins<Coord>::packed(std::size_t bin, const std::vector<std::byte>& rows,
                                                 const std::vector<std::uint32_t>& order)
{
    std::vector<Point<Coord>> positions;
    const std::vector<std::byte> attributes = pack_attributes(bin, rows, order, positions);
    std::vector<std::byte> all = points_.packed(bin, positions);
    attributes_[bin].offset = all.size();
    all.insert(all.end(), attributes.begin(), attributes.end());
    space_.take(all.size());
    return all;
}

template <class Coord>
std::vector<std::byte> SortedBins<Coord>::read(std::size_t bin) const
{
    const Attributes& from = attributes_[bin];
    std::vector<std::byte> packed(from.bytes);
    const File own = open_ ? open_(bin) : File();
    const std::filesystem::path path = open_ ? own.path() : file_->path();
    if (open_)
        own.read_at(packed.data(), packed.size(), from.offset);
    else
        file_->read_at(packed.data(), packed.size(), from.offset);
    if (checksum(packed.data(), packed.size()) != from.checksum) throw scratch_changed(path, from.offset);
    const std::size_t count = rows(bin);
    std::vector<std::byte> all(count * layout_.bytes);
    if (layout_.bytes > 3 * sizeof(Coord)) packing_.unpack(packed.data(), packed.size(), all.data(), count, path);
    typename SortedPoints<Coord>::Reader positions(points_, bin);
    for (std::size_t i = 0; i < count; ++i) {
        const Point<Coord> p = positions[i];
        std::memcpy(all.data() + i * layout_.bytes, p.data(), sizeof p);
    }
    return all;
}

template class SortedBins<std::uint32_t>;
template class SortedBins<std::uint64_t>;

}  // namespace pcm
