#include "pcm/ops/shared/level_arguments.h"

#include "pcm/query/nearest.h"
#include "pcm/system/error.h"

namespace pcm::ops {

void check_level(const Tree& tree, const std::optional<std::uint16_t>& level)
{
    const std::uint16_t levels = tree.info().levels;
    if (level && levels > 0 && *level >= levels)
        throw Error(ErrorCode::invalid_argument, tree.folder(),
                    "there is no level " + std::to_string(*level) + "; this tree has levels 0 to " +
                        std::to_string(levels - 1));
}

void LevelArguments::declare(Arguments& arguments, const std::string& help, const std::string& group)
{
    arguments.add("level", level).group(group).label("Level").help(help).without("all points");
    arguments.add("error_target", error_target)
        .not_negative()
        .unit("source units")
        .group(group)
        .label("Error target")
        .help("The coarsest level whose error is no larger: every point left out has one of the level nearer than this")
        .without("all points");
}

std::optional<std::uint16_t> LevelArguments::of(const Tree& tree) const
{
    if (level && error_target) throw ArgumentError("a level is given, and an error target that would choose it");
    check_level(tree, level);
    if (!error_target) return level;
    for (std::uint16_t l = 0; l + 1 < tree.info().levels; ++l)
        if (level_spacing(tree, l) <= *error_target) return l;
    return {};
}

Accuracy LevelArguments::accuracy(const Tree& tree, std::optional<std::uint16_t> level)
{
    return without_finer_levels(level ? level_spacing(tree, *level) : 0);
}

}  // namespace pcm::ops
