// Points at edges, where another surface meets the shape, are ignored in growth's least squares.

#include "pcm/place/inner_points.h"

#include "pcm/place/grow_shape.h"
#include "pcm/place/refit.h"
#include "pcm/place/tuning.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double sigma = 0.002;

TEST(EdgeCubes, CountWhatIsNextToAPlace)
{
    EdgeCubes cubes({0, 0, 0}, 1);
    for (int i = 0; i < 19; ++i) cubes.add({5.5, 5.5, 5.5}, true);
    cubes.add({5.5, 5.5, 6.5}, false);
    EXPECT_FALSE(cubes.is_edge({5.5, 5.5, 5.5}));  // one point may be noise
    cubes.add({6.5, 6.5, 6.5}, false);
    EXPECT_TRUE(cubes.is_edge({5.5, 5.5, 5.5}));
    EXPECT_FALSE(cubes.is_edge({4.5, 4.5, 5.5}));  // its neighbours have points of the shape alone
    cubes.add({5.5, 5.5, 5.5}, true);
    EXPECT_FALSE(cubes.is_edge({5.5, 5.5, 5.5}));  // a tenth
    EXPECT_FALSE(cubes.is_edge({50, 50, 50}));
}

TEST(EdgeCubes, AreDoubledWhereThereAreManyOrFewPointsInThem)
{
    EdgeCubes few({0, 0, 0}, 0.5);
    for (int i = 0; i < 100; ++i) few.add({1.0 * i, 0, 0}, true);
    few.widen();
    EXPECT_EQ(few.edge(), 4);
    EdgeCubes many({0, 0, 0}, 0.001, 1000), reversed({0, 0, 0}, 0.001, 1000);
    Dice dice(5);
    std::vector<Vec3d> points;
    for (int i = 0; i < 20000; ++i) points.push_back({dice.unit(), dice.unit(), 0});
    for (const Vec3d& p : points) many.add(p, p[0] < 0.5);
    for (auto p = points.rbegin(); p != points.rend(); ++p) reversed.add(*p, (*p)[0] < 0.5);
    EXPECT_EQ(many.edge(), 0.064);
    EXPECT_EQ(reversed.edge(), many.edge());
    for (const Vec3d& p : points) ASSERT_EQ(many.is_edge(p), reversed.is_edge(p));
    EXPECT_FALSE(many.is_edge({0.3, 0.5, 0}));
    EXPECT_TRUE(many.is_edge({0.49, 0.5, 0}));
    many.find_edges(place_tuning().growth.max_edge_share);
    for (const Vec3d& p : points) ASSERT_EQ(many.is_edge(p), reversed.is_edge(p));
    EXPECT_EQ(many.is_edge({0.49, 0.9, 0.06}), reversed.is_edge({0.49, 0.9, 0.06}));  // no points there
    for (int i = 0; i < 2000; ++i) many.add({0.3, 0.5, 0}, false);
    EXPECT_TRUE(many.is_edge({0.3, 0.5, 0}));  // found before more were added
    many.widen();
    EXPECT_EQ(many.edge(), 0.064);  // eighty points in each
}

// A strip of points off the shape, one in twenty, along points on it: in cubes that are doubled it counts as an edge.
TEST(EdgeCubes, CountNarrowStripsInDoubledCubes)
{
    EdgeCubes cubes({0, 0, 0}, 0.5);
    for (int i = 0; i < 60; ++i)
        for (int k = 0; k < 20; ++k) cubes.add({1.0 * i, 1.0 * k, 1}, true);
    for (int i = 0; i < 60; i += 3) cubes.add({1.0 * i, 19.5, 1}, false);
    cubes.widen();
    EXPECT_GE(cubes.edge(), 2);
    EXPECT_DOUBLE_EQ(cubes.share_of_edges(), place_tuning().growth.max_edge_share * 0.5 / cubes.edge());
    cubes.find_edges(cubes.share_of_edges());
    EXPECT_TRUE(cubes.is_edge({30, 18.5, 1}));
    EXPECT_FALSE(cubes.is_edge({30, 6.5, 1}));
    cubes.find_edges(place_tuning().growth.max_edge_share);
    EXPECT_FALSE(cubes.is_edge({30, 18.5, 1}));
}

// The face of a kerb, 20 cm high: the street at its foot and the pavement behind its top turn it about its length.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(InnerPoints, PCM_NOT_UNDER_THREAD(AKerbIsNotTurnedByTheSurfacesAtItsEdges))
{
    TemporaryFolder folder;
    Dice dice(8);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 6000; ++i)
        points.push_back({{sigma * dice.normal(), dice.between(0, 5), dice.between(0, 0.2)}, {}});
    for (int i = 0; i < 20000; ++i) {
        const double x = dice.between(-0.5, 0);
        points.push_back({{x, dice.between(0, 5), 0.2 + 0.6 * x + sigma * dice.normal()}, {}});
        points.push_back({{-x, dice.between(0, 5), 0.6 * x + sigma * dice.normal()}, {}});
    }
    const auto tree = build_surface_tree(folder.path(), points);
    Shape face;
    face.axis = {1, 0, 0};
    face.point = {0, 2.5, 0.1};
    const PointSet seeds =
        set_where(tree, [&](const Vec3d& p) { return distance_to(face, p) < 0.006 && std::fabs(p[2] - 0.1) < 0.05; });
    GrowShapeOptions options;
    options.threshold = 0.007;
    options.step = 0.1;
    const GrownShape grown = grow_shape(face, seeds, options);
    ASSERT_TRUE(grown.fit.has_shape());
    EXPECT_EQ(grown.fit.inliers, grown.points.size());
    EXPECT_GT(grown.around.size(), grown.points.size() + 100);
    EXPECT_LT(length(cross(grown.fit.shape.axis, face.axis)), 3.5 * grown.fit.errors.angle);
    // All of them turn it.
    RefitOptions refit;
    refit.threshold = options.threshold;
    const RefittedShape all = refit_shape(grown.points, face, refit);
    EXPECT_GT(length(cross(all.fit.shape.axis, face.axis)), 5 * all.fit.errors.angle);
    const PointSet inner = inner_points(grown.points, grown.around, face, options.threshold, 1);
    EXPECT_TRUE(inner == inner_points(grown.points, grown.around, face, options.threshold, 3));
    for (const PlacedPoint& p : all_points(*tree)) {
        if (!grown.points.contains(p.node, p.number)) continue;
        EXPECT_LE(distance_to(grown.fit.shape, p.position), grown.threshold + grown.farther);
        if (p.position[2] < 0.003 || p.position[2] > 0.197) EXPECT_FALSE(inner.contains(p.node, p.number));
        if (p.position[2] > 0.09 && p.position[2] < 0.11) EXPECT_TRUE(inner.contains(p.node, p.number));
    }
}

}  // namespace
