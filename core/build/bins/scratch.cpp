#include "pcm/build/bins/scratch.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace pcm {
namespace {

constexpr std::uint32_t extent_bytes = 1u << 18;
constexpr std::size_t most_unpacked =
    16 * std::size_t(extent_bytes);  // bytes of an extent's rows: equal rows take almost no packed bytes

// Before each packed block.
struct BlockHeader {
    std::uint32_t bytes = 0;  // size of the packed rows
    std::uint32_t rows = 0;
    std::uint64_t checksum = 0;  // checksum of the packed rows
};

std::uint64_t pages(std::uint64_t bytes)
{
    return (bytes + ScratchFile::page - 1) / ScratchFile::page * ScratchFile::page;
}

// Orders rows by the cells of a grid of 8 x 8 x 8 over their box, so that most neighbours in space are near in order.
// Packed blocks of neighbours are smaller, and the later sort has better locality.
template <class Coord>
void order_by_cells(const std::byte* rows, std::size_t count, std::size_t row_bytes, Scratch::Work& work)
{
    std::array<Coord, 3> low = coordinates_of<Coord>(rows), high = low;
    for (std::size_t i = 1; i < count; ++i) {
        const auto c = coordinates_of<Coord>(rows + i * row_bytes);
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], c[a]);
            high[a] = std::max(high[a], c[a]);
        }
    }
    Coord extent = 0;
    for (std::size_t a = 0; a < 3; ++a) extent = std::max(extent, static_cast<Coord>(high[a] - low[a]));
    int shift = 0;
    while (extent >> shift >= 8) ++shift;
    work.cells.resize(count);
    work.order.resize(count);
    std::array<std::uint32_t, 513> start{};
    for (std::size_t i = 0; i < count; ++i) {
        const auto c = coordinates_of<Coord>(rows + i * row_bytes);
        const auto cell = static_cast<std::uint16_t>((c[0] - low[0]) >> shift | ((c[1] - low[1]) >> shift) << 3 |
                                                     ((c[2] - low[2]) >> shift) << 6);
        work.cells[i] = cell;
        ++start[cell + 1u];
    }
    for (std::size_t cell = 0; cell < 512; ++cell) start[cell + 1] += start[cell];
    for (std::size_t i = 0; i < count; ++i) work.order[start[work.cells[i]]++] = static_cast<std::uint32_t>(i);
}

}  // namespace

Scratch::Scratch(const std::filesystem::path& path, const RowLayout& layout, const Schema& schema, ScratchSpace& space)
    : file_(path, space),
      row_bytes_(layout.bytes),
      coordinate_bytes_(layout.coordinate_bytes),
      packing_(layout, schema, true)
{
}

Scratch::Scratch(const std::filesystem::path& path, const RowLayout& layout, const Schema& schema, ScratchSpace& space,
                 ByteReader& in)
    : file_(path, space, true),
      row_bytes_(layout.bytes),
      coordinate_bytes_(layout.coordinate_bytes),
      packing_(layout, schema, true)
{
    const auto bins = in.get<std::uint64_t>();
    for (std::uint64_t b = 0; b < bins; ++b) {
        Bin& bin = bins_.emplace_back();
        bin.rows = in.get<std::uint64_t>();
        const auto extents = in.get<std::uint64_t>();
        for (std::uint64_t e = 0; e < extents; ++e) {
            Extent extent{};
            extent.offset = in.get<std::uint64_t>();
            extent.room = in.get<std::uint32_t>();
            extent.used = in.get<std::uint32_t>();
            extent.rows = in.get<std::uint32_t>();
            bin.extents.push_back(extent);
        }
    }
}

void Scratch::save(ByteWriter& out) const
{
    out.put(static_cast<std::uint64_t>(bins_.size()));
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) save(bin, out);
}

void Scratch::save(std::size_t number, ByteWriter& out) const
{
    const Bin& bin = bins_[number];
    out.put(bin.rows);
    out.put(static_cast<std::uint64_t>(bin.extents.size()));
    for (const Extent& extent : bin.extents) {
        out.put(extent.offset);
        out.put(extent.room);
        out.put(extent.used);
        out.put(extent.rows);
    }
}

std::size_t Scratch::add_bins(std::size_t count)
{
    bins_.resize(bins_.size() + count);
    return bins_.size() - count;
}

