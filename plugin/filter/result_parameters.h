// Numbers that users have typed.
#pragma once

#include "plugin/filter/filter.h"

namespace pcm::host {

// A number that a user has typed: the decimal that MeshLab's float stands for, as a double.
double decimal_of(const RichParameterList& parameters, const char* name);

}  // namespace pcm::host
