// The header of LAS and LAZ files, and the variable length records before and after the points.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm::las {

struct Header {
    std::vector<std::byte> raw;  // all of its bytes
    unsigned version_minor = 0;
    unsigned format = 0;      // point format, without the bits that mark LAZ
    bool compressed = false;  // LAZ
    std::size_t header_size = 0;
    std::uint64_t point_offset = 0;
    std::size_t record_length = 0;
    std::uint64_t points = 0;
    std::uint64_t vlr_count = 0;
    std::uint64_t evlr_start = 0;
    std::uint64_t evlr_count = 0;
    Grid grid;
    std::optional<Box3d> box;  // if finite and not empty
};

// Checks the header for consistency and against the size of the file: an uncompressed file must hold all points. Throws
// Error(bad_format | truncated | unsupported).
Header read_header(const File& file, std::uint64_t file_size, std::vector<std::string>& notes);

struct Vlr {
    std::string user_id;
    std::uint16_t id = 0;
    std::string description;
    bool extended = false;
    std::vector<std::byte> value;
    std::uint64_t offset = 0;  // offset of the value in its file
};

// VLRs, then EVLRs, in file order. A damaged one ends the list and is noted. VLRs beyond 64 MB in total are noted and
// left out, except the laszip VLR.
std::vector<Vlr> read_vlrs(const File& file, std::uint64_t file_size, const Header& header,
                           std::vector<std::string>& notes);

// Metadata and back. The key is "las.vlr/USER/ID" or "las.evlr/USER/ID", with "/DESCRIPTION" where there is one; '/'
// and '%' inside the parts are written %2F and %25.
Metadata to_metadata(const Vlr& vlr);
std::optional<Vlr> from_metadata(const Metadata& block);  // nothing for other keys
inline constexpr const char* header_key = "las.header";   // Header::raw

// At most a hundred: damaged files must not fill the memory with notes.
void add_note(std::vector<std::string>& notes, std::string text);

}  // namespace pcm::las
