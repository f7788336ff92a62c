// The statistics of a cloud, as text and as JSON.
#pragma once

#include "pcm/cloud/statistics.h"
#include "pcm/io/reader.h"
#include "pcm/ops/result.h"

namespace pcm::ops {

// Reads all points. Throws what reading throws, and Error(cancelled).
CloudStatistics collect_statistics(PointReader& cloud, const ProgressFunction& progress);

Json json_of_statistics(const CloudStatistics& statistics, const Schema& schema);
void print_statistics(Result& result, const CloudStatistics& statistics, const Schema& schema);

}  // namespace pcm::ops
