#include "pcm/ops/shared/origin_report.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/las_summary.h"
#include "pcm/system/text.h"

#include <string>

namespace pcm::ops {
namespace {

// Without the highest returns that no point has.
std::vector<std::uint64_t> counts_by_return(const LasSummary& header)
{
    std::vector<std::uint64_t> counts = header.points_by_return;
    while (!counts.empty() && counts.back() == 0) counts.pop_back();
    return counts;
}

Json json_of(const CrsPart& part)
{
    Json json;
    json["name"] = part.name;
    json["epsg"] = part.code && part.authority == "EPSG" ? Json(part.code) : Json();
    json["code"] = part.code ? Json(part.authority + ":" + std::to_string(part.code)) : Json();
    json["unit"] = part.unit.is_known() ? Json(part.unit.name) : Json();
    json["unit_size"] = part.unit.is_known() ? Json(part.unit.per_unit) : Json();
    return json;
}

Json json_of(const CoordinateSystem& system)
{
    Json json = json_of(system.horizontal);
    json["name"] = system.name;
    json["kind"] = name_of(system.kind);
    json["vertical"] = system.vertical.is_known() ? json_of(system.vertical) : Json();
    json["source"] = system.source;
    json["wkt"] = system.wkt.empty() ? Json() : Json(system.wkt.c_str());
    return json;
}

Json json_of(const LasSummary& header)
{
    Json json;
    json["version"] = "1." + std::to_string(header.version_minor);
    json["point_format"] = header.format;
    json["compressed"] = header.compressed;
    json["file_source_id"] = header.file_source_id;
    json["global_encoding"] = header.global_encoding;
    json["wkt"] = header.wkt_bit;
    json["project_id"] = header.guid;
    json["system_identifier"] = header.system_identifier;
    json["generating_software"] = header.generating_software;
    json["creation_day"] = header.creation_day;
    json["creation_year"] = header.creation_year;
    json["header_bytes"] = header.header_bytes;
    json["point_offset"] = header.point_offset;
    json["record_bytes"] = header.record_bytes;
    json["vlrs"] = header.vlrs;
    json["evlrs"] = header.evlrs;
    json["points"] = header.points;
    json["points_by_return"] = counts_by_return(header);
    json["gps_time_range"] = header.gps_box ? Json(*header.gps_box) : Json();
    return json;
}

void print_header(Result& result, const LasSummary& header)
{
    result.print(
        "header      LAS 1.%u, point format %u, %zu bytes; points of %zu bytes from byte %s; %s VLRs, %s extended",
        header.version_minor, header.format, header.header_bytes, header.record_bytes,
        grouped(header.point_offset).c_str(), grouped(header.vlrs).c_str(), grouped(header.evlrs).c_str());
    const std::string day = header.creation_year ? ", day " + std::to_string(header.creation_day) + " of " +
                                                       std::to_string(header.creation_year)
                                                 : "";
    result.print("created     by '%s', system '%s'%s; file source id %u, global encoding %u",
                 header.generating_software.c_str(), header.system_identifier.c_str(), day.c_str(),
                 header.file_source_id, header.global_encoding);
    if (!header.guid.empty()) result.print("project id  %s", header.guid.c_str());
    if (header.gps_box)
        result.print("gps range   %s to %s", exact((*header.gps_box)[0]).c_str(), exact((*header.gps_box)[1]).c_str());
    const std::vector<std::uint64_t> counts = counts_by_return(header);
    if (counts.empty()) return;
    std::string returns = "returns    ";
    for (std::size_t r = 0; r < counts.size(); ++r)
        returns += (r ? "  " : " ") + std::to_string(r + 1) + ": " + grouped(counts[r]);
    result.line(returns);
}

}  // namespace

void put_origin(Json& json, const std::vector<Metadata>& metadata)
{
    const auto system = coordinate_system_of(metadata);
    json["crs"] = system ? json_of(*system) : Json();
    json["gps_time"] = nullptr;
    if (const auto time = gps_time_of(metadata)) {
        json["gps_time"] = {{"type", time->offset_in_millions ? "standard" : "week"}};
        if (time->offset_in_millions) json["gps_time"]["offset"] = *time->offset_in_millions * 1e6;
    }
    const std::vector<LasSummary> headers = las_summaries(metadata);
    json["las"] = headers.size() == 1 ? json_of(headers[0]) : Json();
}

void print_origin(Result& result, const std::vector<Metadata>& metadata)
{
    const std::vector<LasSummary> headers = las_summaries(metadata);
    if (headers.size() == 1) print_header(result, headers[0]);
    if (headers.size() > 1) result.print("header      of %s LAS files", grouped(headers.size()).c_str());
    if (const auto system = coordinate_system_of(metadata))
        result.print("crs         %s; %s, from %s", describe(*system).c_str(),
                     std::string(name_of(system->kind)).c_str(), system->source.c_str());
    else
        result.print("crs         none stated");
    if (const auto time = gps_time_of(metadata)) result.print("gps time    %s", describe(*time).c_str());
}

}  // namespace pcm::ops
