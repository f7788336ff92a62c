// The header of LAS and LAZ files, and the variable length records between it and the points and behind them.
#pragma once

#include "pcm/system/file.h"
#include "pcm/io/reader.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm::las {

struct Header {
    std::vector<std::byte> raw;  // all of its bytes
    unsigned version_minor = 0;
    unsigned format = 0;      // of the points, without the bits that mark LAZ
    bool compressed = false;  // LAZ
    std::size_t header_size = 0;
    std::uint64_t point_offset = 0;
    std::size_t record_length = 0;
    std::uint64_t points = 0;
    std::uint64_t vlr_count = 0;
    std::uint64_t evlr_start = 0;
    std::uint64_t evlr_count = 0;
    Grid grid;
    std::optional<Box3d> box;  // where it is finite and not empty
};

// Checked in itself and against the size of the file: of an uncompressed file that all points are there. Throws
// Error(bad_format | truncated | unsupported).
Header read_header(const File& file, std::uint64_t file_size, std::vector<std::string>& notes);

struct Vlr {
    std::string user_id;
    std::uint16_t id = 0;
    std::string description;
    bool extended = false;
    std::vector<std::byte> value;
    std::uint64_t offset = 0;  // of the value in the file that it comes from
};

// VLRs, then EVLRs, in file order. Damaged ones end the list and are noted; what is beyond 64 MB together is noted and
// left out, but never the laszip VLR.
std::vector<Vlr> read_vlrs(const File& file, std::uint64_t file_size, const Header& header,
                           std::vector<std::string>& notes);

// Metadata and back. The key is "las.vlr/USER/ID" or "las.evlr/USER/ID", with "/DESCRIPTION" where there is one; '/'
// and '%' inside the parts are written %2F and %25.
Metadata to_metadata(const Vlr& vlr);
std::optional<Vlr> from_metadata(const Metadata& block);  // nothing for other keys
inline constexpr const char* header_key = "las.header";   // Header::raw

// No more than a hundred: damaged files must not fill memory with what is wrong with them.
void add_note(std::vector<std::string>& notes, std::string text);

}  // namespace pcm::las
