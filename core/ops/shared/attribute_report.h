// What operations that compute from neighbours report, and the choice of their backend.
#pragma once

#include "pcm/filter/filter_report.h"
#include "pcm/filter/neighbour_attributes.h"
#include "pcm/ops/operation.h"

namespace pcm::ops {

// The outcome and notes of the head; exact.
void put_report(Result& result, const FilterReport& report);

// The same and what attributes have of their own: values and lines.
void put_attribute_report(Result& result, const WantedValues& wanted, const NeighbourAttributeReport& report);
std::vector<ResultKey> attribute_keys();

// --flann, shown where it is built.
void flann_argument(Arguments& arguments, bool& flann);

}  // namespace pcm::ops
