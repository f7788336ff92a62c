// The final fit of faces whose points next to other surfaces are some of the others' points.
#include "pcm/detect/final_fit.h"

#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double flange_noise = 0.0015, flange_threshold = 0.006, flange_width = 0.1;

// A flange 2 m long at z = 0, the first part, and a web on the middle of it, the second one.
class NarrowFacesTest : public testing::Test {
protected:
    void add(double x, double y, double z) { points_.push_back({{x, y, z}, {}}); }
    void add_flange(std::size_t count)
    {
        for (std::size_t i = 0; i < count; ++i)
            add(dice_.between(0, 2), dice_.between(0, flange_width), flange_noise * dice_.normal());
    }
    // Points of a side of the flange, of which the threshold gives the flange those up to its own.
    void add_side(std::size_t count)
    {
        for (std::size_t i = 0; i < count; ++i)
            add(dice_.between(0, 2), flange_width + 0.0005 * dice_.normal(), -flange_threshold * dice_.unit());
    }
    // From `height` on; what is below the threshold is the flange's.
    void add_web(std::size_t count, double height)
    {
        for (std::size_t i = 0; i < count; ++i)
            add(dice_.between(0, 2), flange_width / 2 + 0.0005 * dice_.normal(), height * dice_.unit());
    }
    FinalFit fit(double noise = 0)
    {
        const auto tree = build_surface_tree(folder_.path(), points_);
        AssignedPoints assigned;
        assigned.parts.resize(2);
        assigned.numbers = {{0, 0}, {1, 1}};
        assigned.parts[1].hypothesis = 1;
        std::vector<Hypothesis> planes(2);
        planes[1].shape.axis = {0, 1, 0};
        planes[1].shape.point = {0, flange_width / 2, 0};
        for (Hypothesis& plane : planes) plane.threshold = flange_threshold;
        PointLabels labels(*tree);
        for (const PlacedPoint& p : all_points(*tree)) {
            const std::uint32_t part = p.position[2] > flange_threshold;
            const std::uint32_t label = part + 1;
            labels.set(p.node, {p.number}, &label);
            assigned.parts[part].box.extend(p.position);
            ++assigned.parts[part].points;
            ++assigned.parts[part].sampled;
        }
        FinalFitOptions options;
        options.least_points = 100;
        options.is_automatic = noise > 0;
        options.noise = noise;
        options.cell = 0.01;
        options.progress = [](double) {};
        return fit_parts(ChosenPoints(tree, {}), planes, assigned, labels, options);
    }
    static double angle_of(const Primitive& flange) { return length(cross(flange.fit.shape.axis, {0, 0, 1})); }
    static double height_of(const Primitive& flange)
    {
        return std::fabs(signed_distance(flange.fit.shape, {1, flange_width / 2, 0}));
    }

    TemporaryFolder folder_;
    Dice dice_{3};
    std::vector<SurfacePoint> points_;
};

// Errors as chance alone leaves them: noise / root of the points / standard deviation of their places across.
constexpr double chance_of(double points) { return flange_noise / (0.2887 * flange_width) / points; }

TEST_F(NarrowFacesTest, PointsOfASideDoNotTurnTheFace)
{
    add_flange(900);
    add_side(100);
    const FinalFit found = fit();
    ASSERT_EQ(found.primitives.size(), 1u);
    const Primitive& flange = found.primitives[0];
    const double chance = chance_of(30);  // root of 900
    EXPECT_LE(angle_of(flange), 3 * flange.fit.errors.angle);
    EXPECT_LE(angle_of(flange), 5 * chance) << "those points alone turn it by ten";
    EXPECT_LE(height_of(flange), 3 * flange.fit.errors.position);
    EXPECT_LE(flange.fit.errors.angle, 2 * chance) << "most of the width is left";
    EXPECT_GE(flange.points, 995u) << "they are within the threshold";
    EXPECT_NEAR(flange.fit.noise, flange_noise, 0.1 * flange_noise);
}

TEST_F(NarrowFacesTest, PointsOfAWebDoNotShiftTheFace)
{
    add_flange(900);
    add_web(2000, 0.15);  // 80 within the threshold
    const FinalFit found = fit();
    ASSERT_EQ(found.primitives.size(), 2u);
    const Primitive& flange = found.primitives[1];
    EXPECT_LE(height_of(flange), 3 * flange.fit.errors.position);
    EXPECT_LE(flange.fit.errors.position, 1.5 * flange_noise / 30);
}

// Three scan lines along the face: without the two at its border nothing shows its angle.
TEST_F(NarrowFacesTest, FacesThatTheirMiddleDoesNotDetermineKeepTheirBorder)
{
    for (int i = 0; i < 900; ++i) add(dice_.between(0, 2), flange_width / 2 * (i % 3), flange_noise * dice_.normal());
    const FinalFit found = fit();
    ASSERT_EQ(found.primitives.size(), 1u);
    EXPECT_LE(angle_of(found.primitives[0]), 3 * found.primitives[0].fit.errors.angle);
    EXPECT_LE(found.primitives[0].fit.errors.angle, 1.5 * chance_of(30));
    EXPECT_GE(found.primitives[0].points, 895u);
}

// Whether a second search looks at a face again does not depend on how well its middle fits.
TEST_F(NarrowFacesTest, FacesWithPointsOfOthersAreContested)
{
    add_flange(900);
    EXPECT_EQ(fit(flange_noise).contested, std::vector<bool>{false});
    add_side(300);
    EXPECT_EQ(fit(flange_noise).contested, std::vector<bool>{true});
}

}  // namespace
