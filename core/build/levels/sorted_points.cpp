#include "pcm/build/levels/sorted_points.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/bpc/column_codec.h"
#include "pcm/build/bins/scratch_file.h"
#include "pcm/system/error.h"

#include <algorithm>

namespace pcm {

template <class Coord>
SortedPoints<Coord>::SortedPoints(const std::filesystem::path& path)
    : file_(path, File::Mode::create_new), remove_(true)
{
}

template <class Coord>
SortedPoints<Coord>::SortedPoints(const std::filesystem::path& path, File::Mode mode)
    : file_(path, mode), remove_(false), end_(file_.size())
{
}

template <class Coord>
SortedPoints<Coord>::SortedPoints(OpenBin open) : open_(std::move(open)), remove_(false)
{
}

template <class Coord>
void SortedPoints<Coord>::save(std::size_t number, ByteWriter& out) const
{
    const Bin& bin = bins_[number];
    out.put(bin.box.points);
    for (const Point<Coord>* p : {&bin.box.low, &bin.box.high})
        for (const Coord c : *p) out.put(c);
    out.put(static_cast<std::uint64_t>(bin.blocks.size()));
    for (const Block& block : bin.blocks) {
        out.put(block.offset);
        out.put(block.bytes);
        out.put(block.check);
        for (const Coord c : block.first) out.put(c);
    }
}

template <class Coord>
void SortedPoints<Coord>::load(std::size_t number, ByteReader& in)
{
    Bin bin;
    bin.box.points = in.get<std::uint64_t>();
    for (Point<Coord>* p : {&bin.box.low, &bin.box.high})
        for (Coord& c : *p) c = in.get<Coord>();
    const auto blocks = in.get<std::uint64_t>();
    for (std::uint64_t b = 0; b < blocks; ++b) {
        Block block{};
        block.offset = in.get<std::uint64_t>();
        block.bytes = in.get<std::uint32_t>();
        block.check = in.get<std::uint32_t>();
        for (Coord& c : block.first) c = in.get<Coord>();
        if (!open_ && (block.offset > end_ || block.bytes > end_ - block.offset))
            throw Error(ErrorCode::corrupt, file_.path(), "a bin's positions lie outside the file");
        bin.blocks.push_back(block);
    }
    if (blocks != (bin.box.points + sorted_block - 1) / sorted_block)
        throw Error(ErrorCode::corrupt, file_.path(), "a bin's positions are not as many as its points");
    bins_[number] = std::move(bin);
}

template <class Coord>
SortedPoints<Coord>::~SortedPoints()
{
    std::error_code ignored;
    if (remove_) std::filesystem::remove(file_.path(), ignored);
}

template <class Coord>
std::vector<std::byte> SortedPoints<Coord>::packed(std::size_t bin, const std::vector<Point<Coord>>& points)
{
    Bin& to = bins_[bin];
    to.box.low = to.box.high = points[0];
    to.box.points = points.size();
    std::vector<std::byte> bytes;
    std::vector<Coord> words;
    for (std::size_t from = 0; from < points.size(); from += sorted_block) {
        const std::size_t count = std::min(sorted_block, points.size() - from);
        const std::size_t start = bytes.size();
        words.resize(count);
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t i = 0; i < count; ++i) {
                const Coord c = points[from + i][a];
                to.box.low[a] = std::min(to.box.low[a], c);
                to.box.high[a] = std::max(to.box.high[a], c);
                words[i] = c;
            }
            pack(words.data(), count, bytes);
        }
        to.blocks.push_back({start, static_cast<std::uint32_t>(bytes.size() - start),
                             static_cast<std::uint32_t>(checksum(bytes.data() + start, bytes.size() - start)),
                             points[from]});
    }
    return bytes;
}

template <class Coord>
std::uint64_t SortedPoints<Coord>::put(std::size_t bin, const std::vector<Point<Coord>>& points)
{
    const std::vector<std::byte> bytes = packed(bin, points);
    std::uint64_t offset;
    {
        const std::lock_guard lock(mutex_);
        offset = end_;
        end_ += bytes.size();
    }
    for (Block& block : bins_[bin].blocks) block.offset += offset;
    file_.write_at(bytes.data(), bytes.size(), offset);
    return bytes.size();
}

template <class Coord>
SortedPoints<Coord>::Reader::Reader(const SortedPoints& store, std::size_t bin)
    : store_(store),
      own_(store.open_ ? store.open_(bin) : File()),
      file_(store.open_ ? own_ : store.file_),
      bin_(bin),
      size_(store.bins_[bin].box.points),
      points_(new Point<Coord>[size_]),
      ready_(store.bins_[bin].blocks.size(), 0)
{
}

template <class Coord>
void SortedPoints<Coord>::Reader::load(std::size_t number)
{
    const Block& block = store_.bins_[bin_].blocks[number];
    bytes_.resize(block.bytes + codec_slack);
    file_.read_at(bytes_.data(), block.bytes, block.offset);
    if (static_cast<std::uint32_t>(checksum(bytes_.data(), block.bytes)) != block.check)
        throw scratch_changed(file_.path(), block.offset);
    const std::size_t first = number * sorted_block;
    const std::size_t count = std::min(sorted_block, size_ - first);
    words_.resize(count);
    std::size_t at = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        at += unpack(bytes_.data() + at, block.bytes - at, words_.data(), count, file_.path());
        for (std::size_t i = 0; i < count; ++i) points_[first + i][a] = words_[i];
    }
    ready_[number] = 1;
}

template <class Coord>
std::size_t SortedPoints<Coord>::Reader::end_of_longer_cell(std::size_t i, std::size_t end,
                                                            const std::array<int, 3>& shifts)
{
    const Point<Coord> p = (*this)[i];
    const std::vector<Block>& blocks = store_.bins_[bin_].blocks;
    // Over whole blocks first: their first points are known without reading them.
    std::size_t block = i / sorted_block + 1, step = 1;
    const std::size_t last = (end + sorted_block - 1) / sorted_block;
    const auto starts_inside = [&](std::size_t b) { return same_cell(p, blocks[b].first, shifts); };
    if (block < last && starts_inside(block)) {
        while (block + step < last && starts_inside(block + step)) {
            block += step;
            step *= 2;
        }
        std::size_t beyond = std::min(last, block + step);
        while (block + 1 < beyond) {
            const std::size_t middle = block + (beyond - block) / 2;
            (starts_inside(middle) ? block : beyond) = middle;
        }
        i = block * sorted_block;
    }
    // Then within one block.
    end = std::min(end, (i / sorted_block + 1) * sorted_block);
    (*this)[i];
    const Point<Coord>* points = points_.get();
    for (step = 1; i + step < end && same_cell(p, points[i + step], shifts); step *= 2) i += step;
    std::size_t beyond = std::min(end, i + step);
    while (i + 1 < beyond) {
        const std::size_t middle = i + (beyond - i) / 2;
        (same_cell(p, points[middle], shifts) ? i : beyond) = middle;
    }
    return beyond;
}

template class SortedPoints<std::uint32_t>;
template class SortedPoints<std::uint64_t>;

}  // namespace pcm
