// Detection on scenes with exact truth.

#include "pcm/detect/detect.h"
#include "pcm/shapes/outline_area.h"

#include "pcm/detect/point_labels.h"
#include "pcm/select/select_points.h"
#include "pcm/system/error.h"
#include "tests/detect/checked_labels.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;

const Vec3d corner{512345, 4812345, 120};

pcm::Shape shape(ShapeKind kind, const Vec3d& point, const Vec3d& axis, double radius = 0)
{
    pcm::Shape s;
    s.kind = kind;
    s.point = corner + point;
    s.axis = normalised(axis);
    s.radius = radius;
    return s;
}

struct Piece {
    pcm::Shape shape;
    double size = 0, arc = 2 * pi;
    std::size_t points = 0;
};

class Detect : public testing::Test {
protected:
    void make(const std::vector<Piece>& pieces, double sigma, std::size_t clutter = 0)
    {
        Dice dice(5);
        std::vector<SurfacePoint> points;
        for (const Piece& piece : pieces)
            for (std::size_t i = 0; i < piece.points; ++i)
                points.push_back(point_on(piece.shape, piece.size, piece.arc, sigma, dice));
        for (std::size_t i = 0; i < clutter; ++i)
            points.push_back({corner + Vec3d{dice.between(-6, 6), dice.between(-6, 6), dice.between(-6, 6)}, {}});
        tree_ = build_surface_tree(folder_.path(), points);
    }
    void make(const std::vector<Vec3d>& positions)
    {
        std::vector<SurfacePoint> points;
        for (const Vec3d& p : positions) points.push_back({p, {}});
        tree_ = build_surface_tree(folder_.path(), points);
    }
    DetectReport detect(DetectOptions options = {})
    {
        DetectReport report = detect_primitives(tree_, options);
        check_labels(*tree_, report);
        return report;
    }
    // The found shape is the true one, within `sigmas` standard deviations.
    static void expect_same(const Primitive& found, const pcm::Shape& truth, double sigmas = 4)
    {
        const ShapeFit& fit = found.fit;
        ASSERT_EQ(fit.shape.kind, truth.kind);
        EXPECT_EQ(fit.verdict, FitVerdict::good);
        const Vec3d d = fit.shape.point - truth.point;
        if (truth.kind == ShapeKind::sphere)
            EXPECT_LE(length(d), sigmas * fit.errors.position);
        else if (truth.kind == ShapeKind::plane)
            EXPECT_LE(std::fabs(dot(d, truth.axis)), sigmas * fit.errors.position);
        else
            EXPECT_LE(length(d - dot(d, truth.axis) * truth.axis), sigmas * fit.errors.position);
        if (traits_of(truth.kind).has_axis())
            EXPECT_LE(length(cross(fit.shape.axis, truth.axis)), sigmas * fit.errors.angle);
        if (traits_of(truth.kind).has_radius())
            EXPECT_LE(std::fabs(fit.shape.radius - truth.radius), sigmas * fit.errors.radius);
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
};

std::vector<std::uint32_t> all_labels(const Tree& tree, const DetectReport& report)
{
    std::vector<std::uint32_t> all;
    for (NodeId node = 0; node < tree.nodes().size(); ++node) {
        const std::vector<std::uint32_t> some = report.labels->get(node);
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

const std::vector<Piece> scene{
    {shape(ShapeKind::plane, {0, 0, -5}, {0, 0, 1}), 5, 0, 60000},
    {shape(ShapeKind::plane, {5, 0, -2}, {1, 0.1, 0}), 2.5, 0, 25000},
    {shape(ShapeKind::cylinder, {-3, -4, -4}, {0, 1, 0.05}, 0.3), 7, 2 * pi, 16000},
    {shape(ShapeKind::sphere, {0, 0, 2}, {0, 0, 1}, 1.1), 0, 0, 14000},
    {shape(ShapeKind::cylinder, {2, 2, -5}, {0, 0, 1}, 0.1), 3, 2 * pi, 4000},
};

// Two boards side by side, one 10.5 mm higher: one plane within the threshold has both.
TEST_F(Detect, PCM_NOT_UNDER_THREAD(StepsWithinTheThresholdAreFoundByTheSecondSearch))
{
    Dice dice(6);
    std::vector<Vec3d> points;
    for (int i = 0; i < 60000; ++i)
        points.push_back(corner + Vec3d{dice.between(-3, 3), dice.between(-3, 3), -2 + 0.002 * dice.normal()});
    for (int i = 0; i < 12000; ++i) {
        const double y = dice.between(-0.2, 0.2);
        points.push_back(corner + Vec3d{dice.between(0, 3), y, (y < 0 ? 0 : 0.0105) + 0.0015 * dice.normal()});
    }
    make(points);
    const DetectReport report = detect();
    ASSERT_EQ(report.primitives.size(), 3u);
    for (std::size_t i = 1; i < 3; ++i) {
        const ShapeFit& board = report.primitives[i].fit;
        const double height = report.primitives[i].bounds.outline.at(0)[2] - corner[2];
        EXPECT_EQ(board.verdict, FitVerdict::good) << board.message;
        EXPECT_NEAR(height, height < 0.005 ? 0 : 0.0105, 0.001);
        EXPECT_GT(report.primitives[i].points, 3500u);
    }
}

// Not under the thread sanitizer: many fits, whose threads other tests watch; so below.
TEST_F(Detect, PCM_NOT_UNDER_THREAD(FindsEachShapeOfASceneAtMapCoordinatesAmongClutter))
{
    make(scene, 0.002, 3000);
    const DetectReport report = detect();
    ASSERT_EQ(report.primitives.size(), scene.size());
    EXPECT_GT(report.threshold, 0.005);
    EXPECT_LT(report.threshold, 0.02);
    EXPECT_EQ(report.outcome.points_in, 122000u);
    for (std::size_t i = 0; i < scene.size(); ++i) {  // most points first, as in the scene
        SCOPED_TRACE(text_of(scene[i].shape));
        expect_same(report.primitives[i], scene[i].shape);
        EXPECT_NEAR(static_cast<double>(report.primitives[i].points), static_cast<double>(scene[i].points),
                    0.03 * static_cast<double>(scene[i].points));
        EXPECT_NEAR(report.primitives[i].fit.noise, 0.002, 0.0002);
    }
    EXPECT_EQ(report.primitives[0].name, "Plane 1");
    EXPECT_EQ(report.primitives[4].name, "Cylinder 2");
}

TEST_F(Detect, PCM_NOT_UNDER_THREAD(OnlyTheKindsAskedForAndInsideOfTheSelection))
{
    make(scene, 0.002);
    DetectOptions options;
    EXPECT_EQ(options.kinds, (std::vector<ShapeKind>{ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere}));
    options.kinds = {ShapeKind::sphere};
    DetectReport report = detect(options);
    ASSERT_GE(report.primitives.size(), 1u);
    for (const Primitive& primitive : report.primitives) EXPECT_EQ(primitive.fit.shape.kind, ShapeKind::sphere);
    options = {};
    options.limit.box = Box3d{corner + Vec3d{-2, -2, 0}, corner + Vec3d{2, 2, 4}};
    report = detect(options);
    ASSERT_EQ(report.primitives.size(), 1u);
    expect_same(report.primitives[0], scene[3].shape);
    EXPECT_EQ(report.outcome.points_in, select_points(tree_, options.limit).size());
}

TEST_F(Detect, PCM_NOT_UNDER_THREAD(WallsOfOnePlaneThatAreApartAreTwo))
{
    make({{shape(ShapeKind::plane, {0, 0, 0}, {1, 0, 0}), 2, 0, 30000},
          {shape(ShapeKind::plane, {0, 5, 0}, {1, 0, 0}), 2, 0, 20000},
          {shape(ShapeKind::plane, {0, 0, -2.5}, {0, 0, 1}), 3, 0, 20000}},
         0.001);
    const DetectReport report = detect();
    ASSERT_EQ(report.primitives.size(), 3u);
    for (const Primitive& primitive : report.primitives) EXPECT_EQ(primitive.fit.shape.kind, ShapeKind::plane);
    DetectOptions options;  // steps over the gap
    options.step = 1.5;
    EXPECT_EQ(detect(options).primitives.size(), 2u);
}

TEST_F(Detect, PipesWithOneAxisThatAreApartAreTwo)
{
    const pcm::Shape axis = shape(ShapeKind::cylinder, {-4, 0, 0}, {1, 0, 0}, 0.12);
    pcm::Shape second = axis;
    second.point = axis.point + Vec3d{4.5, 0, 0};
    make({{axis, 4, 2 * pi, 12000}, {second, 3, 2 * pi, 9000}}, 0.001);
    const DetectReport report = detect();
    ASSERT_EQ(report.primitives.size(), 2u);
    expect_same(report.primitives[0], axis);
    expect_same(report.primitives[1], axis);
    EXPECT_EQ(report.primitives[0].points, 12000u);
}

TEST_F(Detect, OneShapeInManyBoxesIsOneWhateverThreadsAndMemory)
{
    std::vector<Piece> large = scene;
    large[0].points = 500000;
    large[1].points = 200000;
    make(large, 0.002);
    DetectOptions options;
    options.threads = 1;
    const DetectReport one = detect(options);
    ASSERT_EQ(one.primitives.size(), scene.size());
    EXPECT_NEAR(static_cast<double>(one.primitives[0].points), 500000, 5000);
    options.threads = 4;
    options.memory_bytes = std::uint64_t(1) << 30;
    const DetectReport four = detect_primitives(tree_, options);
    EXPECT_EQ(all_labels(*tree_, one), all_labels(*tree_, four));
    ASSERT_EQ(four.primitives.size(), one.primitives.size());
    for (std::size_t i = 0; i < one.primitives.size(); ++i)
        EXPECT_EQ(text_of(one.primitives[i].fit.shape), text_of(four.primitives[i].fit.shape));
}

// Rolling ground: within the threshold of a plane piece by piece. Under no sanitizer: minutes there.
TEST_F(Detect, PCM_NOT_UNDER_SANITIZERS(PiecesOfABendingSurfaceAreNoPrimitivesUnlessAskedFor))
{
    Dice dice(3);
    std::vector<Vec3d> points;
    for (int i = 0; i < 150000; ++i) {
        const double x = dice.between(0, 20), y = dice.between(0, 20);
        points.push_back(corner + Vec3d{x, y, 0.5 * std::sin(0.5 * x) * std::cos(0.4 * y) + 0.002 * dice.normal()});
    }
    make(points);
    DetectOptions options;
    options.kinds = {ShapeKind::plane};
    const DetectReport report = detect(options);
    EXPECT_LE(report.primitives.size(), 2u);
    ASSERT_FALSE(report.notes.empty());
    EXPECT_NE(report.notes[0].find("continue smoothly"), std::string::npos);
    options.pieces = true;
    const DetectReport all = detect(options);
    EXPECT_GT(all.primitives.size(), 10u);
    std::size_t doubtful = 0;
    for (const Primitive& primitive : all.primitives) doubtful += primitive.fit.verdict == FitVerdict::doubtful;
    EXPECT_GE(doubtful + 2, all.primitives.size());
}

TEST_F(Detect, CloudsWithoutShapesHaveNone)
{
    Dice dice(9);
    std::vector<Vec3d> points{corner};
    make(points);
    EXPECT_TRUE(detect().primitives.empty());
    points.assign(1000, corner);
    make(points);
    EXPECT_TRUE(detect().primitives.empty());
    points.clear();
    for (int i = 0; i < 2000; ++i) points.push_back(corner + Vec3d{0.01 * i, 0.02 * i, 0});
    make(points);  // on a line
    EXPECT_TRUE(detect().primitives.empty());
    points.clear();
    for (int i = 0; i < 20000; ++i)
        points.push_back(corner + Vec3d{dice.between(0, 1), dice.between(0, 1), dice.between(0, 1)});
    make(points);
    EXPECT_TRUE(detect().primitives.empty());
}

// Its noise is wider than the spacing of its coarsest level.
TEST_F(Detect, PCM_NOT_UNDER_THREAD(AManyTimesDividedCloudOfNoiseAloneHasNone))
{
    Dice dice(9);
    std::vector<Vec3d> points;
    for (int i = 0; i < 300000; ++i)
        points.push_back(corner + Vec3d{dice.between(0, 1), dice.between(0, 1), dice.between(0, 1)});
    make(points);
    const DetectReport report = detect();
    EXPECT_GT(report.sample, tree_->info().spacings[0]);
    EXPECT_TRUE(report.primitives.empty());
}

TEST_F(Detect, ExactAndTinyPlanes)
{
    Dice dice(9);
    for (const double size : {1.0, 1e-6, 1e7}) {
        std::vector<Vec3d> points;
        for (int i = 0; i < 5000; ++i) points.push_back({size * dice.between(0, 1), size * dice.between(0, 1), 0});
        make(points);
        const DetectReport report = detect();
        ASSERT_EQ(report.primitives.size(), 1u) << size;
        EXPECT_EQ(report.primitives[0].points, 5000u);
        EXPECT_LT(std::fabs(report.primitives[0].fit.shape.point[2]), 1e-9 * size);
    }
}

TEST_F(Detect, PrimitivesBelowTheLeastNumberOfPointsAreLeftOut)
{
    make({{shape(ShapeKind::plane, {0, 0, 0}, {0, 0, 1}), 2, 0, 3000},
          {shape(ShapeKind::plane, {0, 0, 3}, {0, 0, 1}), 1, 0, 900}},
         0.001);
    EXPECT_EQ(detect().primitives.size(), 2u);
    DetectOptions options;
    options.least_points = 1000;
    EXPECT_EQ(detect(options).primitives.size(), 1u);
}

TEST_F(Detect, RefusesOptionsOutOfRange)
{
    make({corner});
    std::string message;
    const auto refused = [&](const std::function<void(DetectOptions&)>& change) {
        DetectOptions options;
        change(options);
        try {
            detect_primitives(tree_, options);
        } catch (const Error& error) {
            message = error.what();
            return error.code() == ErrorCode::invalid_argument;
        }
        return false;
    };
    EXPECT_TRUE(refused([](DetectOptions& o) { o.kinds.clear(); }));
    EXPECT_NE(message.find("choose plane, cylinder or sphere"), std::string::npos) << message;
    EXPECT_TRUE(refused([](DetectOptions& o) { o.kinds = {ShapeKind::cone}; }));
    EXPECT_NE(message.find("finds planes, cylinders and spheres; a cone is found at"), std::string::npos);
    EXPECT_TRUE(refused([](DetectOptions& o) { o.threshold = -1; }));
    EXPECT_TRUE(refused([](DetectOptions& o) { o.threshold = std::nan(""); }));
    EXPECT_TRUE(refused([](DetectOptions& o) { o.step = std::numeric_limits<double>::infinity(); }));
    EXPECT_TRUE(refused([](DetectOptions& o) { o.normal_angle = 0; }));
    EXPECT_TRUE(refused([](DetectOptions& o) { o.least_points = 3; }));
}

TEST_F(Detect, StepsFarAboveTheSpacingAreRefused)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < 100; ++i)
        for (int k = 0; k < 100; ++k) points.push_back(corner + Vec3d{0.02 * i, 0.02 * k, 0});
    make(points);
    DetectOptions options;
    options.step = detect().sample * 120;
    EXPECT_EQ(detect(options).primitives.size(), 1u);
    options.step *= 1.1;
    try {
        detect_primitives(tree_, options);
        FAIL() << "a step of " << options.step;
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("far above the cloud's spacing"), std::string::npos) << error.what();
    }
}

