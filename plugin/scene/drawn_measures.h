// What measures look like in views.
#pragma once

#include "pcm/measure/measure.h"
#include "plugin/scene/annotations.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm::host {

// The lines, marks and labels of all measures that are not hidden. `unit` is that of lengths, or empty. The measure
// `selected` has a colour of its own.
std::vector<Annotation> drawn_measures(const std::vector<Measure>& measures, const std::string& unit,
                                       std::optional<std::size_t> selected);

// Drawn from the known points of a measure that is being made.
Annotation drawn_draft(MeasureKind kind, const std::vector<MeasuredPoint>& points);

}  // namespace pcm::host
