// Numbers and errors in words, for logs and messages.
#pragma once

#include "cloud/geometry.h"

#include <cstdint>
#include <string>

namespace pcm::host {

std::string grouped(std::uint64_t number);    // 1,234,567
std::string exact(double value);              // as many digits as it takes to read the same double back
std::string exact(const Vec3d& v);            // "x y z"
std::string brief(double value);              // three significant digits
std::string bytes_text(std::uint64_t bytes);  // "1.25 GB"

// What went wrong, to be called inside a catch block.
std::string current_error();

}  // namespace pcm::host
