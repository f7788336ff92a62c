// The first stage of a build: points are read once and distributed to bins on disk that are small enough to work on in
// memory.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/bins/workspace.h"
#include "pcm/io/reader.h"
#include "pcm/tree/tree.h"

namespace pcm {

// Reads the cloud to its end and fills `found`, except for the metadata. Positions get the grid of the tree `like`
// where there is one; otherwise the cloud's grid where it has one, or one that is fine enough for all its doubles.
// Throws what the reader and the file system throw, and Error(cancelled).
AnyBins partition(PointReader& cloud, Workspace& work, Ingested& found, const TreeInfo* like = nullptr);

}  // namespace pcm
