// Reads LAS 1.0 to 1.4, point formats 0 to 10, and LAZ, their compressed form.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

// Positions come as the file's own integers with its scale and offset as Grid. Every field of the point format becomes
// an attribute in its own type under its name in the specification, lower case: bit fields as u8 each, red/green/blue
// as "rgb" x 3, the wave packet as wave_packet_descriptor, wave_packet_offset, wave_packet_size, wave_return_location
// and wave_direction x 3. scan_angle (formats 6 to 10) has scale 0.006, so that its value is in degrees.
//
// Extra bytes are attributes as their VLR describes them; bytes that no VLR describes are "extra_bytes", u8 x n. Extra
// bytes that create_las() wrote for values that the field of the same name cannot hold are read in the field's place.
//
// Metadata are the header's bytes, "las.header", and the VLRs and EVLRs, "las.vlr/<user id>/<record id>/<description>"
// and "las.evlr/...", their payload byte for byte; without the last part where there is no description, '/' and '%'
// inside a part as %2F and %25. The VLR that says how LAZ is compressed is not among them.
//
// A LAS file whose header promises more points than its bytes can hold is refused here with Error(truncated): what
// read() returns later is exactly the promised count. Damaged VLRs are noted and skipped, for the points do not depend
// on them. Of LAZ the chunk table must agree with the header; where it is missing or damaged and chunks have a fixed
// size, they are read in order without it. With options.threads > 1 chunks are decoded ahead on that many threads.
// Memory is bounded by 128 MB beside the batches. LAZ needs the decoders (core/decoders) in the build; without them it
// is refused with Error(unsupported).
std::unique_ptr<PointReader> open_las(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