TEST_F(Detect, CanBeCancelledAtAnyStage)
{
    make(scene, 0.002);
    for (const double at : {0.0, 0.05, 0.5, 0.7, 0.9}) {
        DetectOptions options;
        bool asked = false;
        options.progress = [&](const ProgressUpdate& update) {
            return update.fraction >= 1 || !(asked = asked || update.fraction >= at);  // the last report comes too late
        };
        try {
            detect_primitives(tree_, options);
            EXPECT_FALSE(asked) << at;  // it was done before
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::cancelled);
        }
    }
}

TEST_F(Detect, PCM_NOT_UNDER_THREAD(LabelsBecomeAnAttribute))
{
    make(scene, 0.002);
    const DetectReport report = detect();
    LabelOptions options;
    options.target.copy = folder_ / "labelled.pct";
    const LabelReport written = label_primitives(tree_, report, options);
    EXPECT_EQ(written.outcome.points_out, report.outcome.points_out);
    const auto labelled = Tree::open(options.target.copy);
    for (const Primitive& primitive : report.primitives) {
        Selection selection;
        selection.where.push_back(parse_condition("primitive=" + std::to_string(primitive.label)));
        EXPECT_EQ(select_points(labelled, selection).size(), primitive.points);
    }
    EXPECT_FALSE(tree_->info().schema.find("primitive"));
    EXPECT_EQ(Tree::open(tree_->folder())->info().generation, tree_->info().generation);  // untouched

    options.target = {{}, true};
    options.attribute = "shape";
    EXPECT_EQ(label_primitives(tree_, report, options).outcome.points_out, report.outcome.points_out);
    // The tree has changed since.
    EXPECT_THROW(label_primitives(tree_, report, options), Error);
    const auto changed = Tree::open(tree_->folder());
    EXPECT_TRUE(changed->info().schema.find("shape"));
    DetectReport nothing;
    EXPECT_THROW(label_primitives(changed, nothing, options), Error);
}

