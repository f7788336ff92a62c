// Fits that are made again where an answer is not good.
#include "pcm/place/fit_again.h"

#include "tests/place/shape_cloud.h"

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double again_noise = 0.0015;
constexpr Vec3d elbow_middle{456780, 5432100, 120};

pcm::Shape elbow_shape()
{
    pcm::Shape shape;
    shape.kind = ShapeKind::torus;
    shape.point = elbow_middle;
    shape.axis = {0, 0, 1};
    shape.radius = 0.2;
    shape.second = 0.05;
    return shape;
}

pcm::Shape pipe_at_its_end()
{
    pcm::Shape shape;
    shape.kind = ShapeKind::cylinder;
    shape.point = elbow_middle + Vec3d{0.2, 0, 0};
    shape.axis = {0, 1, 0};
    shape.radius = 0.05;
    return shape;
}

// A cloud of one shape, of which a doubtful answer was found, and the answers of other fits.
class FitAgainTest : public testing::Test {
protected:
    void build(const pcm::Shape& shape, double size)
    {
        Dice dice(3);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 4000; ++i) points.push_back(point_on(shape, size, pi / 2, again_noise, dice));
        tree_ = build_surface_tree(folder_.path(), points);
    }
    FittedPrimitive answer(const pcm::Shape& shape, FitVerdict verdict, double share = 1) const
    {
        const double end = elbow_middle[1] + 0.3 * share;
        FittedPrimitive found{
            {}, set_where(tree_, [&](const Vec3d& p) { return p[1] < end; }), {}, {}, {}, 0, 0, false, 1, {}, {}, {},
            {}};
        ShapeFit& fit = found.primitive.fit;
        fit.shape = shape;
        fit.verdict = verdict;
        if (verdict != FitVerdict::good) fit.issue = issue_;
        fit.noise = again_noise;
        fit.threshold = 3 * again_noise;
        fit.inliers = found.points.size();
        return found;
    }
    // The kind that is answered.
    ShapeKind kind_after(FittedPrimitive found, double most_noise = 0.002)
    {
        asked_.clear();
        const FitAgain fit = [&](const Vec3d& place, const std::vector<ShapeKind>& kinds,
                                 const std::optional<Clip>& part) {
            EXPECT_FALSE(part);
            EXPECT_EQ(place, place_);
            EXPECT_EQ(kinds.size(), 1u);
            asked_.push_back(kinds.front());
            return kinds.front() == ShapeKind::torus ? answer(elbow_shape(), verdict_, share_)
                                                     : answer(pipe_at_its_end(), FitVerdict::doubtful);
        };
        return or_higher_kind(std::move(found), place_, most_noise, kinds_, fit, 1).primitive.fit.shape.kind;
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    const Vec3d place_ = elbow_middle + Vec3d{0.25, 0.01, 0};
    std::vector<ShapeKind> kinds_{ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone,
                                  ShapeKind::torus};
    FitVerdict verdict_ = FitVerdict::good;
    FitIssue issue_ = FitIssue::no_consensus;
    double share_ = 1;
    std::vector<ShapeKind> asked_;
};

TEST_F(FitAgainTest, AGoodShapeOfMoreNumbersIsTakenForADoubtfulOne)
{
    build(elbow_shape(), 0);
    EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::doubtful)), ShapeKind::torus);
    EXPECT_EQ(asked_, (std::vector<ShapeKind>{ShapeKind::cone, ShapeKind::torus}));
    verdict_ = FitVerdict::doubtful;
    EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::doubtful)), ShapeKind::cylinder);
}

TEST_F(FitAgainTest, NothingIsAskedForWhereItIsGoodOrRoughOrFlatOrOfTheOnlyKind)
{
    build(elbow_shape(), 0);
    EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::good)), ShapeKind::cylinder);
    EXPECT_TRUE(asked_.empty());
    EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::doubtful), 0.9 * again_noise), ShapeKind::cylinder);
    EXPECT_TRUE(asked_.empty());
    EXPECT_EQ(kind_after(answer({}, FitVerdict::doubtful)), ShapeKind::plane);
    EXPECT_TRUE(asked_.empty());
    EXPECT_EQ(kind_after(answer(elbow_shape(), FitVerdict::doubtful)), ShapeKind::torus);
    EXPECT_TRUE(asked_.empty());
    for (const FitIssue issue : {FitIssue::uneven, FitIssue::thin_arc}) {
        issue_ = issue;
        EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::doubtful)), ShapeKind::cylinder);
        EXPECT_TRUE(asked_.empty());
    }
    issue_ = FitIssue::other_surface;
    EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::doubtful, 0.01)), ShapeKind::cylinder) << "few points";
    EXPECT_TRUE(asked_.empty());
    EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::doubtful)), ShapeKind::torus);
    kinds_ = {ShapeKind::cylinder};
    asked_.clear();
    EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::doubtful)), ShapeKind::cylinder);
    EXPECT_TRUE(asked_.empty());
}

