// A dense scan of little noise within a cloud from farther away is searched by itself.
#include "pcm/detect/cloud_part.h"
#include "pcm/detect/cloud_survey.h"
#include "pcm/detect/detect.h"
#include "pcm/detect/point_labels.h"
#include "pcm/knn/unit_plan.h"
#include "pcm/system/error.h"
#include "tests/detect/checked_labels.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <map>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

const Vec3d corner{512345, 4812345, 120};

// A floor, a pipe and a ball, noise 2 mm, in the middle of rolling terrain of `terrain` points, noise `rough`.
class QuietPart : public testing::Test {
protected:
    void make(std::size_t terrain, double rough)
    {
        Dice dice(5);
        std::vector<SurfacePoint> points;
        const auto add = [&](const char* text, double size, std::size_t count) {
            pcm::Shape shape = parse_shape(text);
            shape.point = corner + shape.point;
            shapes_.push_back(shape);
            for (std::size_t i = 0; i < count; ++i) points.push_back(point_on(shape, size, 2 * pi, 0.002, dice));
        };
        add("plane 0 0 3 0 0 1", 6, 80000);
        add("cylinder -4 0 4 1 0 0 0.12", 8, 12000);
        add("sphere 0 3 5 0.6", 0, 9000);
        for (std::size_t i = 0; i < terrain; ++i) {
            const double x = dice.between(-80, 80), y = dice.between(-80, 80);
            if (std::max(std::fabs(x), std::fabs(y)) < 7) continue;
            const double z = 2 * std::sin(x / 9) * std::cos(y / 7) + rough * dice.normal();
            points.push_back({corner + Vec3d{x, y, z}, {}});
        }
        tree_ = build_surface_tree(folder_.path(), points);
    }
    CloudPart part_of_tree() const
    {
        const ChosenPoints points(tree_, {});
        const CloudSurvey whole = survey_cloud(points, plan_units(*tree_, 20000), Repeated::counted, [] {});
        return quiet_part(points, plan_units(*tree_, 40000), plan_units(*tree_, 160000), whole, Repeated::counted,
                          [] {});
    }
    Vec3i grid_of(const Vec3d& p) const
    {
        Vec3i q;
        const Grid& grid = tree_->info().grid;
        for (std::size_t a = 0; a < 3; ++a) q[a] = std::llround((p[a] - grid.offset[a]) / grid.scale[a]);
        return q;
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    std::vector<pcm::Shape> shapes_;
};

TEST(CloudParts, HoldTheirBoxesOrAllElse)
{
    std::mt19937 random(4);
    const auto place = [&] { return Vec3i{int(random() % 20), int(random() % 20), int(random() % 20)}; };
    for (int round = 0; round < 200; ++round) {
        std::vector<Box3i> boxes(random() % 4);
        for (Box3i& box : boxes)
            for (int i = 0; i < 2; ++i) box.extend(place());
        Box3i around;
        for (int i = 0; i < 2; ++i) around.extend(place());
        const CloudPart part(boxes), others = part.others();
        EXPECT_FALSE(part.is_whole());
        EXPECT_EQ(others.is_whole(), boxes.empty());
        bool any = false, any_other = false;
        for (std::int64_t x = around.min[0]; x <= around.max[0]; ++x)
            for (std::int64_t y = around.min[1]; y <= around.max[1]; ++y)
                for (std::int64_t z = around.min[2]; z <= around.max[2]; ++z) {
                    const Vec3i q{x, y, z};
                    bool inside = false;
                    for (const Box3i& box : boxes) inside = inside || box.contains(q);
                    any = any || inside;
                    any_other = any_other || !inside;
                    EXPECT_EQ(part.contains(q), inside);
                    EXPECT_EQ(others.contains(q), !inside);
                    EXPECT_EQ(part.within(around).contains(q), inside);
                    EXPECT_EQ(others.within(around).contains(q), !inside);
                }
        EXPECT_EQ(part.touches(around), any);
        EXPECT_TRUE(others.touches(around) || !any_other);  // several boxes may hold what no one of them holds
        EXPECT_EQ(part.within(around).touches(around), any);
    }
    EXPECT_TRUE(CloudPart().is_whole());
    EXPECT_TRUE(CloudPart().contains({1, 2, 3}));
}

TEST_F(QuietPart, IsWhereTheNoiseIsFarLess)
{
    make(300000, 0.03);
    const CloudPart part = part_of_tree();
    ASSERT_FALSE(part.is_whole());
    for (const Vec3d& p : {Vec3d{0, 0, 3}, {-3, 0, 4.12}, {0, 3, 5.6}}) EXPECT_TRUE(part.contains(grid_of(corner + p)));
    for (const Vec3d& p : {Vec3d{60, 60, 0}, {-60, 50, 0}}) EXPECT_FALSE(part.contains(grid_of(corner + p)));
}

TEST_F(QuietPart, IsTheWholeCloudWhereTheNoiseIsAlike)
{
    make(300000, 0.005);
    EXPECT_TRUE(part_of_tree().is_whole());
}

TEST_F(QuietPart, PCM_NOT_UNDER_THREAD(HasShapesThatTheCloudsThresholdWouldHide))
{
    make(600000, 0.03);
    DetectOptions options;
    double before = 0;
    options.progress = [&](const ProgressUpdate& update) {
        EXPECT_GE(update.fraction, before);
        before = update.fraction;
        return true;
    };
    const DetectReport report = detect_primitives(tree_, options);
    EXPECT_EQ(before, 1);
    EXPECT_GT(report.threshold, 0.05);
    EXPECT_EQ(std::count_if(report.notes.begin(), report.notes.end(),
                            [](const std::string& note) {
                                return note.find("have far less noise than the others") != std::string::npos;
                            }),
              1);
    EXPECT_EQ(report.outcome.points_in, tree_->info().points);
    for (const pcm::Shape& truth : shapes_) {
        const auto is_it = [&](const Primitive& one) {
            const Shape& found = one.fit.shape;
            return found.kind == truth.kind && one.fit.threshold < 0.02 && one.fit.verdict == FitVerdict::good &&
                   std::fabs(found.radius - truth.radius) < 0.001 &&
                   distance_to(found, corner + Vec3d{0, 3, 5.6}) < 4 && one.points > 7000;
        };
        EXPECT_EQ(std::count_if(report.primitives.begin(), report.primitives.end(), is_it), 1) << text_of(truth);
    }
    // Labels are those of the joined list, whose names and colours are in its order.
    check_labels(*tree_, report);
    std::map<std::string, int> names;
    for (const Primitive& one : report.primitives) EXPECT_EQ(++names[one.name], 1);
    // A threshold that is given holds everywhere.
    options.progress = {};
    options.threshold = 0.02;
    for (const Primitive& one : detect_primitives(tree_, options).primitives) EXPECT_EQ(one.fit.threshold, 0.02);
}

TEST_F(QuietPart, PCM_NOT_UNDER_THREAD(IsLeftWhenTheDetectionIsCancelled))
{
    make(600000, 0.03);
    DetectOptions options;
    options.progress = [](const ProgressUpdate& update) { return update.fraction < 0.55; };
    try {
        detect_primitives(tree_, options);
        ADD_FAILURE() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
}

}  // namespace
