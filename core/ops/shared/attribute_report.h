// What operations that compute from neighbours report, and the choice of their backend.
#pragma once

#include "pcm/filter/filter_report.h"
#include "pcm/filter/neighbour_attributes.h"
#include "pcm/ops/operation.h"

namespace pcm::ops {

// level, points_checked, errors; and the outcome and notes of the head.
void put_report(Result& result, const FilterReport& report);
std::vector<ResultKey> with_report_keys(std::vector<ResultKey> keys);

// The same and what attributes have of their own: values and lines.
void put_attribute_report(Result& result, const WantedValues& wanted, const NeighbourAttributeReport& report);
std::vector<ResultKey> attribute_keys();

// --flann, shown where it is built.
void flann_argument(Arguments& arguments, bool& flann);

}  // namespace pcm::ops
