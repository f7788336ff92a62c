// Writes points as lines of text: .xyz .txt .asc with blanks between the columns, .csv with commas.
#pragma once

#include "pcm/io/writer.h"

namespace pcm {

// The first line names the columns: "# x y z intensity r g b", or "x,y,z,intensity,r,g,b" in a .csv. Every attribute is
// written: rgb as r g b, normal as nx ny nz, others of several components as name_0 name_1 ..., with values raw * scale
// + offset. Characters that a column's name cannot have become '_' (a .csv quotes instead); duplicate names get a
// number. Coordinates: see TextOutput::put_position. A coordinate system is a comment after that line, "# crs:
// EPSG:32632 WGS 84 / UTM zone 32N" (not in a .csv); notes name the metadata that are not written.
std::unique_ptr<PointWriter> create_xyz(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

}  // namespace pcm
