#include "pcm/io/las_summary.h"

#include "pcm/io/file_text.h"
#include "pcm/io/las/las_header.h"
#include "pcm/io/las/las_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

namespace pcm {
namespace {

namespace at = las::header;

// As Windows and laspy print it: three little-endian numbers, then bytes.
std::string guid_of(const std::byte* from)
{
    if (std::all_of(from, from + 16, [](std::byte b) { return b == std::byte{0}; })) return {};
    char text[40];
    std::snprintf(text, sizeof text, "%08x-%04x-%04x-", las::load<std::uint32_t>(from),
                  las::load<std::uint16_t>(from + 4), las::load<std::uint16_t>(from + 6));
    std::string guid = text;
    for (std::size_t i = 8; i < 16; ++i) {
        std::snprintf(text, sizeof text, "%s%02x", i == 10 ? "-" : "", std::to_integer<unsigned>(from[i]));
        guid += text;
    }
    return guid;
}

std::string text_at(const std::byte* from, std::size_t bytes)
{
    return printable_name({reinterpret_cast<const char*>(from), bytes});
}

GpsTime time_of(const LasSummary& summary, const std::vector<std::byte>& raw)
{
    if (!(summary.global_encoding & las::encoding::gps_standard_time)) return {};
    constexpr unsigned adjusted = 1000;
    const bool states_offset = summary.version_minor >= 5 && summary.global_encoding & las::encoding::time_offset;
    return {states_offset ? las::load<std::uint16_t>(&raw[at::time_offset]) : adjusted};
}

void add_counts(LasSummary& summary, const std::vector<std::byte>& raw)
{
    summary.points = las::load<std::uint32_t>(&raw[at::point_count_32]);
    std::uint64_t counted = 0;
    if (summary.version_minor >= 4) {
        if (const auto points = las::load<std::uint64_t>(&raw[at::point_count_64])) summary.points = points;
        summary.evlrs = las::load<std::uint32_t>(&raw[at::evlr_count]);
        for (std::size_t r = 0; r < 15; ++r) {
            summary.points_by_return.push_back(las::load<std::uint64_t>(&raw[at::return_counts_64 + 8 * r]));
            counted += summary.points_by_return.back();
        }
    }
    if (counted) return;  // old writers of LAS 1.4 fill only the 32-bit counts
    summary.points_by_return.clear();
    for (std::size_t r = 0; r < 5; ++r)
        summary.points_by_return.push_back(las::load<std::uint32_t>(&raw[at::return_counts_32 + 4 * r]));
}

}  // namespace

std::string describe(const GpsTime& time)
{
    if (!time.offset_in_millions) return "seconds of the GPS week";
    const std::string offset = std::to_string(*time.offset_in_millions) + " million seconds";
    return "standard GPS time minus " + (*time.offset_in_millions == 1000 ? offset + " (adjusted standard)" : offset);
}

std::optional<LasSummary> las_summary_of(const Metadata& block)
{
    const std::vector<std::byte>& raw = block.value;
    if (block.key != las::header_key || raw.size() < at::size_1_0) return {};
    LasSummary summary;
    summary.version_minor = las::load<std::uint8_t>(&raw[at::version_minor]);
    if (summary.version_minor >= 5 && raw.size() < at::size_1_5) return {};
    if (summary.version_minor >= 4 && raw.size() < at::size_1_4) return {};
    const auto format = las::load<std::uint8_t>(&raw[at::point_format]);
    summary.format = format & 0x3Fu;
    summary.compressed = format & 0xC0u;
    summary.file_source_id = las::load<std::uint16_t>(&raw[at::file_source_id]);
    if (summary.version_minor >= 2) summary.global_encoding = las::load<std::uint16_t>(&raw[at::global_encoding]);
    summary.wkt_bit = summary.global_encoding & las::encoding::wkt;
    summary.guid = guid_of(&raw[at::guid]);
    summary.system_identifier = text_at(&raw[at::system_identifier], 32);
    summary.generating_software = text_at(&raw[at::generating_software], 32);
    summary.creation_day = las::load<std::uint16_t>(&raw[at::creation_day]);
    summary.creation_year = las::load<std::uint16_t>(&raw[at::creation_year]);
    summary.header_bytes = las::load<std::uint16_t>(&raw[at::header_size]);
    summary.point_offset = las::load<std::uint32_t>(&raw[at::point_offset]);
    summary.record_bytes = las::load<std::uint16_t>(&raw[at::record_length]);
    summary.vlrs = las::load<std::uint32_t>(&raw[at::vlr_count]);
    add_counts(summary, raw);
    if (!las::has_gps_time(summary.format)) return summary;
    summary.gps_time = time_of(summary, raw);
    if (summary.version_minor < 5) return summary;
    const auto largest = las::load<double>(&raw[at::gps_time_max]), least = las::load<double>(&raw[at::gps_time_min]);
    if (std::isfinite(least) && std::isfinite(largest) && (least != 0 || largest != 0))
        summary.gps_box = {least, largest};
    return summary;
}

std::vector<LasSummary> las_summaries(const std::vector<Metadata>& metadata)
{
    std::vector<LasSummary> all;
    for (const Metadata& block : metadata)
        if (auto summary = las_summary_of(block)) all.push_back(std::move(*summary));
    return all;
}

std::optional<LasSummary> first_las_summary(const std::vector<Metadata>& metadata)
{
    for (const Metadata& block : metadata)
        if (auto summary = las_summary_of(block)) return summary;
    return {};
}

std::optional<GpsTime> gps_time_of(const std::vector<Metadata>& metadata)
{
    for (const Metadata& block : metadata)
        if (const auto summary = las_summary_of(block); summary && summary->gps_time) return summary->gps_time;
    return {};
}

}  // namespace pcm
