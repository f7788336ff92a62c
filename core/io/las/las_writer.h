// Writes LAS 1.4, point formats 0 to 10, and LAZ.
#pragma once

#include "pcm/io/writer.h"

namespace pcm {

// What open_las() reads is written so that it reads the same again: positions, attributes with their types and names,
// grid, VLRs and EVLRs, and of the header the file source id, GPS time type, GUID, system identifier, generating
// software and date. The point format is that of the source where the cloud still has its fields; else the one that has
// fields for the most attributes, the smallest of those. Every other attribute becomes extra bytes. Where a field has
// the name of an attribute but not its type (float intensity, float colours), the attribute is extra bytes and the
// field has it rounded, for other software; numbers of a smaller type go into the field as they are, and colours of 8
// bits times 257. Points without returns are return 1 of 1. Of attributes of a few bits (return_number, ...) values
// that need more are cut to the largest, counted in notes().
//
// Positions: on options.grid, else on the cloud's; integers of the same grid are copied, other numbers rounded to the
// nearest (position_error()). Points with a NaN or infinite coordinate are left out and counted in notes(). Throws
// Error(invalid_argument) for a cloud without a grid when none is given, and from write() for a coordinate that does
// not fit 32 bits on the grid.
//
// Not copied, which notes() say: the index of a cloud optimised file (user id copc) and of LAStools, waveforms. The
// same points give the same bytes on any day, with any number of threads. Extensions: "laz" is compressed, which needs
// the decoders (core/decoders) in the build, in chunks of 50000 points on options.threads threads; anything else is
// LAS.
std::unique_ptr<PointWriter> create_las(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options = {});

}  // namespace pcm
