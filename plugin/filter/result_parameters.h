// What the filters that make another cloud of a tree have in common: where it goes, how it is reported and shown.
#pragma once

#include "pcm/filter/result_tree.h"
#include "plugin/filter/filter.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// "Output", "Overwrite", "MemoryMB" and "Threads"; with `in_place` also "InPlace".
void add_result_parameters(RichParameterList& parameters, bool in_place);
// Without progress. Throws Error(invalid_argument) for values out of range, and without an output.
ResultOptions result_options_of(const RichParameterList& parameters);

// A number that a user has typed: the decimal that MeshLab's float stands for, as a double.
double decimal_of(const RichParameterList& parameters, const char* name);
// Numbers separated by blanks, commas or semicolons; empty: nothing. Throws Error(invalid_argument) unless there are
// `count` of them.
std::optional<std::vector<double>> numbers_of(const RichParameterList& parameters, const char* name, const char* label,
                                              std::size_t count);
// Names separated by commas or semicolons.
std::vector<std::string> names_of(const RichParameterList& parameters, const char* name);

// "... of ... points, in ... s, ...; peak memory": after `what`, and the notes and warnings.
void log_result(const FilterRun& run, const std::string& what, const BuildReport& report);

}  // namespace pcm::host
