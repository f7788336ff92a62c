// What a checkpoint says of a build whose points lie in bins.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/bins/workspace.h"
#include "pcm/build/builder.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace pcm {

class ByteReader;
class ByteWriter;

// What was found while reading the cloud, and where its rows are in the scratch file.
void save_bins(const Ingested& cloud, const AnyBins& bins, ByteWriter& out);
// The reverse, for a cloud of the same schema. Throws Error(corrupt | not_found) when `in` and the scratch file do not
// match.
AnyBins load_bins(Ingested& cloud, Workspace& work, const Schema& schema, ByteReader& in);

// Bytes that differ for builds that would make different trees: of other files, or of files that have changed, or with
// other options, or by a program that does it in another way. Throws Error(not_found | ...) for a file that cannot be
// looked at.
std::vector<std::byte> identity_of_build(const std::vector<std::filesystem::path>& files, const BuildOptions& options);

}  // namespace pcm
