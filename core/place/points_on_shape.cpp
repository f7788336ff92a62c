#include "pcm/place/grow_shape.h"
#include "pcm/place/near_shape.h"
#include "pcm/select/point_scan.h"

#include <mutex>
#include <string>

namespace pcm {

PointSet points_on_shape(const std::shared_ptr<const Tree>& tree, const Shape& shape, double threshold,
                         double normal_angle, const Selection& limit, unsigned threads,
                         const ProgressFunction& progress)
{
    const NearShape near(shape, threshold, normal_angle, tree->info().schema);
    PointSet set(tree);
    std::mutex mutex;
    ScanOptions options;
    options.test = &near;
    options.select.threads = threads;
    options.select.progress = progress;
    options.stage = "Finding the points of the " + std::string(traits_of(shape.kind).name);
    scan_points(*tree, limit, options, [&](const ScannedPoints& found) {
        const std::lock_guard lock(mutex);
        set.set(found.node, found.numbers);
    });
    return set;
}

}  // namespace pcm
