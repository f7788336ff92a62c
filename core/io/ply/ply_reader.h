// Reads the points of PLY files: ascii, binary little endian, binary big endian.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

// The element "vertex" is read wherever it stands; other elements are passed over. Positions are doubles, exactly as
// stored (position_type tells whether they were f32). Every other scalar property is an attribute in its own type and
// name, except that red/green/blue (also r/g/b, diffuse_red/...) become "rgb" x 3, nx/ny/nz (also normal_x/...) become
// "normal" x 3 where the three have one type, and scalar_intensity becomes "intensity". Lists inside a vertex are
// passed over with a note.
//
// Comments of ply_writer give back attributes of several components or 64 bits, their names, scale and offset, and
// metadata.
//
// Truncated binary files whose vertices have one size are refused here; others, and ascii, when read() gets there.
// Numbers of ascii files must fit the type of their property. NaN and infinities are passed on.
std::unique_ptr<PointReader> open_ply(const std::filesystem::path& path, const ReadOptions& options = {});

// Whether the file has no elements but vertices: no faces, no edges. Throws what open_ply() throws for its header.
bool ply_only_points(const std::filesystem::path& path);

}  // namespace pcm
