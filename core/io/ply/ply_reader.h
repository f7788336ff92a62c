// Reads the points of PLY files: ascii, binary little endian, binary big endian.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

// The element "vertex" is read, wherever it is in the file; other elements are skipped. Positions are doubles, exactly
// as stored (position_type says whether they were f32). Every other scalar property is an attribute with its own type
// and name, except that red/green/blue (also r/g/b, diffuse_red/...) become "rgb" x 3 and nx/ny/nz (also normal_x/...)
// "normal" x 3, if the three have the same type, and scalar_intensity becomes "intensity". Lists of a vertex are
// skipped with a note.
//
// Comments of ply_writer restore attributes of several components or 64 bits, their names, scale and offset, and
// metadata.
//
// Truncated binary files with vertices of a fixed size are refused here; for others, and ascii, read() throws. Numbers
// of ascii files must fit the type of their property. NaN and infinities are kept.
std::unique_ptr<PointReader> open_ply(const std::filesystem::path& path, const ReadOptions& options = {});

// Whether the file has no elements but vertices: no faces, no edges. Throws what open_ply() throws for its header.
bool ply_only_points(const std::filesystem::path& path);

}  // namespace pcm