// The torus of a straight pipe explains it no better, and one of few points shows nothing.
TEST_F(FitAgainTest, ItMustExplainEnoughPointsBetter)
{
    build(elbow_shape(), 0);
    share_ = 0.02;
    ASSERT_LT(answer(elbow_shape(), FitVerdict::good, share_).points.size(), 200u);
    EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::doubtful)), ShapeKind::cylinder);
    share_ = 1;
    build(pipe_at_its_end(), 0.02);
    EXPECT_EQ(kind_after(answer(pipe_at_its_end(), FitVerdict::doubtful)), ShapeKind::cylinder);
    EXPECT_EQ(asked_.size(), 2u);
}

// A wide sphere is flat around the place, and as a plane it cannot be followed.
TEST_F(FitAgainTest, AWideSphereIsTakenForAPlaneThatWasNotFollowed)
{
    pcm::Shape sphere;
    sphere.kind = ShapeKind::sphere;
    sphere.point = elbow_middle;
    sphere.radius = 1;
    build(sphere, 0);
    pcm::Shape plane;
    plane.point = elbow_middle + Vec3d{1, 0, 0};
    plane.axis = {1, 0, 0};
    asked_.clear();
    FitVerdict verdict = FitVerdict::good;
    const FitAgain fit = [&](const Vec3d&, const std::vector<ShapeKind>& kinds, const std::optional<Clip>&) {
        asked_.push_back(kinds.front());
        return kinds.front() == ShapeKind::sphere ? answer(sphere, verdict, share_)
                                                  : answer(pipe_at_its_end(), FitVerdict::doubtful);
    };
    const auto kind_of = [&](const std::string& left) {
        FittedPrimitive found = answer(plane, FitVerdict::doubtful);
        found.left_surface = left;
        return or_higher_kind(std::move(found), place_, 0.002, kinds_, fit, 1).primitive.fit.shape.kind;
    };
    EXPECT_EQ(kind_of("its points leave it"), ShapeKind::sphere);
    EXPECT_EQ(asked_, (std::vector<ShapeKind>{ShapeKind::cylinder, ShapeKind::sphere})) << "cones and tori are not";
    EXPECT_EQ(kind_of(""), ShapeKind::plane) << "it may be terrain";
    verdict = FitVerdict::doubtful;
    EXPECT_EQ(kind_of("its points leave it"), ShapeKind::plane);
    verdict = FitVerdict::good;
    share_ = -2.75;  // some 350 points
    EXPECT_EQ(kind_of("its points leave it"), ShapeKind::plane) << "as few points as leaves have";
}

TEST_F(FitAgainTest, ThePipeBehindAnElbowIsTakenForTheElbow)
{
    build(elbow_shape(), 0);
    FitVerdict verdict = FitVerdict::good;
    const FitAgain fit = [&](const Vec3d& place, const std::vector<ShapeKind>& kinds, const std::optional<Clip>& part) {
        EXPECT_FALSE(part);
        EXPECT_EQ(place, place_);
        EXPECT_EQ(kinds, std::vector<ShapeKind>{ShapeKind::cylinder});
        return answer(pipe_at_its_end(), verdict);
    };
    const auto kind_of = [&](FitVerdict of_elbow, double to) {
        FittedPrimitive found = answer(elbow_shape(), of_elbow);
        found.part.emplace();
        found.part->shape = elbow_shape();
        found.part->start = {-1, 0, 0};
        found.part->to = to;
        return or_pipe(std::move(found), place_, fit).primitive.fit.shape.kind;
    };
    EXPECT_EQ(kind_of(FitVerdict::doubtful, 3), ShapeKind::cylinder) << "the place is at half a turn";
    EXPECT_EQ(kind_of(FitVerdict::doubtful, 3.5), ShapeKind::torus) << "the elbow has the place";
    EXPECT_EQ(kind_of(FitVerdict::good, 3), ShapeKind::torus);
    verdict = FitVerdict::doubtful;
    EXPECT_EQ(kind_of(FitVerdict::doubtful, 3), ShapeKind::torus);
    EXPECT_EQ(or_pipe(answer(elbow_shape(), FitVerdict::doubtful), place_, fit).primitive.fit.shape.kind,
              ShapeKind::torus);
}

