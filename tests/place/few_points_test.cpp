// Few points within the size of a leaf.
#include "pcm/place/few_points.h"

#include "tests/place/shape_cloud.h"

#include <memory>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

// The verdict on a good plane of this many points, half as wide as that.
FittedPrimitive small_plane(int count, double half, double metres_per_unit)
{
    pcm::Shape plane;
    plane.point = {456780, 5432100, 120};
    plane.axis = {0, 0, 1};
    Dice dice(3);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < count; ++i) points.push_back(point_on(plane, half, 0, 0.001, dice));
    TemporaryFolder folder;
    const auto tree = build_surface_tree(folder.path(), points);
    FittedPrimitive result{{}, PointSet::all_of(tree), {}, {}, {}, 0, 0, true, 1, {}, {}, {}};
    result.primitive.fit.verdict = FitVerdict::good;
    doubt_small(result, metres_per_unit, 1);
    result.points = PointSet(tree);
    return result;
}

TEST(FewPoints, ALeafIsDoubted)
{
    const ShapeFit leaf = small_plane(300, 0.03, 1).primitive.fit;
    EXPECT_EQ(leaf.verdict, FitVerdict::doubtful);
    EXPECT_NE(leaf.message.find("300 points"), std::string::npos) << leaf.message;
}

TEST(FewPoints, FewPointsOfALargeSurfaceAndManyOfASmallOneAreNot)
{
    EXPECT_EQ(small_plane(300, 0.5, 1).primitive.fit.verdict, FitVerdict::good);
    EXPECT_EQ(small_plane(500, 0.03, 1).primitive.fit.verdict, FitVerdict::good);
}

// Units of a millimetre.
TEST(FewPoints, SizesAreMetres)
{
    EXPECT_EQ(small_plane(300, 30, 0.001).primitive.fit.verdict, FitVerdict::doubtful);
    EXPECT_EQ(small_plane(300, 0.03, 1000).primitive.fit.verdict, FitVerdict::good);
}

}  // namespace
