// Reads LAS 1.0 to 1.4, point formats 0 to 10, uncompressed.
#pragma once

#include "io/reader.h"

namespace pcm {

// Positions come as the file's own integers with its scale and offset as Grid. Every field of the point format becomes
// an attribute in its own type under its name in the specification, lower case: bit fields as u8 each, red/green/blue
// as "rgb" x 3, the wave packet as wave_packet_descriptor, wave_packet_offset, wave_packet_size, wave_return_location
// and wave_direction x 3. scan_angle (formats 6 to 10) has scale 0.006, so that its value is in degrees.
//
// Extra bytes are attributes as their VLR describes them; bytes that no VLR describes are "extra_bytes", u8 x n.
//
// VLRs and EVLRs are metadata "las.vlr/<user id>/<record id>" and "las.evlr/...", their payload byte for byte.
//
// A file whose header promises more points than its bytes can hold is refused here with Error(truncated): what read()
// returns later is exactly the promised count. Damaged VLRs are noted and skipped, for the points do not depend on
// them.
std::unique_ptr<PointReader> open_las(const std::filesystem::path& path);

}  // namespace pcm
