#include "plugin/tools/select/chosen_points.h"

#include "pcm/cloud/region.h"
#include "pcm/select/front_points.h"
#include "pcm/select/point_scan.h"
#include "pcm/select/select_points.h"

#include <algorithm>
#include <mutex>

namespace pcm::host {

namespace {

class BallsTest : public PlaceTest {
public:
    explicit BallsTest(const std::vector<Ball>& balls)
    {
        for (const Ball& ball : balls) spheres_.push_back(Region::sphere(ball.centre, ball.radius));
    }
    BoxRelation relation(const Box3d& box) const override
    {
        BoxRelation found = BoxRelation::outside;
        for (const Region& sphere : spheres_) found = std::max(found, sphere.relation(box));
        return found;
    }
    bool holds(const Vec3d& p) const override
    {
        return std::any_of(spheres_.begin(), spheres_.end(), [&](const Region& sphere) { return sphere.contains(p); });
    }

private:
    std::vector<Region> spheres_;
};

}  // namespace

PointSet points_of(PointCloud& cloud, const Query& query)
{
    SelectOptions options;
    options.progress = query.progress;
    return select_points(cloud.tree(), query.selection(), options);
}

PointSet points_in_balls(PointCloud& cloud, const Query& shown, const std::vector<Ball>& balls)
{
    const BallsTest test(balls);
    const auto tree = cloud.tree();
    ScanOptions options;
    options.test = &test;
    options.select.progress = shown.progress;
    PointSet set(tree);
    std::mutex mutex;
    scan_points(*tree, shown.selection(), options, [&](const ScannedPoints& points) {
        const std::lock_guard<std::mutex> lock(mutex);
        set.combine(SetOperation::add, points.node, points.numbers);
    });
    return set;
}

PointSet points_in_front(PointCloud& cloud, const Query& shown, const Camera& camera, const std::vector<Vec2d>& polygon)
{
    FrontOptions options;
    options.shown = shown.selection();
    options.select.progress = shown.progress;
    return front_points(cloud.tree(), camera, polygon, options);
}

PointSet points_around(PointCloud& cloud, const Query& shown, NodeId node, std::uint32_t point, double distance,
                       const SeedLimits& limits)
{
    GrowOptions options;
    options.limit = shown.selection();
    options.progress = shown.progress;
    return grow_from(cloud.tree(), node, point, distance, limits, options);
}

}  // namespace pcm::host
