// What a PLY file is and holds in addition to the points that its header promises, for people.
#pragma once

#include "pcm/io/ply/ply_header.h"
#include "pcm/io/records/line_stream.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

std::string format_name(const PlyHeader& header);

// Elements that are not read.
std::vector<std::string> other_elements(const PlyHeader& header, std::size_t vertex_element);

// Bytes of a binary file after its last element, where `left` bytes follow the last vertex; null when there are none,
// and when lists do not let it be known.
std::optional<std::string> surplus_bytes(const PlyHeader& header, std::size_t vertex_element, std::uint64_t left);

// Lines of an ascii file after those of its last element. `lines` stands after the last vertex and is read to its end.
std::optional<std::string> surplus_lines(const PlyHeader& header, std::size_t vertex_element, LineStream& lines);

}  // namespace pcm