// Along y: 50 mm, and 42 behind y = 0.1.
TEST_F(FitAgainTest, APipeIsFollowedAsFarAsItsRadiusDoesNotChange)
{
    Dice dice(4);
    std::vector<SurfacePoint> points;
    pcm::Shape pipe = pipe_at_its_end();
    for (int i = 0; i < 8000; ++i) {
        const double way = dice.between(-1, 1), angle = dice.between(-1.4, 1.4);
        const Vec3d n{std::cos(angle), 0, std::sin(angle)};
        const double away = (way < 0.1 ? 0.05 : 0.042) + again_noise * dice.normal();
        points.push_back({pipe.point + way * pipe.axis + away * n, n});
    }
    tree_ = build_surface_tree(folder_.path(), points);
    const auto on = [&](double way) { return pipe.point + Vec3d{0.05, way, 0}; };
    const FittedPrimitive whole = answer(pipe, FitVerdict::good, 10);
    FitVerdict verdict = FitVerdict::good;
    ShapeKind kind = ShapeKind::cylinder;
    int asked = 0;
    double end = 0;
    const auto after = [&](const FittedPrimitive& found, double way, double spread = 0) {
        const FitAgain fit = [&](const Vec3d& place, const std::vector<ShapeKind>& kinds,
                                 const std::optional<Clip>& part) {
            ++asked;
            EXPECT_EQ(place, on(way));
            EXPECT_EQ(kinds, std::vector<ShapeKind>{ShapeKind::cylinder});
            const double side = way < 0.1 ? 1 : -1;
            for (end = -1.1; part && end < 1.1 && part->holds(on(side * end)); end += 0.001) {
            }
            end *= side;
            pcm::Shape other = pipe;
            other.kind = kind;
            return answer(other, verdict, 0.5);
        };
        return or_one_radius(found, on(way), spread, fit, 1);
    };
    const FittedPrimitive wide = after(whole, -0.5);
    EXPECT_EQ(asked, 1);
    EXPECT_LE(end, 0.1);
    EXPECT_GT(end, 0);
    EXPECT_LT(wide.points.size(), whole.points.size());
    ASSERT_FALSE(wide.notes.empty());
    EXPECT_NE(wide.notes.back().find("0.04"), std::string::npos) << wide.notes.back();
    after(whole, 0.7);
    EXPECT_GE(end, 0.099);
    EXPECT_LT(end, 0.2);
    asked = 0;
    const ShapeFit at_step = after(whole, 0.1).primitive.fit;
    EXPECT_EQ(asked, 0);
    EXPECT_EQ(at_step.verdict, FitVerdict::doubtful);
    EXPECT_EQ(at_step.issue, FitIssue::other_surface);
    EXPECT_EQ(after(whole, -0.5, 0.02).primitive.fit.verdict, FitVerdict::good) << "stations may be as far apart";
    EXPECT_EQ(asked, 0);
    pcm::Shape ball = pipe;
    ball.kind = ShapeKind::sphere;
    EXPECT_EQ(after(answer(ball, FitVerdict::good, 10), -0.5).primitive.fit.verdict, FitVerdict::good);
    EXPECT_EQ(asked, 0);
    verdict = FitVerdict::doubtful;
    EXPECT_EQ(after(whole, -0.5).primitive.fit.issue, FitIssue::other_surface);
    EXPECT_EQ(after(whole, -0.5).points.size(), whole.points.size());
    EXPECT_EQ(after(answer(pipe, FitVerdict::doubtful, 10), -0.5).primitive.fit.issue, issue_) << "its own doubt";
    verdict = FitVerdict::good;
    kind = ShapeKind::torus;
    EXPECT_EQ(after(whole, -0.5).primitive.fit.verdict, FitVerdict::doubtful);
}

}  // namespace