TEST_F(Detect, LabelsCanBeCancelledAndTheTreeStaysAsItWas)
{
    make({scene[3]}, 0.002);
    const DetectReport report = detect();
    const std::uint64_t before = tree_->info().generation;
    for (const double at : {0.0, 0.3, 0.98}) {
        LabelOptions options;
        options.target.in_place = true;
        options.progress = [&](const ProgressUpdate& update) { return update.fraction < at; };
        EXPECT_THROW(label_primitives(tree_, report, options), Error) << at;
        const auto tree = Tree::open(tree_->folder());
        EXPECT_EQ(tree->info().generation, before);
        EXPECT_FALSE(tree->info().schema.find("primitive"));
        EXPECT_EQ(tree->data_files().size(), tree_->data_files().size());
    }
}

// Caps and outlines are those of all points, not of some.
TEST_F(Detect, PCM_NOT_UNDER_THREAD(BoundsReachTheOutermostPoints))
{
    make(scene, 0.002);
    const DetectReport report = detect();
    ASSERT_EQ(report.primitives.size(), scene.size());
    const ShapeBounds& pipe = report.primitives[2].bounds;
    EXPECT_NEAR(pipe.to - pipe.from, 7, 0.004);
    const std::vector<Vec3d>& floor = report.primitives[0].bounds.outline;
    const OutlineArea area = outline_area(floor, report.primitives[0].points);
    EXPECT_EQ(area.form, OutlineForm::convex);
    EXPECT_NEAR(area.area, 100, 2 * area.uncertainty);
    EXPECT_GT(area.area, 99);
    EXPECT_LT(area.uncertainty, 2);
}

