// What the header of a LAS file states, decoded from the block of metadata that keeps its bytes ("las.header").
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/metadata.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// What the numbers in the attribute gps_time mean.
struct GpsTime {
    // Standard GPS time counts seconds since 6 January 1980; files subtract a number of million seconds from it: 1000
    // up to LAS 1.4. Nothing: seconds of the GPS week.
    std::optional<unsigned> offset_in_millions;
    bool operator==(const GpsTime& o) const { return offset_in_millions == o.offset_in_millions; }
    bool operator!=(const GpsTime& o) const { return !(*this == o); }
};
std::string describe(const GpsTime& time);

struct LasSummary {
    unsigned version_minor = 0;  // x of version 1.x
    unsigned format = 0;         // point format
    bool compressed = false;     // LAZ
    unsigned file_source_id = 0;
    unsigned global_encoding = 0;  // 0 before LAS 1.2
    bool wkt_bit = false;
    std::string guid;  // empty: all zeros
    std::string system_identifier, generating_software;
    unsigned creation_day = 0, creation_year = 0;  // day of the year; 0: not stated
    std::size_t header_bytes = 0;
    std::uint64_t point_offset = 0;
    std::size_t record_bytes = 0;
    std::uint64_t vlrs = 0, evlrs = 0;
    std::uint64_t points = 0;
    std::vector<std::uint64_t> points_by_return;   // points of return 1, 2, ...: 5 of them before LAS 1.4, then 15
    std::optional<GpsTime> gps_time;               // where the point format has times
    std::optional<std::array<double, 2>> gps_box;  // minimum and maximum time; LAS 1.5, where stated
};

// Nothing for other blocks and for a header that is cut.
std::optional<LasSummary> las_summary_of(const Metadata& block);
std::optional<LasSummary> first_las_summary(const std::vector<Metadata>& metadata);
std::vector<LasSummary> las_summaries(const std::vector<Metadata>& metadata);

// The times of the first LAS header whose points have any.
std::optional<GpsTime> gps_time_of(const std::vector<Metadata>& metadata);

}  // namespace pcm
