// Parameters that several filters have, and lines of the log that several filters write.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/point_cloud.h"
#include "plugin/filter/filter.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
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

// "ChunkPoints". The range is the library's (tree/chunk_size.h).
void add_chunk_points_parameter(RichParameterList& parameters);
std::uint32_t chunk_points_of(const RichParameterList& parameters);

// "IgnoreCrs": whether coordinate systems, units and GPS times that differ are noted instead of refused.
void add_ignore_crs_parameter(RichParameterList& parameters);
bool ignore_crs_of(const RichParameterList& parameters);

// "Inputs": files, or folders of files. `meaning` ends the sentence about what is done with them. "SkipBadLines" and
// "SkipBadFiles": whether faults in them are skipped.
void add_inputs_parameter(RichParameterList& parameters, const QString& meaning);
std::vector<std::filesystem::path> inputs_of(const RichParameterList& parameters);  // at least one
ReadOptions reading_of(const RichParameterList& parameters);                        // threads included

// "LargestCoordinate": points beyond it are left out.
void add_largest_coordinate_parameter(RichParameterList& parameters);
std::optional<double> largest_coordinate_of(const RichParameterList& parameters);

// "Tree": a tree folder. If it is empty, the tree of the current layer is meant; Error(invalid_argument) is thrown if
// there is none.
void add_tree_parameter(RichParameterList& parameters);
std::filesystem::path tree_of(const RichParameterList& parameters, MeshDocument& document);
std::shared_ptr<PointCloud> shown_tree(MeshDocument& document);  // of the current layer; throws in the same way

// `path` with the extension of trees. Throws Error(invalid_argument) for the name of a file of points, unless it is a
// folder's.
std::filesystem::path as_tree(std::filesystem::path path);

// How many points were left out; nothing is logged for 0.
void log_skipped(const FilterRun& run, std::uint64_t points);
// The warnings of an outcome.
void log_warnings(const FilterRun& run, const std::vector<std::string>& warnings);
void log_notes(const FilterRun& run, const std::vector<std::string>& notes);

}  // namespace pcm::host
