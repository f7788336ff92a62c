// Which points of a face are its own, and not those of surfaces that meet it.
#include "pcm/detect/face_interior.h"

#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double face_threshold = 0.006;

// A flange of 2 m by 0.1 m, a web on its second half, a pipe through it, and its lower face.
class FaceInteriorTest : public testing::Test {
protected:
    static MeetingSurface flat(const Vec3d& point, const Vec3d& axis, const Box3d& box)
    {
        MeetingSurface surface;
        surface.shape.point = point;
        surface.shape.axis = axis;
        surface.box = box;
        surface.threshold = face_threshold;
        std::vector<Vec3d> corners;
        for (int c = 0; c < 8; ++c)
            corners.push_back(
                {c & 1 ? box.max[0] : box.min[0], c & 2 ? box.max[1] : box.min[1], c & 4 ? box.max[2] : box.min[2]});
        surface.outline.emplace(corners, surface.shape);
        return surface;
    }
    static MeetingSurface pipe(double x)
    {
        MeetingSurface surface;
        surface.shape = {ShapeKind::cylinder, {x, 0.05, 0}, {0, 0, 1}, 0.02, 0};
        surface.box = {{x - 0.02, 0.03, -1}, {x + 0.02, 0.07, 1}};
        surface.threshold = face_threshold;
        return surface;
    }
    FaceInteriors faces_ = FaceInteriors({flat({}, {0, 0, 1}, {{0, 0, 0}, {2, 0.1, 0}}),
                                          flat({0, 0.05, 0}, {0, 1, 0}, {{1, 0.05, 0}, {2, 0.05, 0.3}}), pipe(0.5),
                                          flat({0, 0, -0.005}, {0, 0.1, 1}, {{0, 0, -0.005}, {2, 0.1, -0.005}})});
    bool is_inside(double x, double y) const { return faces_.inside(0, {{0, 0, 0}, {2, 0.1, 0}})->has({x, y, 0}); }
};

TEST_F(FaceInteriorTest, BordersAreNotInside)
{
    const double border = 1.5 * face_threshold;
    EXPECT_TRUE(is_inside(0.2, 0.05));
    for (const double beyond : {-0.0001, 0.0001}) {
        const bool is_in = beyond > 0;
        EXPECT_EQ(is_inside(0.2, border + beyond), is_in);
        EXPECT_EQ(is_inside(0.2, 0.1 - border - beyond), is_in);
        EXPECT_EQ(is_inside(border + beyond, 0.05), is_in);
        EXPECT_EQ(is_inside(2 - border - beyond, 0.02), is_in);
    }
}

TEST_F(FaceInteriorTest, PointsNextToSurfacesThatMeetItAreNotInside)
{
    EXPECT_TRUE(is_inside(0.9, 0.05)) << "the web begins at 1 m; the lower face is nearly parallel";
    EXPECT_FALSE(is_inside(0.996, 0.05)) << "next to its end";
    EXPECT_FALSE(is_inside(1.5, 0.05));
    EXPECT_FALSE(is_inside(1.5, 0.0555));
    EXPECT_TRUE(is_inside(1.5, 0.0565));
    EXPECT_FALSE(is_inside(0.5, 0.0695)) << "on the pipe";
    EXPECT_FALSE(is_inside(0.5, 0.0755));
    EXPECT_TRUE(is_inside(0.5, 0.0765));
    EXPECT_TRUE(is_inside(0.5, 0.05)) << "on its axis";
}

// Surfaces that are not in a box are not looked at for its points.
TEST_F(FaceInteriorTest, BoxesChooseTheSurfacesThatMatter)
{
    const Vec3d at_web{1.5, 0.05, 0};
    EXPECT_FALSE(faces_.inside(0, {{1.4, 0, 0}, {1.6, 0.1, 0}})->has(at_web));
    EXPECT_TRUE(faces_.inside(0, {{0.2, 0, 0}, {0.4, 0.1, 0}})->has(at_web));
    EXPECT_FALSE(faces_.inside(2, {{0, 0, 0}, {2, 0.1, 0}})) << "a pipe is not a face";
}

}  // namespace
