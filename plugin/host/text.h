// Errors in words, for logs and messages; numbers are in system/text.h.
#pragma once

#include "pcm/system/text.h"

#include <string>

namespace pcm::host {

// What went wrong, to be called inside a catch block.
std::string current_error();

}  // namespace pcm::host
