// Primitives moved with their cloud.
#include "pcm/shapes/moved_primitive.h"

#include "pcm/shapes/shape_lines.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using namespace pcm;

constexpr Vec3d far_away{500000, 4800000, 100};

Primitive made(const char* shape)
{
    Primitive primitive;
    primitive.name = "one";
    primitive.fit.shape = parse_shape(shape);
    primitive.fit.errors.radius = 0.01;
    primitive.bounds.from = -1;
    primitive.bounds.to = 4;
    primitive.bounds.begin = 0.5;
    primitive.bounds.end = 2;
    if (primitive.fit.shape.kind != ShapeKind::plane) {
        const Vec3d axis = primitive.fit.shape.axis;
        primitive.bounds.zero = normalised(cross(axis, Vec3d{0.3, 0.2, 0.1}));
    } else {
        primitive.bounds.outline = {far_away, far_away + Vec3d{3, 0, 0}, far_away + Vec3d{3, 2, 0}};
    }
    return primitive;
}

// All that is drawn of it, moved, is what is drawn of it when it is moved.
TEST(MovedPrimitive, IsDrawnWhereItsPointsAre)
{
    const Affine map = [] {
        Affine turned = Affine::rotation({1, 2, 3}, 0.7, far_away);
        turned.target = turned.target + Vec3d{10, -20, 30};
        return turned;
    }();
    for (const char* text :
         {"plane 500000 4800000 100 0 0 1", "cylinder 500001 4800000 100 1 0 1 2", "sphere 500000 4800003 100 2",
          "cone 500000 4800000 101 0 1 1 30", "torus 500000 4800000 100 1 1 1 3 1"}) {
        const Primitive before = made(text), after = moved(before, map);
        const auto there = shape_lines(before.fit.shape, before.bounds),
                   here = shape_lines(after.fit.shape, after.bounds);
        ASSERT_EQ(there.size(), here.size()) << text;
        ASSERT_FALSE(there.empty()) << text;
        if (before.fit.shape.kind != ShapeKind::sphere)  // its circles are about x, y and z
            for (std::size_t i = 0; i < there.size(); ++i)
                if (!there[i].is_axis)  // a plane's is as long as the outline's box
                    for (std::size_t k = 0; k < there[i].points.size(); ++k)
                        EXPECT_LT(length(map(there[i].points[k]) - here[i].points[k]), 1e-8) << text;
        EXPECT_LT(length(map(before.fit.shape.point) - after.fit.shape.point), 1e-8) << text;
        EXPECT_EQ(after.fit.shape.radius, before.fit.shape.radius);
        EXPECT_EQ(after.fit.errors.radius, 0.01);
        EXPECT_NEAR(length(after.fit.shape.axis), 1, 1e-15);
    }
}

TEST(MovedPrimitive, SinglePrecisionIsARotation)
{
    Affine map = Affine::rotation({1, 2, 3}, 0.7, far_away);
    for (Vec3d& row : map.linear)
        for (double& number : row) number = static_cast<double>(static_cast<float>(number));
    const auto rotation = rotation_of(map.linear);
    ASSERT_TRUE(rotation);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LT(length((*rotation)[i] - map.linear[i]), 2e-7);
        for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(dot((*rotation)[i], (*rotation)[j]), i == j, 1e-15);
    }
}

TEST(MovedPrimitive, RefusesWhatIsNotRigid)
{
    const Primitive ball = made("sphere 0 0 0 1");
    const auto refused = [&](const Affine& map) {
        try {
            moved(ball, map);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            EXPECT_NE(std::string(error.what()).find("one cannot be moved"), std::string::npos) << error.what();
            return true;
        }
        return false;
    };
    EXPECT_FALSE(refused(Affine::translation({1, 2, 3})));
    EXPECT_TRUE(refused(Affine::rotation({0, 0, 1}, 1, {}, 1.001)));
    Affine mirror, shear;
    mirror.linear[0][0] = -1;
    shear.linear[0][1] = 0.001;
    EXPECT_TRUE(refused(mirror));
    EXPECT_TRUE(refused(shear));
    Affine nowhere;
    nowhere.target[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(refused(nowhere));
    nowhere = {};
    nowhere.linear[2][2] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(refused(nowhere));
}

}  // namespace
