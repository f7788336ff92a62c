#include "pcm/io/e57/e57_pages.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t pages_in_buffer = 64;

// tables[k][b]: the effect of byte b on the checksum when k more bytes follow; eight bytes are processed at a time.
using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr CrcTables make_crc_tables()
{
    CrcTables tables{};
    for (std::uint32_t b = 0; b < 256; ++b) {
        std::uint32_t crc = b;
        for (int bit = 0; bit < 8; ++bit) crc = crc & 1u ? crc >> 1 ^ 0x82F63B78u : crc >> 1;
        tables[0][b] = crc;
    }
    for (std::uint32_t b = 0; b < 256; ++b)
        for (std::size_t k = 1; k < 8; ++k) tables[k][b] = tables[k - 1][b] >> 8 ^ tables[0][tables[k - 1][b] & 255u];
    return tables;
}

constexpr CrcTables crc_tables = make_crc_tables();

std::string hexadecimal(std::uint32_t value)
{
    static constexpr char digits[] = "0123456789abcdef";
    std::string text = "0x";
    for (int shift = 28; shift >= 0; shift -= 4) text += digits[value >> shift & 15u];
    return text;
}

}  // namespace

std::uint32_t crc32c(const std::byte* bytes, std::size_t count)
{
    std::uint32_t crc = ~0u;
    for (; count >= 8; bytes += 8, count -= 8) {
        std::array<std::uint8_t, 8> b;
        std::memcpy(b.data(), bytes, 8);
        for (std::size_t i = 0; i < 4; ++i) b[i] = static_cast<std::uint8_t>(b[i] ^ crc >> 8 * i);
        crc = 0;
        for (std::size_t i = 0; i < 8; ++i) crc ^= crc_tables[7 - i][b[i]];
    }
    for (; count; ++bytes, --count) crc = crc_tables[0][(crc ^ static_cast<std::uint32_t>(*bytes)) & 255u] ^ crc >> 8;
    return ~crc;
}

E57Pages::E57Pages(const std::filesystem::path& path) : file_(path, File::Mode::read)
{
    const std::uint64_t size = file_.size();
    pages_ = size / page_bytes;
    if (size == 0 || size % page_bytes)
        throw Error(ErrorCode::truncated, path,
                    "the file has " + std::to_string(size) + " bytes; an E57 file is a multiple of 1024 bytes");
}

std::uint64_t E57Pages::to_logical(std::uint64_t physical) const
{
    const std::uint64_t page = physical / page_bytes, inside = physical % page_bytes;
    return page < pages_ && inside < content_bytes ? page * content_bytes + inside : logical_size();
}

const std::byte* E57Pages::content_of(std::uint64_t page)
{
    if (page < first_in_buffer_ || page >= first_in_buffer_ + checked_.size()) {
        const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(pages_in_buffer, pages_ - page));
        buffer_.resize(count * page_bytes);
        checked_.clear();
        file_.read_at(buffer_.data(), buffer_.size(), page * page_bytes);
        checked_.assign(count, false);
        first_in_buffer_ = page;
    }
    const auto i = static_cast<std::size_t>(page - first_in_buffer_);
    const std::byte* content = buffer_.data() + i * page_bytes;
    if (!checked_[i]) {
        std::uint32_t stored = 0;  // the one number of the format that is big endian
        for (std::size_t k = 0; k < 4; ++k)
            stored = stored << 8 | static_cast<std::uint32_t>(content[content_bytes + k]);
        const std::uint32_t computed = crc32c(content, content_bytes);
        if (stored != computed)
            throw Error(ErrorCode::corrupt, file_.path(),
                        "page " + std::to_string(page) + ", from byte " + std::to_string(page * page_bytes) +
                            ": the checksum is " + hexadecimal(stored) + ", the content has " + hexadecimal(computed),
                        "the file is damaged: copy it again from its source");
        checked_[i] = true;
    }
    return content;
}

void E57Pages::read(void* to, std::size_t bytes, std::uint64_t logical)
{
    if (logical > logical_size() || bytes > logical_size() - logical)
        throw Error(ErrorCode::truncated, file_.path(),
                    "the file ends at byte " + std::to_string(physical_size()) + "; " + std::to_string(bytes) +
                        " bytes of content were expected from byte " + std::to_string(to_physical(logical)));
    auto* out = static_cast<std::byte*>(to);
    while (bytes) {
        const auto inside = static_cast<std::size_t>(logical % content_bytes);
        const std::size_t now = std::min(bytes, content_bytes - inside);
        std::memcpy(out, content_of(logical / content_bytes) + inside, now);
        out += now;
        logical += now;
        bytes -= now;
    }
}

}  // namespace pcm
