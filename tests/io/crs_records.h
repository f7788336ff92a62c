// Records of coordinate systems for tests, written by hand from the specifications.
#pragma once

#include "tests/io/las_file.h"

#include <string>
#include <vector>

namespace pcm::test {

inline Metadata block(const std::string& key, const std::string& value)
{
    const auto* bytes = reinterpret_cast<const std::byte*>(value.data());
    return {key, {bytes, bytes + value.size()}};
}

struct GeoEntry {
    int id, place, count, value;
};

// The payload of record 34735.
inline std::string geo_directory(const std::vector<GeoEntry>& keys)
{
    Bytes to;
    for (const int n : {1, 1, 0, static_cast<int>(keys.size())}) to.put(static_cast<std::uint16_t>(n));
    for (const GeoEntry& key : keys)
        for (const int n : {key.id, key.place, key.count, key.value}) to.put(static_cast<std::uint16_t>(n));
    return to.data;
}

// A projected system: an EPSG code, and the code of its unit (0: not stated).
inline std::string geo_projected(int code, int unit = 0)
{
    std::vector<GeoEntry> keys = {{1024, 0, 1, 1}, {3072, 0, 1, code}};
    if (unit) keys.push_back({3076, 0, 1, unit});
    return geo_directory(keys);
}

inline std::string wkt_utm(int zone, const std::string& unit = "UNIT[\"metre\",1,AUTHORITY[\"EPSG\",\"9001\"]]")
{
    const std::string name = std::to_string(zone);
    return "PROJCS[\"WGS 84 / UTM zone " + name +
           "N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS "
           "84\",6378137,298.257223563,AUTHORITY[\"EPSG\",\"7030\"]],"
           "AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433],"
           "AUTHORITY[\"EPSG\",\"4326\"]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"scale_factor\",0.9996]," +
           unit + ",AXIS[\"Easting\",EAST],AXIS[\"Northing\",NORTH],AUTHORITY[\"EPSG\",\"326" + name + "\"]]";
}

}  // namespace pcm::test
