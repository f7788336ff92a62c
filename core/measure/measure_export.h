// Measures as files of other programs, in source coordinates.
#pragma once

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/measure/measure_list.h"

#include <filesystem>
#include <optional>
#include <string>

namespace pcm {

struct MeasureFileOptions {
    bool overwrite = false;                  // an existing file; else Error(exists)
    std::optional<CoordinateSystem> system;  // system of the coordinates, as far as known
    double text_height = 0;                  // in drawings, source units; 0: a hundredth of the measures' extent
};

// By the extension:
//
// - .json: the list itself (MeasureList::text()).
// - .csv: RFC 4180, a row per number of a measure: name, kind, quantity, value, uncertainty, unit, geometry (WKT, with
//   z), note. A measure that has no numbers has one row with the reason as its note.
// - .geojson: a FeatureCollection as of RFC 7946, but for its coordinates: they are source coordinates, not longitude
//   and latitude, as the RFC allows by agreement. The member "crs" of GeoJSON 2008 names the system where its EPSG code
//   is known (GDAL and QGIS read it); "coordinate_system" describes it as text where anything of it is known. Each
//   number is a property, with NAME_uncertainty next to it. Rings turn counter-clockwise in plan.
// - .dxf: a layer for each kind (pcm_distance, ...), lines and points, and the label as text at the first point. Hidden
//   measures are left out of drawings alone.
//
// Numbers have all digits. Throws Error(invalid_argument) for other extensions; Error(unsupported) for .dxf without
// dxflib; and what OutputFile throws.
void write_measures(const MeasureList& list, const std::filesystem::path& file, const MeasureFileOptions& options);

// The extensions, with their dots.
inline constexpr const char* measure_extensions[] = {".json", ".csv", ".geojson", ".dxf"};

// "m", "ft" or what the system's horizontal unit is called; empty where it is not known, or an angle.
std::string length_unit_of(const std::optional<CoordinateSystem>& system);
// For users: that lengths mean little where coordinates are longitude and latitude; empty in other systems.
std::string caution_of(const std::optional<CoordinateSystem>& system);

}  // namespace pcm