// The noise of a stereo camera grows with the distance: the table's is three times that of most surfaces.
TEST_F(Detect, PCM_NOT_UNDER_THREAD(RougherSurfacesThanMostHaveAWiderThreshold))
{
    PCM_REQUIRE_SAMPLE("primitives/table_scene_mug_stereo_textured.pcd");
    build_tree({sample("primitives/table_scene_mug_stereo_textured.pcd")}, folder_ / "mug.pct");
    tree_ = Tree::open(folder_ / "mug.pct");
    const DetectReport report = detect();
    ASSERT_GE(report.primitives.size(), 2u);
    const Primitive &table = report.primitives[0], &mug = report.primitives[1];
    EXPECT_EQ(table.fit.shape.kind, ShapeKind::plane);
    EXPECT_GT(table.points, 110000u);
    EXPECT_GE(table.fit.threshold, 2 * report.threshold);
    EXPECT_EQ(mug.fit.shape.kind, ShapeKind::cylinder);
    // Which pieces the mug comes in hangs on the last digits, and those with a sagitta of less than three thresholds
    // are refused; of its 14,000 points more than a third are on cylinders.
    std::uint64_t on_cylinders = 0;
    for (const Primitive& p : report.primitives)
        if (p.fit.shape.kind == ShapeKind::cylinder) on_cylinders += p.points;
    EXPECT_GT(on_cylinders, 5000u);
    EXPECT_GE(report.outcome.error, table.fit.threshold);
}

