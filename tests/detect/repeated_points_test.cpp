// A cloud that was merged with copies of itself.
#include "pcm/detect/detect.h"

#include "tests/detect/checked_labels.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <memory>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

const Vec3d corner{512345, 4812345, 120};

std::vector<SurfacePoint> floor_pipe_and_ball()
{
    Dice dice(5);
    std::vector<SurfacePoint> points;
    const auto add = [&](const char* text, double size, int count) {
        pcm::Shape shape = parse_shape(text);
        shape.point = corner + shape.point;
        for (int i = 0; i < count; ++i) points.push_back(point_on(shape, size, 2 * pi, 0.002, dice));
    };
    add("plane 0 0 -5 0 0 1", 5, 15000);
    add("cylinder -3 -4 -3 0 1 0 0.3", 7, 6000);
    add("sphere 0 0 2 1.1", 0, 5000);
    return points;
}

DetectReport found_in(const std::vector<SurfacePoint>& points)
{
    const TemporaryFolder folder;
    const auto tree = build_surface_tree(folder.path(), points);
    DetectReport report = detect_primitives(tree, {});
    check_labels(*tree, report);
    return report;
}

// The distance of the nearest points is 0 there: each position counts once.
TEST(RepeatedPoints, PCM_NOT_UNDER_THREAD(HaveTheShapesOfOneCopy))
{
    const std::vector<SurfacePoint> once = floor_pipe_and_ball();
    std::vector<SurfacePoint> repeated;
    for (const SurfacePoint& p : once) repeated.insert(repeated.end(), 20, p);
    const DetectReport truth = found_in(once), report = found_in(repeated);
    EXPECT_NEAR(report.spacing, truth.spacing, 0.2 * truth.spacing);
    EXPECT_NEAR(report.noise, truth.noise, 0.3 * truth.noise);
    ASSERT_EQ(truth.primitives.size(), 3u);
    ASSERT_EQ(report.primitives.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        const ShapeFit &fit = report.primitives[i].fit, &alone = truth.primitives[i].fit;
        EXPECT_EQ(fit.shape.kind, alone.shape.kind);
        EXPECT_EQ(fit.verdict, FitVerdict::good) << fit.message;
        EXPECT_NEAR(fit.shape.radius, alone.shape.radius, 4 * alone.errors.radius);
        EXPECT_GT(report.primitives[i].points, 19 * truth.primitives[i].points);
        // Copies are no further measurements.
        EXPECT_GT(fit.errors.position, 0.6 * alone.errors.position);
    }
}

}  // namespace