void Scratch::append(std::size_t bin, const std::byte* rows, std::size_t count, Work& work)
{
    // A limited number of bytes at a time, however wide the rows are: lengths have 32 bits.
    const std::size_t most = std::max<std::size_t>(1, (std::size_t(64) << 20) / row_bytes_);
    for (; count > most; count -= most, rows += most * row_bytes_) append(bin, rows, most, work);
    if (count == 0) return;
    std::vector<std::byte>& packed = work.packed;
    packed.resize(sizeof(BlockHeader));
    if (count <= RowPacking::block_rows) {
        packing_.pack(rows, count, packed);
    } else {
        if (coordinate_bytes_ == sizeof(std::uint32_t))
            order_by_cells<std::uint32_t>(rows, count, row_bytes_, work);
        else
            order_by_cells<std::uint64_t>(rows, count, row_bytes_, work);
        packing_.pack(rows, work.order.data(), count, packed);
    }
    BlockHeader header;
    header.bytes = static_cast<std::uint32_t>(packed.size() - sizeof header);
    header.rows = static_cast<std::uint32_t>(count);
    header.checksum = checksum(packed.data() + sizeof header, header.bytes);
    std::memcpy(packed.data(), &header, sizeof header);
    const auto bytes = static_cast<std::uint32_t>(packed.size());
    std::uint64_t offset, more_pages;
    {
        const std::lock_guard lock(mutex_);
        Bin& to = bins_[bin];
        if (to.extents.empty() || to.extents.back().room - to.extents.back().used < bytes ||
            (to.extents.back().rows + count) * row_bytes_ > most_unpacked) {
            // The unused end of an extent is a hole in the file.
            const auto room = static_cast<std::uint32_t>(std::max<std::uint64_t>(extent_bytes, pages(bytes)));
            to.extents.push_back({file_.reserve(room), room, 0, 0});
        }
        Extent& extent = to.extents.back();
        offset = extent.offset + extent.used;
        more_pages = pages(extent.used + bytes) - pages(extent.used);
        extent.used += bytes;
        extent.rows += header.rows;
        to.rows += count;
    }
    file_.take(more_pages);
    file_.write_at(packed.data(), packed.size(), offset);
}

void Scratch::read(std::size_t bin, std::size_t number, std::vector<std::byte>& rows) const
{
    const Extent& extent = bins_[bin].extents[number];
    std::vector<std::byte> packed(extent.used);
    file_.read_at(packed.data(), packed.size(), extent.offset);
    std::size_t to = rows.size();
    const std::size_t end = to + extent.rows * row_bytes_;
    rows.resize(end);
    for (std::size_t at = 0; at < packed.size();) {
        BlockHeader header;
        const bool whole = packed.size() - at >= sizeof header;
        if (whole) std::memcpy(&header, packed.data() + at, sizeof header);
        at += sizeof header;
        if (!whole || header.bytes > packed.size() - at || header.rows > (end - to) / row_bytes_ ||
            checksum(packed.data() + at, header.bytes) != header.checksum)
            throw scratch_changed(file_.path(), extent.offset + at);
        packing_.unpack(packed.data() + at, header.bytes, rows.data() + to, header.rows, file_.path());
        at += header.bytes;
        to += header.rows * row_bytes_;
    }
    if (to != end)
        throw Error(ErrorCode::corrupt, file_.path(), "rows are missing", "the disk may be failing; build again");
}

std::vector<std::byte> Scratch::read(std::size_t bin) const
{
    std::vector<std::byte> rows;
    rows.reserve(bins_[bin].rows * row_bytes_);
    for (std::size_t extent = 0; extent < extents(bin); ++extent) read(bin, extent, rows);
    return rows;
}

void Scratch::give_back(std::size_t bin, std::size_t number)
{
    const Extent& extent = bins_[bin].extents[number];
    file_.give_back(extent.offset, extent.room, pages(extent.used));
}

void Scratch::give_back(std::size_t bin)
{
    for (std::size_t extent = 0; extent < extents(bin); ++extent) give_back(bin, extent);
}

bool Scratch::can_hold(std::size_t bin) const
{
    for (const Extent& extent : bins_[bin].extents)
        if (extent.used > extent.room || extent.offset > file_.bytes() || extent.used > file_.bytes() - extent.offset)
            return false;
    return true;
}

void Scratch::forget(std::size_t bin) { bins_[bin] = Bin(); }

Scratch::Writer::Writer(Scratch& scratch, std::size_t first_bin, std::size_t bins, std::size_t buffer_bytes,
                        std::vector<std::byte> buffer)
    : scratch_(scratch),
      first_bin_(first_bin),
      rows_each_(std::clamp<std::size_t>(buffer_bytes / (bins * scratch.row_bytes_), 16, 4096)),
      buffer_(std::move(buffer)),
      filled_(bins, 0)
{
    buffer_.resize(bins * rows_each_ * scratch.row_bytes_);
}

void Scratch::Writer::add(std::size_t bin, const std::byte* row)
{
    const std::size_t slot = bin - first_bin_;
    copy_row(buffer_.data() + (slot * rows_each_ + filled_[slot]) * scratch_.row_bytes_, row, scratch_.row_bytes_);
    if (++filled_[slot] == rows_each_) flush(slot);
}

void Scratch::Writer::add(const std::uint32_t* bins, const std::byte* rows, std::size_t count)
{
    constexpr std::size_t ahead = 16;  // places on their way to the cache
    for (std::size_t i = 0; i < count; ++i) {
        if (i + ahead < count) {
            const std::size_t slot = bins[i + ahead] - first_bin_;
            __builtin_prefetch(buffer_.data() + (slot * rows_each_ + filled_[slot]) * scratch_.row_bytes_, 1);
        }
        add(bins[i], rows + i * scratch_.row_bytes_);
    }
}

void Scratch::Writer::flush(std::size_t slot)
{
    scratch_.append(first_bin_ + slot, buffer_.data() + slot * rows_each_ * scratch_.row_bytes_, filled_[slot], work_);
    filled_[slot] = 0;
}

void Scratch::Writer::flush()
{
    for (std::size_t slot = 0; slot < filled_.size(); ++slot) flush(slot);
}

}  // namespace pcm
