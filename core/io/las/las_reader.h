// Reads LAS 1.0 to 1.5, point formats 0 to 10, and LAZ, their compressed form.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

// Positions are the file's own integers, with its scale and offset as Grid. Every field of the point format becomes an
// attribute with its own type and its name in the specification, in lower case: bit fields as one u8 each,
// red/green/blue as "rgb" x 3, the wave packet as wave_packet_descriptor, wave_packet_offset, wave_packet_size,
// wave_return_location and wave_direction x 3. scan_angle (formats 6 to 10) has scale 0.006: its value is in degrees.
//
// Extra bytes become attributes as their VLR describes them; NormalX, NormalY and NormalZ of one type, in this order,
// become "normal" x 3; undescribed bytes are "extra_bytes", u8 x n. Where
// create_las() wrote extra bytes because the field of the same name cannot hold the values, they replace the field.
//
// Metadata are the header's bytes, "las.header", and the VLRs and EVLRs, "las.vlr/<user id>/<record id>/<description>"
// and "las.evlr/...", with their payload byte for byte. The last part is omitted without a description; '/' and '%'
// inside a part are %2F and %25. The laszip VLR, which describes the compression, is left out.
//
// A LAS file with fewer bytes than its header's number of points needs is refused here with Error(truncated): read()
// later returns exactly that number. Damaged VLRs are noted and skipped: the points do not depend on them. The chunk
// table of LAZ must agree with the header; where it is missing or damaged and chunks have a fixed size, they are read
// in order without it. With options.threads > 1, chunks are decoded ahead on that many threads. Memory is at most 128
// MB in addition to the batches. LAZ needs the decoders (core/decoders) in the build; without them it is refused with
// Error(unsupported).
std::unique_ptr<PointReader> open_las(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
