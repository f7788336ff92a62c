// Text of errors, for logs and messages; system/text.h has numbers.
#pragma once

#include "pcm/system/text.h"

#include <string>

namespace pcm::host {

// The message of the current exception. To be called inside a catch block.
std::string current_error();

}  // namespace pcm::host
