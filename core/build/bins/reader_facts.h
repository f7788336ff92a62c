// What readers know only when they have read a cloud.
#pragma once

#include "pcm/build/bins/bins.h"

namespace pcm {

// Adds the notes, metadata and counts of a reader that is at its end to what was found.
void take_reader_facts(const FileInfo& info, Ingested& found);

}  // namespace pcm
