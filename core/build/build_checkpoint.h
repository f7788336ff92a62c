// The record of a build whose points are in bins, and the identity by which a build is recognized.
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

void save_observed(const Observed& observed, ByteWriter& out);
Observed load_observed(ByteReader& in);
// What was found while reading the cloud, and the reverse, for a cloud of the same schema. Throws Error(corrupt).
void save_found(const Ingested& cloud, ByteWriter& out);
void load_found(Ingested& cloud, const Schema& schema, ByteReader& in);
// The cuts between bins, and the reverse. Throws Error(corrupt) for cuts that make no sense.
template <class Coord>
void save_top(const TopTree<Coord>& top, ByteWriter& out);
template <class Coord>
TopTree<Coord> load_top(ByteReader& in);

// Both, and where the rows are in the scratch file.
void save_bins(const Ingested& cloud, const AnyBins& bins, ByteWriter& out);
// The reverse, for a cloud of the same schema. Throws Error(corrupt | not_found) when `in` and the scratch file do not
// match.
AnyBins load_bins(Ingested& cloud, Workspace& work, const Schema& schema, ByteReader& in);

// Bytes that differ for builds that would make different trees: of other files, of files that have changed, with other
// options, or by another version of the program. Throws Error(not_found | ...) for a file whose status cannot be read.
std::vector<std::byte> identity_of_build(const std::vector<std::filesystem::path>& files, const BuildOptions& options);

}  // namespace pcm
