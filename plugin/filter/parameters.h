// What several filters' parameters have in common.
#pragma once

#include "pcm/point_cloud.h"

#include <common/interfaces.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace pcm::host {

// Paths as a user writes them, relative ones from the current folder.
std::filesystem::path absolute_path(const QString& text);
std::vector<std::filesystem::path> split_paths(const QString& text);  // between semicolons

// The value of a parameter. Throws Error(invalid_argument), naming its label, when it is out of range.
int in_range(const RichParameterList& parameters, const char* name, const char* label, int least, int most);

// "MemoryMB" and "Threads".
void add_work_parameters(RichParameterList& parameters);
std::uint64_t memory_of(const RichParameterList& parameters);
unsigned threads_of(const RichParameterList& parameters);

// "Inputs": files, or folders of files.
void add_inputs_parameter(RichParameterList& parameters, const QString& meaning);
std::vector<std::filesystem::path> inputs_of(const RichParameterList& parameters);  // at least one

// "Tree": a folder; where it is empty, the tree of the current layer. Throws Error(invalid_argument) when there is
// neither.
void add_tree_parameter(RichParameterList& parameters);
std::filesystem::path tree_of(const RichParameterList& parameters, MeshDocument& document);
std::shared_ptr<PointCloud> shown_tree(MeshDocument& document);  // of the current layer; throws in the same way

// `path` with the extension of trees.
std::filesystem::path as_tree(std::filesystem::path path);

}  // namespace pcm::host
