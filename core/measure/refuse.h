// Errors of options and points that a measure cannot take.
#pragma once

#include "pcm/system/error.h"

#include <string>

namespace pcm {

// Throws Error(invalid_argument): what is wrong, and what to do.
[[noreturn]] inline void refuse(const std::string& what, const std::string& hint = {})
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

}  // namespace pcm
