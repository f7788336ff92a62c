#include "pcm/io/las/las_header.h"

#include "pcm/io/file_text.h"
#include "pcm/io/las/las_layout.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

namespace pcm::las {
namespace {

namespace at = header;

// Metadata is kept in memory; waveforms, which can be many gigabytes in one EVLR, are not.
constexpr std::uint64_t max_metadata_bytes = std::uint64_t{64} << 20;
constexpr std::size_t max_notes = 100;

class HeaderReader {
public:
    HeaderReader(const File& file, std::uint64_t file_size, std::vector<std::string>& notes)
        : file_(file), file_size_(file_size), notes_(notes)
    {
    }

    Header read()
    {
        std::array<std::byte, at::size_1_5> bytes{};
        const std::size_t got = file_.read_some_at(bytes.data(), bytes.size(), 0);
        check_start(bytes.data(), got);
        check_sizes(bytes.data(), got);
        read_counts(bytes.data());
        if (!h_.compressed) check_bytes_hold_the_points();
        read_grid(bytes.data());
        h_.raw.resize(h_.header_size);
        file_.read_at(h_.raw.data(), h_.raw.size(), 0);
        return std::move(h_);
    }

private:
    [[noreturn]] void fail(ErrorCode code, const std::string& what, const std::string& hint = {}) const
    {
        throw Error(code, file_.path(), what, hint);
    }

    void check_start(const std::byte* bytes, std::size_t got);
    void check_sizes(const std::byte* bytes, std::size_t got);
    void read_counts(const std::byte* bytes);
    void check_bytes_hold_the_points();
    void read_grid(const std::byte* bytes);

