// What the filters that compute attributes of points from their neighbours have in common.
#pragma once

#include "pcm/filter/neighbour_attributes.h"
#include "plugin/filter/filter.h"

namespace pcm::host {

// "Neighbours".
void add_neighbours_parameter(RichParameterList& parameters, int usual, const QString& meaning);
std::size_t neighbours_of(const RichParameterList& parameters);

// "MaxDistance", "Level", "TimeLimit", "ErrorTarget".
void add_precision_parameters(RichParameterList& parameters);
void read_precision(const RichParameterList& parameters, NeighbourAttributeOptions& options);

// Three numbers of a parameter; nothing where it is empty. Throws Error(invalid_argument), naming `label`.
std::optional<Vec3d> three_numbers_of(const RichParameterList& parameters, const char* name, const char* label);

// Runs the filter on the chosen tree ("Tree", "Output", "InPlace", "MemoryMB", "Threads"), logs its outcome, and shows
// the result.
void run_attribute_filter(const FilterRun& run, NeighbourAttributeOptions options);

}  // namespace pcm::host