// A floor whose scans lie in layers, some of them whole at the cloud's threshold.
TEST_F(Detect, PCM_NOT_UNDER_THREAD(AFloorInLayersIsOnePlane))
{
    PCM_REQUIRE_SAMPLE("primitives/room_scan1.pcd");
    build_tree({sample("primitives/room_scan1.pcd")}, folder_ / "room.pct");
    tree_ = Tree::open(folder_ / "room.pct");
    const DetectReport report = detect();
    std::vector<std::uint64_t> floors;
    for (const Primitive& p : report.primitives)
        if (p.fit.shape.kind == ShapeKind::plane && std::fabs(p.fit.shape.axis[2]) > 0.99 &&
            p.fit.shape.point[2] < -1.1)
            floors.push_back(p.points);
    ASSERT_EQ(floors.size(), 1u);
    EXPECT_GT(floors[0], 11500u);
    DetectOptions options;  // a threshold that is given is that of all
    options.threshold = report.threshold;
    for (const Primitive& p : detect(options).primitives) EXPECT_EQ(p.fit.threshold, options.threshold);
}

// Planes that others have labelled. A label may have several walls of one plane that are apart, which are several
// primitives: what counts is that half of its points lie on planes parallel to its largest one.
TEST_F(Detect, PCM_NOT_UNDER_SANITIZERS(BuildingsPlanesAreThoseOfItsLabels))
{
    PCM_REQUIRE_SAMPLE("primitives/building.ply");
    build_tree({sample("primitives/building.ply")}, folder_ / "building.pct");
    tree_ = Tree::open(folder_ / "building.pct");
    DetectOptions options;
    options.kinds = {ShapeKind::plane};
    options.least_points = 200;
    options.pieces = true;
    const DetectReport report = detect(options);
    const std::size_t segment = *tree_->info().schema.find("segment_index");
    std::map<int, std::map<std::uint32_t, std::uint64_t>> found;
    for (NodeId node = 0; node < tree_->nodes().size(); ++node) {
        const Chunk chunk = tree_->read_chunk(node, ColumnSet::all(tree_->info().schema));
        const std::vector<std::uint32_t> labels = report.labels->get(node);
        for (std::size_t i = 0; i < chunk.points; ++i)
            ++found[static_cast<int>(chunk.attributes[segment]->value(i, 0))][labels[i]];
    }
    std::size_t planes = 0, recovered = 0;
    for (const auto& [label, counts] : found) {
        std::uint64_t all = 0, most = 0, parallel = 0;
        std::uint32_t largest = 0;
        for (const auto& [primitive, points] : counts) {
            all += points;
            if (primitive > 0 && points > most) most = points, largest = primitive;
        }
        if (label < 0 || all < 500 || largest == 0) continue;
        const Vec3d normal = report.primitives[largest - 1].fit.shape.axis;
        for (const auto& [primitive, points] : counts)
            if (primitive > 0 && std::fabs(dot(report.primitives[primitive - 1].fit.shape.axis, normal)) > 0.985)
                parallel += points;
        ++planes;
        recovered += 2 * parallel >= all;
    }
    EXPECT_EQ(planes, 12u);
    EXPECT_GE(recovered, 11u);
}

}  // namespace
