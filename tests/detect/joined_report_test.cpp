// Two searches as one report: whose the points are that both have found.
#include "pcm/detect/joined_report.h"

#include "tests/detect/checked_labels.h"
#include "tests/place/shape_cloud.h"

#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;

// 4000 points of the plane z = 0 with x from 0 to 4.
class JoinedReport : public testing::Test {
protected:
    JoinedReport()
    {
        Dice dice(5);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 4000; ++i) points.push_back({{4 * (i + 0.5) / 4000, dice.between(0, 1), 0}, {}});
        tree_ = build_surface_tree(folder_.path(), points);
    }
    // A report of planes; label_of() says by x which one a point belongs to, or 0.
    DetectReport report(std::size_t count, FitVerdict verdict, const std::function<std::uint32_t(double)>& label_of)
    {
        DetectReport report;
        report.primitives.resize(count);
        const auto labels = std::make_shared<PointLabels>(*tree_);
        for (const PlacedPoint& p : all_points(*tree_)) {
            const std::uint32_t label = label_of(p.position[0]);
            labels->set(p.node, {p.number}, &label);
            if (label > 0) ++report.primitives[label - 1].points;
        }
        for (std::size_t i = 0; i < count; ++i) {
            Primitive& one = report.primitives[i];
            one.label = static_cast<std::uint32_t>(i + 1);
            one.fit.verdict = verdict;
            one.fit.threshold = 0.01;
            one.bounds.outline = {{0, 0, 0}, {4, 0, 0}, {4, 1, 0}};
        }
        report.labels = labels;
        return report;
    }
    DetectReport first()
    {
        return report(1, FitVerdict::doubtful, [](double x) { return x < 3 ? 1 : 0; });
    }
    // Numbers of points, most first.
    std::vector<std::uint64_t> joined_points(DetectReport second, std::uint64_t least = 100)
    {
        return joined_points(first(), std::move(second), least);
    }
    std::vector<std::uint64_t> joined_points(DetectReport from, DetectReport second, std::uint64_t least)
    {
        const DetectReport both = joined(*tree_, std::move(from), std::move(second), least);
        check_labels(*tree_, both);
        std::vector<std::uint64_t> points;
        for (const Primitive& one : both.primitives) points.push_back(one.points);
        return points;
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
};

using Points = std::vector<std::uint64_t>;

TEST_F(JoinedReport, WithoutPointsInCommonHasAll)
{
    EXPECT_EQ(joined_points(report(1, FitVerdict::good, [](double x) { return x < 3 ? 0 : 1; })), (Points{3000, 1000}));
    EXPECT_EQ(joined_points(report(1, FitVerdict::doubtful, [](double x) { return x < 3 ? 0 : 1; })),
              (Points{3000, 1000}));
}

TEST_F(JoinedReport, GoodShapesTakePointsAndReplaceWhatTheyHaveMostOf)
{
    EXPECT_EQ(joined_points(report(1, FitVerdict::good, [](double x) { return x < 1 ? 1 : 0; })), (Points{2000, 1000}));
    EXPECT_EQ(joined_points(report(2, FitVerdict::good, [](double x) { return x < 1   ? 1
                                                                              : x < 2 ? 2
                                                                                      : 0; })),
              (Points{1000, 1000}));
}

// A good one whose points a finer threshold finds only in part keeps them.
TEST_F(JoinedReport, GoodShapesAreReplacedByThoseWithMostOfTheirPoints)
{
    const auto joined_with = [&](FitVerdict verdict, double to) {
        DetectReport from = report(2, verdict, [](double x) { return x < 3 ? 1 : 2; });
        return joined_points(std::move(from), report(1, FitVerdict::good, [&](double x) { return x < to ? 1 : 0; }),
                             100);
    };
    EXPECT_EQ(joined_with(FitVerdict::good, 2.2), (Points{3000, 1000}));
    EXPECT_EQ(joined_with(FitVerdict::good, 2.3), (Points{2300, 1000}));
    EXPECT_EQ(joined_with(FitVerdict::doubtful, 2.2), (Points{2200, 1000}));
    // What doubtful ones have of it does not count.
    DetectReport second = report(2, FitVerdict::good, [](double x) { return x < 1.5 ? 1 : x < 2.7 ? 2 : 0; });
    second.primitives[1].fit.verdict = FitVerdict::doubtful;
    EXPECT_EQ(joined_points(report(1, FitVerdict::good, [](double x) { return x < 3 ? 1 : 0; }), second, 100),
              (Points{3000}));
}

TEST_F(JoinedReport, DoubtfulShapesTakeNoPoints)
{
    const auto some = [](double x) { return x < 2.6 ? 0 : 1; };  // 400 of the first one's, and 1000
    EXPECT_EQ(joined_points(report(1, FitVerdict::doubtful, some)), (Points{3000, 1000}));
    EXPECT_EQ(joined_points(report(1, FitVerdict::doubtful, [](double x) { return x < 2 ? 1 : 0; })), (Points{3000}));
}

TEST_F(JoinedReport, HasNoShapesOfFewerPointsThanAskedFor)
{
    EXPECT_EQ(joined_points(report(1, FitVerdict::good, [](double x) { return x < 1 ? 1 : 0; }), 2001), Points{});
    EXPECT_EQ(joined_points(report(1, FitVerdict::good, [](double x) { return x < 1 ? 1 : 0; }), 2000), Points{2000});
}

}  // namespace
