// Parameters that several filters have, and lines of the log that several filters write.
#pragma once

#include "pcm/point_cloud.h"
#include "plugin/filter/filter.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcm::host {

// Paths as a user writes them; relative ones start at the current folder.
std::filesystem::path absolute_path(const QString& text);
std::vector<std::filesystem::path> split_paths(const QString& text);  // separated by semicolons

// The value of an integer parameter. Throws Error(invalid_argument), naming its label, when it is out of range.
int in_range(const RichParameterList& parameters, const char* name, const char* label, int least, int most);

// "MemoryMB" and "Threads". The ranges are the library's (build/builder.h).
void add_work_parameters(RichParameterList& parameters);
std::uint64_t memory_of(const RichParameterList& parameters);
unsigned threads_of(const RichParameterList& parameters);

// "Tree": a tree folder. If it is empty, the tree of the current layer is meant; Error(invalid_argument) is thrown if
// there is none.
void add_tree_parameter(RichParameterList& parameters);
std::filesystem::path tree_of(const RichParameterList& parameters, MeshDocument& document);
std::shared_ptr<PointCloud> shown_tree(MeshDocument& document);  // of the current layer; throws in the same way

// `path` with the extension of trees. Throws Error(invalid_argument) for the name of a file of points, unless it is a
// folder's.
std::filesystem::path as_tree(std::filesystem::path path);

// The warnings of an outcome.
void log_warnings(const FilterRun& run, const std::vector<std::string>& warnings);
void log_notes(const FilterRun& run, const std::vector<std::string>& notes);

}  // namespace pcm::host
