// The bits of a LAS header that say what other parts of the file mean, for a cloud that may come from several files.
#pragma once

#include "pcm/io/las/las_header.h"
#include "pcm/io/reader.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm::las {

// `encoding`, the global encoding of the source or the default, with bits that are true of the written file: the WKT
// bit says which kind of record states the coordinate system, if there is one kind; the bit of GPS times is that of the
// first source with times; the offset of LAS 1.5 has no field in LAS 1.4.
unsigned encoding_of(unsigned encoding, const FileInfo& cloud, const std::vector<Vlr>& vlrs,
                     const std::vector<Vlr>& evlrs);

// What is added to GPS times so that they are relative to 1000 million seconds, as LAS 1.4 has it; 0 for most clouds.
double gps_time_shift(const FileInfo& cloud);

// The record for a coordinate system that no record of `vlrs` and `evlrs` states: of E57, or of a comment. Nothing when
// there is none, and when it has no WKT; `notes` reports that.
std::optional<Vlr> crs_vlr(const FileInfo& cloud, const std::vector<Vlr>& vlrs, const std::vector<Vlr>& evlrs,
                           std::vector<std::string>& notes);

}  // namespace pcm::las
