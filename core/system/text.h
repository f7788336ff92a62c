// Numbers as text for logs, messages and the command line.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace pcm {

std::string grouped(std::uint64_t number);          // 1,234,567
std::string points_text(std::uint64_t points);      // "1 point", "1,234 points"
std::string exact(double value);                    // the fewest digits that read back as the same double
std::string exact(const std::array<double, 3>& v);  // "x y z"
std::string brief(double value);                    // three significant digits
std::string bytes_text(std::uint64_t bytes);        // "1.25 GB"
std::string time_text(double seconds);              // "3.2 ms", "4.56 s", "2 min 5 s", "3 h 20 min"

}  // namespace pcm
