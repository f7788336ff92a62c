#include "pcm/build/bins/spool.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace pcm {
namespace {

// Codes of values that are all quotients of the divisor (double_codes.h). False when they are not, or are too large for
// this method.
bool code_quotients(const double* values, std::size_t count, double divisor, std::int64_t* to)
{
    // Adding and subtracting 1.5 * 2^52 rounds a number below 2^51 to an integer.
    constexpr double rounder = 6755399441055744.0, most = 2251799813685248.0;
    std::uint64_t differ = 0;
    bool fits = true;
    for (std::size_t i = 0; i < count; ++i) {
        const double product = values[i] * divisor;
        fits = fits & (product < most) & (product > -most);
        const double code = (product + rounder) - rounder;
        const double back = code / divisor;
        std::uint64_t bits, back_bits;
        std::memcpy(&bits, &values[i], 8);
        std::memcpy(&back_bits, &back, 8);
        differ |= bits ^ back_bits;
    }
    if (!fits || differ) return false;
    for (std::size_t i = 0; i < count; ++i)
        to[i] = static_cast<std::int64_t>((values[i] * divisor + rounder) - rounder);
    return true;
}

}  // namespace

Spool::Spool(const std::filesystem::path& path, const RowLayout& layout, const Schema& schema, bool doubles,
             ScratchSpace& space)
    : file_(path, space), row_bytes_(layout.bytes), doubles_(doubles), packing_(layout, schema, true, doubles)
{
}

Spool::Spool(const std::filesystem::path& path, const RowLayout& layout, const Schema& schema, bool doubles,
             ScratchSpace& space, ByteReader& in)
    : file_(path, space, true),
      row_bytes_(layout.bytes),
      doubles_(doubles),
      packing_(layout, schema, true, doubles),
      kept_(true)
{
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
        Block block{};
        for (std::uint64_t* number : {&block.offset, &block.bytes, &block.rows, &block.checksum})
            *number = in.get<std::uint64_t>();
        for (std::size_t a = 0; a < 3; ++a) {
            block.codes.divisor[a] = in.get<double>();
            block.codes.shift[a] = in.get<std::uint32_t>();
        }
        blocks_.push_back(block);
        rows_ += block.rows;
    }
}

void Spool::save(ByteWriter& out) const
{
    out.put(static_cast<std::uint64_t>(blocks_.size()));
    for (const Block& block : blocks_) {
        for (const std::uint64_t number : {block.offset, block.bytes, block.rows, block.checksum}) out.put(number);
        for (std::size_t a = 0; a < 3; ++a) {
            out.put(block.codes.divisor[a]);
            out.put(block.codes.shift[a]);
        }
    }
}

void Spool::Writer::code_doubles_of(std::byte* rows, std::size_t count, DoubleCodes& codes)
{
    values_.resize(count);
    coded_.resize(count);
    for (std::size_t a = 0; a < 3; ++a) {
        std::byte* first = rows + a * sizeof(double);
        for (std::size_t i = 0; i < count; ++i) std::memcpy(&values_[i], first + i * spool_.row_bytes_, sizeof(double));
        if (divisor_[a] > 0 && code_quotients(values_.data(), count, divisor_[a], coded_.data())) {
            codes.divisor[a] = divisor_[a];
        } else {
            code_doubles(values_.data(), count, a, codes, coded_.data());
            divisor_[a] = codes.divisor[a];
        }
        for (std::size_t i = 0; i < count; ++i)
            std::memcpy(first + i * spool_.row_bytes_, &coded_[i], sizeof(std::int64_t));
    }
}

void Spool::Writer::append(std::byte* rows, std::size_t count)
{
    if (count == 0) return;
    Block block{};
    block.rows = count;
    if (spool_.doubles_) code_doubles_of(rows, count, block.codes);
    packed_.clear();
    spool_.packing_.pack(rows, count, packed_);
    block.bytes = packed_.size();
    block.checksum = checksum(packed_.data(), packed_.size());
    // Whole pages, so that they can be released.
    const std::uint64_t room = (block.bytes + ScratchFile::page - 1) / ScratchFile::page * ScratchFile::page;
    block.offset = spool_.file_.reserve(room);
    spool_.file_.take(room);
    spool_.file_.write_at(packed_.data(), packed_.size(), block.offset);
    const std::lock_guard lock(spool_.mutex_);
    spool_.blocks_.push_back(block);
    spool_.rows_ += count;
}

void Spool::read(std::size_t piece, std::vector<std::byte>& rows) const
{
    const Block& block = blocks_[piece];
    std::vector<std::byte> packed(block.bytes);
    file_.read_at(packed.data(), packed.size(), block.offset);
    if (checksum(packed.data(), packed.size()) != block.checksum) throw scratch_changed(file_.path(), block.offset);
    const std::size_t at = rows.size();
    rows.resize(at + block.rows * row_bytes_);
    std::byte* first = rows.data() + at;
    packing_.unpack(packed.data(), packed.size(), first, block.rows, file_.path());
    if (!doubles_) return;
    constexpr std::size_t step = 512;
    std::array<std::uint64_t, step> codes;
    std::array<double, step> values;
    for (std::size_t from = 0; from < block.rows; from += step) {
        const std::size_t n = std::min<std::size_t>(step, block.rows - from);
        for (std::size_t a = 0; a < 3; ++a) {
            std::byte* axis = first + from * row_bytes_ + a * sizeof(double);
            for (std::size_t i = 0; i < n; ++i) std::memcpy(&codes[i], axis + i * row_bytes_, sizeof(double));
            decode_doubles(block.codes, a, 0, codes.data(), n, values.data());
            for (std::size_t i = 0; i < n; ++i) std::memcpy(axis + i * row_bytes_, &values[i], sizeof(double));
        }
    }
}

void Spool::give_back(std::size_t piece)
{
    const Block& block = blocks_[piece];
    const std::uint64_t room = (block.bytes + ScratchFile::page - 1) / ScratchFile::page * ScratchFile::page;
    file_.give_back(block.offset, room, room);
}

}  // namespace pcm
