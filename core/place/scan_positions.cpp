#include "pcm/place/scan_positions.h"

#include "pcm/tree/source_rounding.h"

namespace pcm {

void scan_positions(const PointSet& set, const std::string& stage, unsigned threads, const ProgressFunction& progress,
                    const std::function<void(const ScannedPoints&, const std::vector<Vec3d>&)>& take)
{
    const Tree& tree = set.tree();
    const SourceRounding rounding(tree.info());
    ScanOptions options;
    options.within = &set;
    options.columns = ColumnSet::only_positions();
    options.select.threads = threads;
    options.select.progress = progress;
    options.stage = stage;
    scan_points(tree, {}, options,
                [&](const ScannedPoints& found) { take(found, source_positions(found, tree.info().grid, rounding)); });
}

}  // namespace pcm