    const File& file_;
    std::uint64_t file_size_;
    std::vector<std::string>& notes_;
    Header h_;
};

void HeaderReader::check_start(const std::byte* bytes, std::size_t got)
{
    if (got < 4 || std::memcmp(bytes, "LASF", 4) != 0)
        fail(ErrorCode::bad_format, "not a LAS file: it does not begin with 'LASF'");
    if (got < at::size_1_0)
        fail(ErrorCode::truncated,
             "the file ends at byte " + std::to_string(got) + " within the LAS header, which has at least 227 bytes");

    const auto version_major = load<std::uint8_t>(bytes + at::version_major);
    h_.version_minor = load<std::uint8_t>(bytes + at::version_minor);
    if (version_major != 1 || h_.version_minor > 5)
        fail(ErrorCode::unsupported, "LAS version " + std::to_string(version_major) + "." +
                                         std::to_string(h_.version_minor) + " found; 1.0 to 1.5 can be read");
    const std::string version = "LAS 1." + std::to_string(h_.version_minor);

    const auto format_byte = load<std::uint8_t>(bytes + at::point_format);
    h_.compressed = format_byte & 0xC0u;
    h_.format = format_byte & 0x3Fu;
    if (h_.format >= format_count)
        fail(ErrorCode::unsupported, "LAS point format " + std::to_string(h_.format) + " found; 0 to 10 can be read");
    const unsigned format_since = first_minor(h_.format);
    if (h_.version_minor >= 5 && !is_extended(h_.format))
        add_note(notes_, "point format " + std::to_string(h_.format) +
                             " is not part of LAS 1.5, which has 6 to 10; read as in LAS 1.4");
    if (h_.version_minor < format_since)
        add_note(notes_, "point format " + std::to_string(h_.format) + " is not part of " + version +
                             "; read as in LAS 1." + std::to_string(format_since));
}

void HeaderReader::check_sizes(const std::byte* bytes, std::size_t got)
{
    h_.header_size = load<std::uint16_t>(bytes + at::header_size);
    const std::size_t least_header = h_.version_minor >= 5   ? at::size_1_5
                                     : h_.version_minor >= 4 ? at::size_1_4
                                                             : at::size_1_0;
    if (h_.header_size < least_header)
        fail(ErrorCode::bad_format, "the header states a size of " + std::to_string(h_.header_size) + " bytes; LAS 1." +
                                        std::to_string(h_.version_minor) + " has at least " +
                                        std::to_string(least_header));
    if (h_.header_size > file_size_ || got < least_header)
        fail(ErrorCode::truncated, "the header has " + std::to_string(h_.header_size) + " bytes, the file only " +
                                       std::to_string(file_size_));

    h_.point_offset = load<std::uint32_t>(bytes + at::point_offset);
    if (h_.point_offset < h_.header_size)
        fail(ErrorCode::bad_format, "the header places the points at byte " + std::to_string(h_.point_offset) +
                                        ", inside the header of " + std::to_string(h_.header_size) + " bytes");
    if (h_.point_offset > file_size_)
        fail(ErrorCode::truncated, "the header places the points at byte " + std::to_string(h_.point_offset) +
                                       ", the file ends at byte " + std::to_string(file_size_));

    h_.record_length = load<std::uint16_t>(bytes + at::record_length);
    if (h_.record_length < record_bytes[h_.format])
        fail(ErrorCode::bad_format, "the header states " + std::to_string(h_.record_length) +
                                        " bytes per point; point format " + std::to_string(h_.format) +
                                        " has at least " + std::to_string(record_bytes[h_.format]));
}

void HeaderReader::read_counts(const std::byte* bytes)
{
    h_.vlr_count = load<std::uint32_t>(bytes + at::vlr_count);
    h_.points = load<std::uint32_t>(bytes + at::point_count_32);
    if (h_.version_minor < 4) return;
    const auto count = load<std::uint64_t>(bytes + at::point_count_64);
    if (count && h_.points && count != h_.points)
        add_note(notes_, "the header has two point counts, " + std::to_string(h_.points) + " and " +
                             std::to_string(count) + "; the second, of LAS 1.4, is used");
    if (count) h_.points = count;
    h_.evlr_start = load<std::uint64_t>(bytes + at::evlr_start);
    h_.evlr_count = load<std::uint32_t>(bytes + at::evlr_count);
}

void HeaderReader::check_bytes_hold_the_points()
{
    const std::uint64_t available = file_size_ - h_.point_offset;
    const std::uint64_t complete = available / h_.record_length;
    if (h_.points > complete)
        fail(ErrorCode::truncated, "the header promises " + std::to_string(h_.points) + " points of " +
                                       std::to_string(h_.record_length) + " bytes from byte " +
                                       std::to_string(h_.point_offset) + "; the file ends at byte " +
                                       std::to_string(file_size_) + " and holds " + std::to_string(complete));
    // Since LAS 1.3 waveforms and EVLRs may follow the points.
    const std::uint64_t left = available - h_.points * h_.record_length;
    if (left && h_.version_minor < 3)
        add_note(notes_, std::to_string(left) + " bytes after the last point are ignored");
}

void HeaderReader::read_grid(const std::byte* bytes)
{
    Box3d box;
    bool box_is_finite = true;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::string axis(1, "xyz"[a]);
        h_.grid.scale[a] = load<double>(bytes + at::scale + 8 * a);
        h_.grid.offset[a] = load<double>(bytes + at::offset + 8 * a);
        if (!(h_.grid.scale[a] > 0) || !std::isfinite(h_.grid.scale[a]))
            fail(ErrorCode::bad_format, "the scale of " + axis + " is " + std::to_string(h_.grid.scale[a]) +
                                            "; a positive number was expected");
        if (!std::isfinite(h_.grid.offset[a]))
            fail(ErrorCode::bad_format, "the offset of " + axis + " is " + std::to_string(h_.grid.offset[a]) +
                                            "; a finite number was expected");
        box.max[a] = load<double>(bytes + at::box + 16 * a);
        box.min[a] = load<double>(bytes + at::box + 16 * a + 8);
        box_is_finite = box_is_finite && std::isfinite(box.min[a]) && std::isfinite(box.max[a]);
    }
    if (h_.points && box_is_finite && !box.empty()) h_.box = box;
}

class VlrReader {
public:
    VlrReader(const File& file, std::uint64_t file_size, const Header& header, std::vector<std::string>& notes)
        : file_(file), file_size_(file_size), header_(header), notes_(notes)
    {
    }

    std::vector<Vlr> read()
    {
        read_list(header_.header_size, header_.vlr_count, header_.point_offset, false);
        // In LAZ only the chunks know where the points end.
        const std::uint64_t points_end =
            header_.point_offset + (header_.compressed ? 0 : header_.points * header_.record_length);
        if (header_.evlr_count && header_.evlr_start < points_end)
            add_note(notes_, "the header places the extended VLRs at byte " + std::to_string(header_.evlr_start) +
                                 ", before the end of the points at byte " + std::to_string(points_end) +
                                 "; they are ignored");
        else
            read_list(header_.evlr_start, header_.evlr_count, file_size_, true);
        return std::move(vlrs_);
    }

private:
    void read_list(std::uint64_t position, std::uint64_t count, std::uint64_t end, bool extended)
    {
        const std::size_t head_bytes = extended ? evlr_header_bytes : vlr_header_bytes;
        for (std::uint64_t i = 0; i < count; ++i) {
            const auto give_up = [&] {
                add_note(notes_, (extended ? "extended VLR " : "VLR ") + std::to_string(i + 1) + " of " +
                                     std::to_string(count) + " at byte " + std::to_string(position) +
                                     " extends beyond the " + (extended ? "end of the file" : "start of the points") +
                                     " at byte " + std::to_string(end) + "; it and the rest are ignored");
            };
            if (position > end || end - position < head_bytes) return give_up();
            std::array<std::byte, evlr_header_bytes> head;
            file_.read_at(head.data(), head_bytes, position);
            Vlr vlr;
            vlr.extended = extended;
            vlr.user_id = printable_name({reinterpret_cast<const char*>(&head[2]), 16});
            vlr.id = load<std::uint16_t>(&head[18]);
            const std::uint64_t length = extended ? load<std::uint64_t>(&head[20]) : load<std::uint16_t>(&head[20]);
            vlr.description = printable_name({reinterpret_cast<const char*>(&head[extended ? 28 : 22]), 32});
            if (end - position - head_bytes < length) return give_up();
            keep(std::move(vlr), position + head_bytes, length);
            position += head_bytes + length;
        }
    }

