// Which of several kinds explains points best, and by how much.
#include "pcm/place/best_kind.h"

#include "tests/place/shape_cloud.h"

#include <cmath>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr Vec3d map{456780, 5432100, 120};
constexpr ShapeKind all_kinds[] = {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone,
                                   ShapeKind::torus};

TEST(BestKind, FewerParametersWhereTheyExplainAsMuch)
{
    Dice dice(6);
    std::vector<Vec3d> flat, bent;
    for (int i = 0; i < 2000; ++i) {
        const double x = dice.between(-1, 1), y = dice.between(-1, 1);
        flat.push_back({x, y, 0.01 * dice.normal()});
        bent.push_back({x, y, -0.5 * x * x + 0.01 * dice.normal()});
    }
    const auto kind_of = [&](const std::vector<Vec3d>& positions) {
        const FitPoints points = FitPoints::of(positions);
        std::vector<ShapeFit> fits;
        for (const ShapeKind kind : all_kinds) {
            ShapeFitOptions options;
            options.kind = kind;
            options.threshold = 0.04;
            fits.push_back(fit_shape(points, options));
        }
        const auto best = choose_kind(fits, points).best;
        return best ? traits_of(fits[*best].shape.kind).name : "none";
    };
    EXPECT_STREQ(kind_of(flat), "plane");
    EXPECT_STREQ(kind_of(bent), "cylinder");
    EXPECT_STREQ(kind_of({}), "none");
    EXPECT_LT(log_false_alarms(1000, 900, 3, 0.1), log_false_alarms(1000, 500, 3, 0.1));
    EXPECT_LT(log_false_alarms(1000, 900, 3, 0.05), log_false_alarms(1000, 900, 3, 0.1));
    EXPECT_EQ(log_false_alarms(1000, 3, 3, 0.1), 0);
    EXPECT_TRUE(std::isfinite(log_false_alarms(1000, 1000, 3, 0)));
}

// Each kind has its own threshold, as when it was wide enough for several surfaces; the noise that decides is one.
TEST(BestKind, EvidenceGrowsWithThePointsThatHaveErrorsOfTheirOwn)
{
    Dice dice(8);
    pcm::Shape wall, arc;
    wall.point = map;
    arc.kind = ShapeKind::cylinder;
    arc.radius = 4;
    arc.axis = {0, 1, 0};
    const auto evidence = [&](int count, double shared) {
        std::vector<Vec3d> points;
        double error = 0;
        for (int i = 0; i < count; ++i) {
            if (i % 40 == 0) error = shared * dice.normal();
            const double cell = shared > 0 ? i / 40 * 40.0 / count : dice.unit();
            const double x = -0.25 + 0.5 * cell, y = dice.between(-0.01, 0.01);
            points.push_back(map + Vec3d{x, y, -x * x / 8 + 0.0026 + 0.0015 * dice.normal() + error});
        }
        arc.point = map + Vec3d{0, 0, 0.0026 - 4};
        return KindComparison(FitPoints::of(points), 0.0015).evidence(arc, wall);
    };
    const double few = evidence(16, 0), more = evidence(1000, 0), many = evidence(4000, 0);
    EXPECT_LT(few, 0);
    EXPECT_GT(more, 50);
    EXPECT_GT(many, 3 * more);
    EXPECT_LT(evidence(1000, 0.003), 0.5 * more) << "errors that forty neighbours share";
}

// The inner side of a torus of 33 m whose hole is as wide as the pipe, and an elbow.
TEST(BestKind, TheHoleOfAWideTorusExplainsAPipeNoBetter)
{
    Dice dice(11);
    pcm::Shape pipe, hole, elbow;
    pipe.kind = ShapeKind::cylinder;
    pipe.point = map;
    pipe.axis = {0, 0, 1};
    pipe.radius = 0.05;
    hole.kind = elbow.kind = ShapeKind::torus;
    hole.point = map;
    hole.axis = {0, 0, 1};
    hole.radius = 33.55;
    hole.second = 33.5;
    elbow.point = map + Vec3d{0.15, 0, 0};
    elbow.axis = {0, 1, 0};
    elbow.radius = 0.15;
    elbow.second = 0.05;
    std::vector<Vec3d> straight, bent;
    for (int i = 0; i < 2000; ++i) {
        straight.push_back(point_on(pipe, 0.3, 3, 0.0015, dice).position);
        const double way = dice.between(0, 0.5), turn = dice.between(0, 3);
        const Vec3d out{-std::cos(way), 0, std::sin(way)};
        bent.push_back(elbow.point + 0.15 * out + 0.05 * (std::cos(turn) * out + std::sin(turn) * elbow.axis));
    }
    ShapeFit fit;
    fit.noise = 0.0015;
    fit.shape = hole;
    EXPECT_FALSE(explains_better(fit, pipe, straight));
    fit.shape = elbow;
    EXPECT_TRUE(explains_better(fit, pipe, bent));
    EXPECT_FALSE(explains_better(fit, pipe, straight));
    fit.noise = 0;
    EXPECT_FALSE(explains_better(fit, pipe, bent));
}

TEST(BestKind, TheNextBestIsNamedAndThresholdsDoNotDecide)
{
    Dice dice(9);
    std::vector<Vec3d> positions;  // two faces of a plate of 8 mm, the upper one denser
    for (int i = 0; i < 2000; ++i)
        positions.push_back(
            {dice.between(-1, 1), dice.between(-1, 1), (i % 3 ? 0.004 : -0.004) + 0.001 * dice.normal()});
    const FitPoints points = FitPoints::of(positions);
    std::vector<ShapeFit> fits;
    for (const double height : {0.0013, 0.004}) {
        ShapeFit fit;
        fit.verdict = FitVerdict::good;
        fit.shape.point = {0, 0, height};
        fit.threshold = height < 0.002 ? 0.016 : 0.004;  // one between the faces has all points
        fit.noise = height < 0.002 ? 0.004 : 0.001;
        fit.inliers = height < 0.002 ? 2000 : 1333;
        fits.push_back(fit);
    }
    const KindChoice choice = choose_kind(fits, points);
    ASSERT_TRUE(choice.best && choice.next);
    EXPECT_EQ(*choice.best, 1u);
    EXPECT_EQ(*choice.next, 0u);
    EXPECT_GT(choice.log_ratio, 500);
    EXPECT_FALSE(choose_kind({}, points).best);
    EXPECT_FALSE(choose_kind({fits[0]}, points).next);
}

}  // namespace
