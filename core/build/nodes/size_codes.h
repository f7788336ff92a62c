// The codes of many sizes.
#pragma once

#include "pcm/tree/point_size.h"

#include <cstdint>
#include <cstring>
#include <vector>

namespace pcm {

// size_code() of many distances, without its logarithm: a table of the distances at which the next code begins, by the
// exponent and the first bits of a number. Cells are narrow: at most one code begins in each.
class SizeCodes {
public:
    // For distances from `least_distance` to `most_distance`.
    SizeCodes(float least_distance, float most_distance, double least) : first_(cell_of(least_distance))
    {
        const std::uint32_t last = cell_of(most_distance);
        cells_.reserve(last - first_ + 1);
        std::uint8_t code = size_code(static_cast<double>(start_of(first_)), least);
        for (std::uint32_t cell = first_; cell <= last; ++cell) {
            const std::uint8_t next = size_code(static_cast<double>(start_of(cell + 1)), least);
            std::uint32_t from = cell << dropped_bits, to = from + (1u << dropped_bits);
            while (code != next && to - from > 1) {  // `from` has the cell's first code, `to` has not
                const std::uint32_t middle = from + (to - from) / 2;
                (size_code(static_cast<double>(float_of(middle)), least) == code ? from : to) = middle;
            }
            cells_.push_back({to, code});
            code = next;
        }
    }
    std::uint8_t operator()(float distance) const
    {
        const Cell& cell = cells_[cell_of(distance) - first_];
        return static_cast<std::uint8_t>(cell.code + (bits_of(distance) >= cell.next));
    }

private:
    static constexpr int dropped_bits = 19;  // from 23: a cell's end is less than a quarter octave above its start
    struct Cell {
        std::uint32_t next;  // bits of the first number that has the next code, or of the next cell's start
        std::uint8_t code;
    };
    static std::uint32_t bits_of(float v)
    {
        std::uint32_t bits;
        std::memcpy(&bits, &v, sizeof bits);
        return bits;
    }
    static float float_of(std::uint32_t bits)
    {
        float v;
        std::memcpy(&v, &bits, sizeof v);
        return v;
    }
    static std::uint32_t cell_of(float v) { return bits_of(v) >> dropped_bits; }
    static float start_of(std::uint32_t cell) { return float_of(cell << dropped_bits); }

    std::uint32_t first_;
    std::vector<Cell> cells_;
};

}  // namespace pcm