    void keep(Vlr vlr, std::uint64_t offset, std::uint64_t length)
    {
        // Memory of an entry: a file of nothing but empty records must not fill the memory.
        constexpr std::uint64_t overhead = 192;
        const bool needed = vlr.user_id == laszip_user_id && !vlr.extended;
        if (!needed && (max_metadata_bytes - bytes_ < overhead || length > max_metadata_bytes - bytes_ - overhead)) {
            add_note(notes_, to_metadata(vlr).key + " of " + std::to_string(length) +
                                 " bytes is not kept: metadata are limited to " + std::to_string(max_metadata_bytes) +
                                 " bytes");
            return;
        }
        if (!needed) bytes_ += length + overhead;
        vlr.offset = offset;
        vlr.value.resize(static_cast<std::size_t>(length));
        file_.read_at(vlr.value.data(), vlr.value.size(), offset);
        // Only the first laszip VLR counts; further ones must not get around the limit.
        const auto same = [](const Vlr& v) { return v.user_id == laszip_user_id && !v.extended; };
        if (!needed || std::none_of(vlrs_.begin(), vlrs_.end(), same)) vlrs_.push_back(std::move(vlr));
    }

    const File& file_;
    std::uint64_t file_size_;
    const Header& header_;
    std::vector<std::string>& notes_;
    std::vector<Vlr> vlrs_;
    std::uint64_t bytes_ = 0;
};

std::string escaped(const std::string& part)
{
    std::string text;
    for (const char c : part) {
        if (c == '/')
            text += "%2F";
        else if (c == '%')
            text += "%25";
        else
            text += c;
    }
    return text;
}

std::string unescaped(std::string_view part)
{
    std::string text;
    for (std::size_t i = 0; i < part.size(); ++i) {
        const std::string_view code = part.substr(i, 3);
        if (code == "%2F" || code == "%25") {
            text += code == "%2F" ? '/' : '%';
            i += 2;
        } else {
            text += part[i];
        }
    }
    return text;
}

}  // namespace

Header read_header(const File& file, std::uint64_t file_size, std::vector<std::string>& notes)
{
    return HeaderReader(file, file_size, notes).read();
}

std::vector<Vlr> read_vlrs(const File& file, std::uint64_t file_size, const Header& header,
                           std::vector<std::string>& notes)
{
    return VlrReader(file, file_size, header, notes).read();
}

Metadata to_metadata(const Vlr& vlr)
{
    std::string key =
        std::string(vlr.extended ? "las.evlr/" : "las.vlr/") + escaped(vlr.user_id) + "/" + std::to_string(vlr.id);
    if (!vlr.description.empty()) key += "/" + escaped(vlr.description);
    return {std::move(key), vlr.value};
}

std::optional<Vlr> from_metadata(const Metadata& block)
{
    std::vector<std::string_view> parts;
    for (std::string_view rest = block.key;;) {
        const std::size_t slash = rest.find('/');
        parts.push_back(rest.substr(0, slash));
        if (slash == std::string_view::npos) break;
        rest.remove_prefix(slash + 1);
    }
    if (parts.size() < 3 || parts.size() > 4 || (parts[0] != "las.vlr" && parts[0] != "las.evlr")) return {};
    Vlr vlr;
    vlr.extended = parts[0] == "las.evlr";
    vlr.user_id = unescaped(parts[1]);
    const auto [end, error] = std::from_chars(parts[2].data(), parts[2].data() + parts[2].size(), vlr.id);
    if (error != std::errc() || end != parts[2].data() + parts[2].size()) return {};
    if (parts.size() == 4) vlr.description = unescaped(parts[3]);
    vlr.value = block.value;
    return vlr;
}

void add_note(std::vector<std::string>& notes, std::string text)
{
    if (notes.size() < max_notes) notes.push_back(std::move(text));
}

}  // namespace pcm::las
