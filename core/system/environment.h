// Variables of the process's environment.
#pragma once

#include <string>

namespace pcm {

std::string environment(const char* name);  // empty where it is not set

}  // namespace pcm
