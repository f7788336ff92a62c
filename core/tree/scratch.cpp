#include "tree/scratch.h"

#include <algorithm>
#include <cstring>

namespace pcm {

Scratch::Scratch(const std::filesystem::path& path, std::size_t row_bytes)
    : file_(path, File::Mode::create_new), row_bytes_(row_bytes)
{
}

Scratch::~Scratch()
{
    std::error_code ignored;
    std::filesystem::remove(file_.path(), ignored);
}

std::size_t Scratch::add_bins(std::size_t count)
{
    bins_.resize(bins_.size() + count);
    return bins_.size() - count;
}

void Scratch::append(std::size_t bin, const std::byte* rows, std::size_t count)
{
    if (count == 0) return;
    std::uint64_t offset;
    {
        const std::lock_guard lock(mutex_);
        offset = end_;
        end_ += count * row_bytes_;
        bins_[bin].blocks.push_back({offset, static_cast<std::uint32_t>(count)});
        bins_[bin].rows += count;
    }
    file_.write_at(rows, count * row_bytes_, offset);
}

void Scratch::read_block(std::size_t bin, std::size_t block, std::byte* to) const
{
    const Block& b = bins_[bin].blocks[block];
    file_.read_at(to, b.rows * row_bytes_, b.offset);
}

std::vector<std::byte> Scratch::read(std::size_t bin) const
{
    std::vector<std::byte> rows(bins_[bin].rows * row_bytes_);
    std::size_t at = 0;
    for (std::size_t b = 0; b < bins_[bin].blocks.size(); ++b) {
        read_block(bin, b, rows.data() + at);
        at += bins_[bin].blocks[b].rows * row_bytes_;
    }
    return rows;
}

void Scratch::rewrite(std::size_t bin, const std::byte* rows)
{
    for (const Block& block : bins_[bin].blocks) {
        file_.write_at(rows, block.rows * row_bytes_, block.offset);
        rows += block.rows * row_bytes_;
    }
}

void Scratch::forget(std::size_t bin) { bins_[bin] = Bin(); }

Scratch::Writer::Writer(Scratch& scratch, std::size_t first_bin, std::size_t bins, std::size_t buffer_bytes)
    : scratch_(scratch),
      first_bin_(first_bin),
      rows_each_(std::clamp<std::size_t>(buffer_bytes / (bins * scratch.row_bytes_), 16, 32768)),
      buffer_(bins * rows_each_ * scratch.row_bytes_),
      filled_(bins, 0)
{
}

void Scratch::Writer::add(std::size_t bin, const std::byte* row)
{
    const std::size_t slot = bin - first_bin_;
    std::memcpy(buffer_.data() + (slot * rows_each_ + filled_[slot]) * scratch_.row_bytes_, row, scratch_.row_bytes_);
    if (++filled_[slot] == rows_each_) flush(slot);
}

void Scratch::Writer::flush(std::size_t slot)
{
    scratch_.append(first_bin_ + slot, buffer_.data() + slot * rows_each_ * scratch_.row_bytes_, filled_[slot]);
    filled_[slot] = 0;
}

void Scratch::Writer::flush()
{
    for (std::size_t slot = 0; slot < filled_.size(); ++slot) flush(slot);
}

}  // namespace pcm
