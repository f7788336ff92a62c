#include "pcm/io/las/las_encoding.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/las/las_layout.h"
#include "pcm/io/las_summary.h"

#include <algorithm>

namespace pcm::las {
namespace {

constexpr std::uint16_t geotiff_record_id = 34735;

bool has(const std::vector<Vlr>& list, std::uint16_t id)
{
    return std::any_of(list.begin(), list.end(),
                       [&](const Vlr& vlr) { return vlr.user_id == projection_user_id && vlr.id == id; });
}

}  // namespace

unsigned encoding_of(unsigned encoding, const FileInfo& cloud, const std::vector<Vlr>& vlrs,
                     const std::vector<Vlr>& evlrs)
{
    const auto set = [&](unsigned bit, bool on) { encoding = on ? encoding | bit : encoding & ~bit; };
    const bool has_wkt = has(vlrs, wkt_record_id) || has(evlrs, wkt_record_id);
    const bool has_geotiff = has(vlrs, geotiff_record_id) || has(evlrs, geotiff_record_id);
    if (has_wkt != has_geotiff) set(encoding::wkt, has_wkt);
    set(encoding::time_offset, false);
    if (const auto time = gps_time_of(cloud.metadata))
        set(encoding::gps_standard_time, time->offset_in_millions.has_value());
    return encoding;
}

double gps_time_shift(const FileInfo& cloud)
{
    const auto time = gps_time_of(cloud.metadata);
    if (!time || !time->offset_in_millions) return 0;
    return (static_cast<double>(*time->offset_in_millions) - 1000) * 1e6;
}

std::optional<Vlr> crs_vlr(const FileInfo& cloud, const std::vector<Vlr>& vlrs, const std::vector<Vlr>& evlrs,
                           std::vector<std::string>& notes)
{
    if (has(vlrs, wkt_record_id) || has(evlrs, wkt_record_id) || has(vlrs, geotiff_record_id) ||
        has(evlrs, geotiff_record_id))
        return {};
    const auto system = coordinate_system_of(cloud.metadata);
    const bool of_las = std::any_of(cloud.metadata.begin(), cloud.metadata.end(), [](const Metadata& block) {
        return is_crs_block(block) && from_metadata(block);  // a record of LAS, which is copied
    });
    if (!system || of_las) return {};
    if (system->wkt.empty()) {
        notes.push_back("the coordinate system, " + describe(*system) +
                        ", is not written: LAS states it as WKT, which the source does not have");
        return {};
    }
    const auto* bytes = reinterpret_cast<const std::byte*>(system->wkt.data());
    Vlr vlr{std::string(projection_user_id), wkt_record_id, "WKT", false, {bytes, bytes + system->wkt.size()}};
    vlr.value.push_back(std::byte{0});
    return vlr;
}

}  // namespace pcm::las
