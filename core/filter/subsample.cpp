#include "pcm/filter/subsample.h"

#include "pcm/filter/numbered_points.h"
#include "pcm/filter/spaced_points.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/tree_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pcm {
namespace {

constexpr double most_spacings = 0x1p42;  // as KeptPoints allows

void check(const SubsampleOptions& options, const TreeInfo& info)
{
    const auto refuse = [](const std::string& what, const std::string& hint) {
        throw Error(ErrorCode::invalid_argument, {}, what, hint);
    };
    if (options.spacing.has_value() == options.points.has_value())
        refuse(options.spacing ? "both a spacing and a number of points were given"
                               : "neither a spacing nor a number of points was given",
               "give one of the two");
    if (options.points && *options.points == 0) refuse("0 points were asked for", "give a positive number");
    if (!options.spacing) return;
    const double spacing = *options.spacing;
    if (!(spacing > 0) || !std::isfinite(spacing))
        refuse("the spacing is " + exact(spacing) + "; it must be a positive number",
               "give the minimum distance between points, in the cloud's unit");
    const Box3d box = info.bounds();
    for (std::size_t a = 0; options.exact && a < 3 && !box.empty(); ++a) {
        const double far = std::max(std::fabs(box.min[a]), std::fabs(box.max[a]));
        if (box.extent(a) / spacing > most_spacings || far / spacing > 0x1p51)
            refuse("the spacing, " + exact(spacing) + ", is too small for a cloud of coordinates up to " + brief(far),
                   "give a larger one, or move and scale the cloud");
    }
    if (options.exact && !(spacing * spacing >= 0x1p-1000 && spacing * spacing <= 0x1p1000))
        refuse("the spacing, " + exact(spacing) + ", has no square among doubles", "scale the cloud");
}

unsigned chunks_ahead(unsigned threads) { return std::min(thread_count(threads), 8u); }

}  // namespace

ChosenLevel choose_level(const Tree& tree, const SubsampleOptions& options)
{
    const std::vector<LevelSummary> levels = tree.level_summaries();
    ChosenLevel chosen;
    if (levels.empty()) return chosen;
    if (options.points) {
        chosen.level = tree.level_with_at_most(*options.points);
    } else {
        double best = std::numeric_limits<double>::infinity(), before = 0;
        for (std::size_t k = 0; k < levels.size(); ++k) {
            // A cloud of a single level has no spacing to compare with.
            const double spacing = levels[k].spacing > 0 ? levels[k].spacing : before / 2;
            const double ratio = spacing > 0 ? std::fabs(std::log(spacing / *options.spacing)) : 0;
            if (ratio < best) {
                best = ratio;
                chosen.level = static_cast<std::uint16_t>(k);
            }
            before = spacing;
        }
    }
    chosen.spacing = levels[chosen.level].spacing;
    chosen.points = levels[chosen.level].points_to_here;
    return chosen;
}

std::string level_caveat(const Tree& tree)
{
    const TreeInfo& info = tree.info();
    if (!info.coverage_kept)
        return "points were deleted since the levels were made: where they were, other points may be missing; compact "
               "the tree first, or thin to an exact spacing";
    if (info.sampling == Sampling::grid)
        return "the levels have one point per cell of a lattice (a fast build): points can be nearer to each other "
               "than "
               "the spacing; thin to an exact spacing if that matters";
    if (tree.part_roots().size() > 1)
        return "points were appended since the levels were made: every point has one of the level within twice the "
               "spacing, not once; compact the tree first, or thin to an exact spacing";
    return {};
}

std::unique_ptr<PointReader> open_subsample(std::shared_ptr<const Tree> tree, const SubsampleOptions& options)
{
    check(options, tree->info());
    if (options.exact && options.spacing)
        return std::make_unique<SpacedPoints>(std::move(tree), *options.spacing, options.memory_bytes, options.threads);
    if (options.exact)
        return std::make_unique<NumberedPoints>(std::move(tree), *options.points, chunks_ahead(options.threads));
    const std::uint16_t level = choose_level(*tree, options).level;
    return std::make_unique<TreeReader>(std::move(tree), level, Selection(), chunks_ahead(options.threads));
}

SubsampleReport subsample(const std::filesystem::path& tree, const SubsampleOptions& options,
                          const ResultOptions& result)
{
    SubsampleOptions own = options;
    own.memory_bytes = result.reader_memory();
    own.threads = result.threads;
    SubsampleReport report;
    std::uint64_t points_in = 0;
    report.build = build_result(tree, result, [&](std::shared_ptr<const Tree> from) -> std::shared_ptr<PointReader> {
        points_in = from->info().points;
        std::shared_ptr<PointReader> points = open_subsample(from, own);  // throws for options out of range
        if (!own.exact) report.level = choose_level(*from, own);
        if (!own.exact || own.points) report.caveat = level_caveat(*from);
        return points;
    });
    report.build.outcome.points_in = points_in;
    return report;
}

}  // namespace pcm
