// What a checkpoint says of a build whose points lie in bins.
#pragma once

#include "pcm/build/build_state.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

// What reading has found, and the bins; the scratch file itself is not written.
void save_bins(const BuildState& state, const AnyBins& bins, ByteWriter& out);
// The reverse, for a cloud of the same schema. Throws Error(corrupt | not_found) when `in` and the scratch file do not
// go together.
AnyBins load_bins(BuildState& state, const Schema& schema, ByteReader& in);

// Bytes that differ for builds that would make different trees: of other files, or of files that have changed, or with
// other options, or by a program that does it in another way. Throws Error(not_found | ...) for a file that cannot be
// looked at.
std::vector<std::byte> identity_of_build(const std::vector<std::filesystem::path>& files, const BuildOptions& options);

}  // namespace pcm
