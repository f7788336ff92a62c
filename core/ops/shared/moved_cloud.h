// A tree that is moved into another cloud.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/cloud/affine.h"
#include "pcm/ops/result.h"
#include "pcm/tree/tree.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace pcm::ops {

// Writes the tree, moved by the maps one after the other, in double, as a tree or a file. Throws
// Error(invalid_argument) where `output` is the tree itself, and what build_or_write() and TransformedReader throw.
BuildReport write_moved(const std::shared_ptr<const Tree>& tree, const std::vector<Affine>& maps,
                        const std::filesystem::path& output, const BuildOptions& options);

// output, its notes, position_error, bytes (null without a report), and a line about it.
void put_moved(Result& result, const std::string& output, const std::optional<BuildReport>& report);

}  // namespace pcm::ops
