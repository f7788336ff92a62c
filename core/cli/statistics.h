// The statistics of `pcmlab info --statistics`, as text and as JSON.
#pragma once

#include "pcm/cli/common.h"
#include "pcm/cloud/statistics.h"
#include "pcm/io/reader.h"

namespace pcm::cli {

// Reads all points. Throws what reading throws, and Error(cancelled).
CloudStatistics collect_statistics(PointReader& cloud, const ProgressFunction& progress);

Json json_of_statistics(const CloudStatistics& statistics, const Schema& schema);
void print_statistics(const CloudStatistics& statistics, const Schema& schema);

}  // namespace pcm::cli
