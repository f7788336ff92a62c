// Numbers and names that users have typed.
#pragma once

#include "plugin/filter/filter.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// A number that a user has typed: the decimal that MeshLab's float stands for, as a double.
double decimal_of(const RichParameterList& parameters, const char* name);
// Numbers separated by blanks, commas or semicolons; empty: nothing. Throws Error(invalid_argument) unless there are
// `count` of them.
std::optional<std::vector<double>> numbers_of(const RichParameterList& parameters, const char* name, const char* label,
                                              std::size_t count);
// Names separated by commas or semicolons.
std::vector<std::string> names_of(const RichParameterList& parameters, const char* name);

}  // namespace pcm::host
