// A level of detail of a tree instead of all of its points: given, or chosen by the error that the answer may have.
#pragma once

#include "pcm/ops/accuracy.h"
#include "pcm/ops/argument.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <optional>
#include <string>

namespace pcm::ops {

// Throws Error(invalid_argument) for a level that the tree does not have.
void check_level(const Tree& tree, const std::optional<std::uint16_t>& level);

struct LevelArguments {
    std::optional<std::uint16_t> level;
    std::optional<double> error_target;  // source units

    // --level and --error-target. `help`: what only the points up to the level are taken for.
    void declare(Arguments& arguments, const std::string& help, const std::string& group = {});
    bool given() const { return level || error_target; }
    // The level to take, none for all points; the coarsest one whose level_spacing() is no larger than the error
    // target. Throws ArgumentError where both are given, and what check_level() throws.
    std::optional<std::uint16_t> of(const Tree& tree) const;
    // What taking it leaves out.
    static Accuracy accuracy(const Tree& tree, std::optional<std::uint16_t> level);
};

}  // namespace pcm::ops
