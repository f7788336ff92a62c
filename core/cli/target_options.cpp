#include "pcm/cli/target_options.h"

#include "pcm/cli/common.h"

namespace pcm::cli {

void TargetOptions::add_to(Options& options)
{
    options.option("-o,--output", output,
                   "Tree folder to write: a copy that shares unchanged data with the original where the file system "
                   "allows");
    options.flag("--in-place", in_place, "Change the tree itself, atomically");
}

TargetChoice TargetOptions::get() const
{
    if (output.empty() && !in_place)
        throw UsageError("no output is given: give -o COPY, a tree to write, or --in-place to change this one");
    if (!output.empty() && in_place) throw UsageError("give either -o COPY, a tree to write, or --in-place, not both");
    return {output, in_place, overwrite};
}

void TargetOptions::add_overwrite(Options& options, const std::string& names)
{
    const std::string of_names =
        "; also write " + names + " where the tree has an attribute of this name from elsewhere, whose values are lost";
    options.flag("--overwrite", overwrite,
                 "Replace an existing tree of the output's name" + (names.empty() ? "" : of_names));
}

}  // namespace pcm::cli
