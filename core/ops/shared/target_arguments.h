// The tree that an operation changes, and where the result goes: a copy, or the tree itself.
#pragma once

#include "pcm/ops/operation.h"
#include "pcm/update/target.h"

#include <string>

namespace pcm::ops {

struct TargetArguments {
    std::string tree, output;
    bool in_place = false, overwrite = false;
    // `lost`: attributes of these names that the operation did not make are written with --overwrite alone; empty: it
    // writes none.
    void declare_tree(Arguments& arguments);
    // The same for a step of a chain, which files are given to as well (shared/chain.h).
    void declare_cloud(Arguments& arguments);
    void declare_target(Arguments& arguments, const std::string& lost);
    // The same for commands that change the tree itself where no output is named: in_place is for dialogs alone.
    void declare_copy(Arguments& arguments);
    // Throws ArgumentError unless exactly one of the two was given, or, after declare_copy(), at most one.
    TargetChoice choice(Face face, const Arguments& arguments) const;
    // What was changed, for the result.
    void describe(Result& result, const std::string& changed) const;

private:
    bool changes_itself_ = false;
};

}  // namespace pcm::ops
