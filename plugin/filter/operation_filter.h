// A row of the table of operations (core/ops) as a filter.
#pragma once

#include "pcm/ops/operation.h"
#include "plugin/filter/filter.h"

#include <string>

namespace pcm::host {

// What a filter does besides: for operations whose inputs or results live in the window too.
struct OperationHooks {
    // Before the operation runs; the arguments are set. Fills in what the window has.
    std::function<void(const FilterRun& run, ops::Operation& operation, ops::Window& window)> before;
    // After it, in place of showing the tree that it has made.
    std::function<void(const FilterRun& run, const ops::Operation& operation, const ops::Result& result)> after;
};

// Shows the tree that was made in place of the layer that shows its input, or loads the layers again that show one
// changed in place.
void show_made(const FilterRun& run, const ops::Result& result);
// Runs `show`, which returns lines for the log, after the filter has changed a tree: what fails then is a warning.
void show_afterwards(const FilterRun& run, const std::function<std::vector<std::string>()>& show);

// `row` has a title, and is one of the table's.
Filter operation_filter(const ops::Row& row, OperationHooks hooks);

}  // namespace pcm::host
