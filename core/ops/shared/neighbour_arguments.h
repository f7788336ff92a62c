// Which neighbours attributes are computed from.
#pragma once

#include "pcm/filter/neighbour_attributes.h"
#include "pcm/ops/shared/target_arguments.h"
#include "pcm/ops/shared/work_arguments.h"

#include <optional>

namespace pcm::ops {

struct NeighbourArguments {
    std::uint32_t neighbours = 16;
    std::optional<double> max_distance;
    bool flann = false;
    WorkArguments work;
    // `meaning`: what the neighbours are for, as the end of a sentence.
    void declare(Arguments& arguments, const std::string& meaning);
    void put_into(NeighbourAttributeOptions& options, const std::string& called_memory) const;
};

// Computes the attributes, into a copy or in place, and reports.
Result compute_attributes(const Context& context, const TargetArguments& target, const Arguments& arguments,
                          NeighbourAttributeOptions options);

}  // namespace pcm::ops
