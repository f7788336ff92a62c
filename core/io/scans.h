// Scans of a cloud, each from a station of its own: their numbers in the attribute `scan`, and where the scanner stood.
//
// PTX and E57 number the scans of a file from 1; metadata "ptx.scan/N" (the ten lines before a scan) and
// "e57.scan/N/pose" (translation, rotation as a quaternion w x y z) keep their poses. Several files together are
// numbered through by pipe/merged_reader.h.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/metadata.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/cloud/vector.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

inline constexpr const char* scan_attribute = "scan";

// The scans of a file, which its metadata number; 0: its format has none. A large file may show the others only when
// it is read: for one with the attribute more than any has.
std::uint32_t scans_of(const std::vector<Metadata>& metadata, const Schema& schema);
// Its place in the schema, to which it is added where it is not there; nothing where another attribute has the name.
std::optional<std::size_t> place_for_scan_numbers(Schema& schema);
// The numbers of `count` points of a file that comes after others with `before` scans together. `numbered`: the column
// has the numbers of the file's scans; else the file has one scan.
void number_scans(Column& column, std::size_t count, std::uint32_t before, bool numbered);
// A key of metadata with the scan's number among those of all files.
std::string renumbered(const std::string& key, std::uint32_t before);

// Where the scanner stood, by number of the scan, source coordinates. Scans without a pose, or one that is not finite,
// are left out.
std::map<std::uint32_t, Vec3d> scan_positions(const std::vector<Metadata>& metadata);

}  // namespace pcm
