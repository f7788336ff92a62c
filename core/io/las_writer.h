// Writes LAS 1.2 point format 2 (position, intensity, returns, classification, colour) as a stream.
#pragma once

#include "cloud/geometry.h"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace pcm {

struct LasPoint {
    std::int32_t x = 0, y = 0, z = 0;  // on the grid
    std::uint16_t intensity = 0;
    std::uint8_t classification = 0;
    std::uint16_t source_id = 0;
    std::uint16_t red = 0, green = 0, blue = 0;
};

// One thread. The file appears under its name only when finish() returns: until then the points are in a temporary
// file beside it, which the destructor removes. Throws Error(no_space | permission | io | invalid_argument).
class LasWriter {
public:
    LasWriter(const std::filesystem::path& path, const Grid& grid);
    ~LasWriter();
    LasWriter(const LasWriter&) = delete;
    LasWriter& operator=(const LasWriter&) = delete;

    void write(const LasPoint* points, std::size_t count);
    void finish();  // writes the header (count, box) and renames; nothing may be written afterwards

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pcm
