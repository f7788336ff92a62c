// Reads the points of E57 files (ASTM E2807-11): every scan, one behind the other, in the coordinates of the file.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

// Positions are doubles: cartesian coordinates, or spherical ones (range r, azimuth a, elevation e) as r cos e cos a,
// r cos e sin a, r sin e, turned by the normalised quaternion of the scan's pose and moved by its translation.
// position_type is f32 where all are floats that no pose moves. Points whose state says that they have no valid
// position are dropped and counted in the notes; while there is a field for that, points_known is false.
//
// Attributes: see plan_e57() for their types. Standard fields are intensity, rgb, number_of_returns, return_index (from
// 0 by the standard, but there are files that count from 1), time_stamp, row_index, column_index, is_intensity_invalid,
// ...; fields of extensions are "prefix:name", those of "las" named as in a LAS file, three normals "normal". "scan"
// numbers the scans, from 1, where there are several. Metadata: "e57.xml" (up to 4 MB), "e57.coordinateMetadata",
// "e57.scan/<number from 1>/name" and ".../guid".
//
// Every page that is read is checked against its checksum.
std::unique_ptr<PointReader> open_e57(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
