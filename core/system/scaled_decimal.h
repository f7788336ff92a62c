// Integers times a step plus an offset, printed as the decimal numbers that they stand for: 7 * 0.1 as 0.7, which in
// double is 0.7000000000000001.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace pcm {

class ScaledDecimal {
public:
    // Bytes that write() may need.
    static constexpr std::size_t longest = 48;

    // Step and offset are taken as the shortest decimals that read as these doubles.
    ScaledDecimal(double scale, double offset);

    // Writes q * scale + offset without rounding and returns the end of the text. Null, and nothing is written, where
    // that is not a number as people write it: with more than 17 digits, nearer to 0 than 1e-5 or as large as 1e15.
    char* write(char* to, std::int64_t q) const;

    double scale() const { return scale_; }
    double offset() const { return offset_; }

private:
    double scale_, offset_;
    bool usable_ = false;
    // In units of 10^-places_.
    std::int64_t step_ = 0, shift_ = 0;
    int places_ = 0;
};

// The same as text; where write() gives null, the fewest digits that read back as q * scale + offset in double.
std::string decimal_text(std::int64_t q, double scale, double offset);

}  // namespace pcm
