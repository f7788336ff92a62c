// Reads the points of E57 files (ASTM E2807-11): all scans in order, in the coordinates of the file.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

// Positions are doubles: cartesian coordinates, or spherical ones (range r, azimuth a, elevation e) as r cos e cos a,
// r cos e sin a, r sin e, rotated by the normalised quaternion of the scan's pose and moved by its translation.
// position_type is f32 if all are floats and no pose moves them. Points marked as having no valid position are dropped
// and counted in the notes; with a field for such marks, points_known is false.
//
// Attributes: see plan_e57() for their types. Standard fields are intensity, rgb, number_of_returns, return_index (from
// 0 by the standard; some files count from 1), time_stamp, row_index, column_index, is_intensity_invalid,
// ...; fields of extensions are "prefix:name", those of "las" named as in a LAS file, three normals "normal". "scan"
// numbers the scans, from 1, where there are several. Metadata: "e57.xml" (up to 4 MB), "e57.coordinateMetadata",
// "e57.scan/<number from 1>/name", ".../guid" and ".../pose": the translation and the quaternion w x y z.
//
// The checksum of every page that is read is checked.
std::unique_ptr<PointReader> open_e57(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
