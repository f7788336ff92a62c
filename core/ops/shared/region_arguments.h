// Arguments that select points: regions, clips and conditions.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/ops/argument.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pcm::ops {

// box; one of sphere, oriented_box, ray, cone, frustum, planes, polygon, or region with any region in words; clip and
// clip_outside; where. Dialogs have box, region, clips and conditions: a field for each shape would say nothing that
// region does not.
class RegionArguments {
public:
    // `group`: their heading in the help of the command.
    void declare(Arguments& arguments, const std::string& group);
    // clip, clip_outside and where alone.
    void declare_limits(Arguments& arguments, const std::string& group);
    // Throws Error(invalid_argument) for more than one region, for a box that no point can be in, and everything that
    // parse_region() and parse_condition() throw.
    Selection get() const;

private:
    std::optional<Region> region() const;

    std::vector<double> box_;
    std::string region_;
    std::vector<std::string> where_, clips_, clips_outside_;
    std::map<std::string, std::vector<std::string>> shapes_;  // numbers as they were written, by the shape's name
};

}  // namespace pcm::ops
