// Primitives of a document: the list, their drawing and labels, the settings of the tool, and the filters.
#include "plugin/meshlab/document_scene.h"
#include "plugin/tools/fit/fit_settings.h"

#include "pcm/cad/primitive_files.h"
#include "pcm/cloud/condition.h"
#include "pcm/io/reader.h"
#include "pcm/system/error.h"
#include "plugin/meshlab/layer.h"
#include "plugin/scene/annotations.h"
#include "plugin/scene/drawn_primitives.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/open_clouds.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/project_parts.h"
#include "plugin/scene/scene_state.h"
#include "tests/plugin/filter_call.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

#include <QSettings>

#include <cmath>
#include <fstream>
#include <limits>

namespace pcm::host {
namespace {

Primitive pipe(const std::string& cloud)
{
    Primitive made;
    made.cloud = cloud;
    made.fit.verdict = FitVerdict::good;
    made.fit.shape = parse_shape("cylinder 500000 4800000 100 0 0 1 2");
    made.fit.errors.radius = 0.004;
    made.fit.errors.position = 0.002;
    made.fit.threshold = 0.05;
    made.fit.rms = 0.0123;
    made.bounds.from = 0;
    made.bounds.to = 10;
    made.points = 1234;
    return made;
}

Box3d box_of(const std::vector<Annotation>& drawn)
{
    Box3d box;
    for (const Annotation& each : drawn)
        for (const Vec3d& p : each.line) box.extend(p);
    return box;
}

TEST(DrawnPrimitives, AreMovedWithTheirLayer)
{
    const auto there = drawn_primitive(pipe("a"), std::nullopt, {Qt::red, false, "pipe"});
    const auto moved = drawn_primitive(pipe("a"), Affine::translation({5, 6, 7}), {Qt::red, true, {}});
    ASSERT_EQ(there.size(), moved.size());
    for (std::size_t i = 0; i < there.size(); ++i) {
        for (std::size_t k = 0; k < there[i].line.size(); ++k)
            EXPECT_LT(length(moved[i].line[k] - there[i].line[k] - Vec3d{5, 6, 7}), 1e-9);
        EXPECT_EQ(there[i].colour, QColor(Qt::red));
        EXPECT_GT(moved[i].width_px, there[i].width_px);
        EXPECT_TRUE(moved[i].on_top && !there[i].on_top);
    }
    EXPECT_EQ(there.front().label, "pipe");
    const auto& places = there.front().line;
    EXPECT_NE(std::find(places.begin(), places.end(), there.front().label_at), places.end()) << "next to the shape";
    EXPECT_NEAR(box_of(there).extent(0), 4, 0.02);
    EXPECT_NEAR(box_of(there).extent(2), 11, 1e-6);  // the axis is longer by a twentieth at either end
}

TEST(DrawnPrimitives, APipesValuesNameItsRun)
{
    PrimitiveList list;
    Primitive first = pipe("a"), second = pipe("a"), elsewhere = pipe("b");
    first.name = "Lower";
    second.name = "Upper";
    second.bounds.from += 11;
    second.bounds.to += 11;
    for (const Primitive& one : {first, second, elsewhere}) list.add(one);
    const auto value = [&](std::size_t index, const char* name) {
        for (const auto& [key, text] : lines_of(list, index, "m"))
            if (key == name) return text;
        return QString("-");
    };
    EXPECT_EQ(value(1, "part of a pipe run"), "Lower, Upper");
    EXPECT_EQ(value(1, "run's length"), "21 m");
    EXPECT_EQ(value(1, "run's bends"), "no bends");
    EXPECT_EQ(value(1, "radius"), "2.000 ± 0.004 m");
    EXPECT_EQ(value(2, "part of a pipe run"), "-") << "of another cloud";
}

TEST(DrawnPrimitives, NumbersAreRoundedToWhatIsKnown)
{
    EXPECT_EQ(size_of(pipe("a"), "m"), "r 2.000 ± 0.004 m");
    std::map<QString, QString> lines;
    for (const auto& [name, value] : lines_of(pipe("a"), "m")) lines[name] = value;
    EXPECT_EQ(lines["radius"], "2.000 ± 0.004 m");
    EXPECT_EQ(lines["length"], "10 m");
    EXPECT_EQ(lines["arc"], "360°");
    EXPECT_EQ(lines["residual (rms)"], "0.0123 m");
    EXPECT_EQ(lines["point of the axis"], "500000.0000 4800000.0000 100.0000");
    EXPECT_EQ(lines["points"], "1,234");
    EXPECT_EQ(lines.count("doubtful"), 0u);
    Primitive thin = pipe("a");
    thin.fit.verdict = FitVerdict::doubtful;
    thin.fit.message = "too thin an arc";
    thin.fit.errors.radius = std::numeric_limits<double>::infinity();
    lines.clear();
    for (const auto& [name, value] : lines_of(thin, "")) lines[name] = value;
    EXPECT_EQ(lines["doubtful"], "too thin an arc");
    EXPECT_EQ(lines["radius"], "2 (not determined)");
    Primitive floor = pipe("a");
    floor.fit.shape = parse_shape("plane 0 0 0 0 0 1");
    floor.bounds = {};
    floor.bounds.outline = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}};
    EXPECT_EQ(size_of(floor, "m"), "rectangle 6 m²");  // not what its points cover
    floor.bounds.outline = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {1, 2, 0}, {1, 1, 0}, {0, 1, 0}};
    floor.points = 500;
    EXPECT_EQ(size_of(floor, "m"), "area 5.0 ± 0.5 m²");  // 10 around, 0.1 from point to point
}

class PrimitiveBooks : public testing::Test {
protected:
    void SetUp() override
    {
        keep_primitives_in_projects();
        tree_ = tree_of(scene(folder_, "a.las", 3000, far_away), 1000);
        layer_ = document_.addNewMesh(QString::fromStdString(tree_.string()), "tree");
        show_tree(*layer_, open_cloud(tree_));
        document_.setCurrentMesh(layer_->id());
    }
    PrimitiveBook& book() { return scene_of(document_).part<PrimitiveBook>(); }
    std::vector<Annotation> drawn() { return scene_of(document_).part<Annotations>().all().at("primitives"); }

    const test::TemporaryFolder folder_;
    MetDocument document_;
    MeshModel* layer_ = nullptr;
    fs::path tree_;
};

TEST_F(PrimitiveBooks, ChangesAreSteps)
{
    book().change([&](PrimitiveList& list) { list.add(pipe(cloud_name(layer_of(*layer_)))); });
    EXPECT_EQ(book().list()[0].name, "Cylinder 1");
    EXPECT_EQ(drawn().front().label, "Cylinder 1");
    book().select(0);
    EXPECT_TRUE(drawn().front().on_top);
    EXPECT_THROW(book().change([](PrimitiveList& list) {
        list.clear();
        list.rename(7, "x");
    }),
                 Error);
    EXPECT_EQ(book().list().size(), 1u);
    book().change([](PrimitiveList& list) { list.hide(0, true); });
    EXPECT_EQ(scene_of(document_).part<Annotations>().all().count("primitives"), 0u);
    book().change([](PrimitiveList& list) { list.undo(); });
    book().change([](PrimitiveList& list) { list.undo(); });
    EXPECT_TRUE(book().list().empty());
    EXPECT_FALSE(book().selected());
}

TEST_F(PrimitiveBooks, AreDrawnWhereTheLayerIs)
{
    book().change([&](PrimitiveList& list) { list.add(pipe(cloud_name(layer_of(*layer_)))); });
    const Box3d before = box_of(drawn());
    const Vec3d origin = Registry::instance().origin_of(document_).value();
    scene_of(document_).part<LayerMatrices>().set(layer_of(*layer_), matrix_of(Affine::translation({10, 0, 0}), origin),
                                                  "moved");
    EXPECT_NEAR(box_of(drawn()).min[0] - before.min[0], 10, 1e-3);
    EXPECT_EQ(book().list()[0].fit.shape.point, pipe("").fit.shape.point) << "the list has the cloud's own numbers";
}

TEST_F(PrimitiveBooks, PointsAreKnownUntilTheTreeChanges)
{
    const auto cloud = Registry::instance().find(*layer_)->cloud;
    book().change([&](PrimitiveList& list) { list.add(pipe(cloud_name(layer_of(*layer_)))); });
    EXPECT_EQ(book().points_of(book().list()[0]), nullptr);
    const auto all = std::make_shared<const PointSet>(PointSet::all_of(cloud->tree()));
    book().keep_points(book().list()[0], all);
    book().change([](PrimitiveList& list) { list.rename(0, "duct"); });
    EXPECT_EQ(book().points_of(book().list()[0]), all) << "whatever its name is";
    Registry::instance().detach(*layer_);
    EXPECT_EQ(book().points_of(book().list()[0]), nullptr);
}

TEST_F(PrimitiveBooks, AreKeptInProjects)
{
    Primitive odd = pipe(cloud_name(layer_of(*layer_)));
    odd.name = "Duct <1> & \"two\"";
    odd.colour = {1, 2, 3};
    odd.hidden = true;
    book().change([&](PrimitiveList& list) { list.add(odd); });
    const QByteArray file =
        with_parts("<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n</MeshLabProject>\n", scene_of(document_));
    book().replace({});
    take_parts(file, scene_of(document_));
    ASSERT_EQ(book().list().size(), 1u);
    const Primitive& back = book().list()[0];
    EXPECT_EQ(back.name, odd.name);
    EXPECT_EQ(back.colour, odd.colour);
    EXPECT_TRUE(back.hidden);
    EXPECT_EQ(text_of(back.fit.shape), text_of(odd.fit.shape));
    EXPECT_EQ(back.fit.errors.radius, odd.fit.errors.radius);
    EXPECT_EQ(back.bounds.to, odd.bounds.to);
    EXPECT_EQ(book().layer_of(back), &layer_of(*layer_));
    EXPECT_FALSE(book().list().can_undo()) << "undo would empty a project that was opened";
    // What cannot be read changes nothing.
    take_parts(QByteArray(file).replace("cylinder", "potato"), scene_of(document_));
    EXPECT_EQ(book().list().size(), 1u);
}

TEST_F(PrimitiveBooks, AreMovedWithTheirLayersInDrawings)
{
    Primitive hidden = pipe(cloud_name(layer_of(*layer_)));
    hidden.hidden = true;
    Primitive elsewhere = pipe("elsewhere.pct");
    book().change([&](PrimitiveList& list) { list.add_all({pipe(cloud_name(layer_of(*layer_))), hidden, elsewhere}); });
    const Vec3d there = pipe("").fit.shape.point;
    EXPECT_EQ(book().placed(true)[0].fit.shape.point, there);
    const Vec3d origin = Registry::instance().origin_of(document_).value();
    Affine quarter = Affine::rotation({1, 0, 0}, pi / 2, there);
    quarter.target = quarter.target + Vec3d{10, 0, 0};
    scene_of(document_).part<LayerMatrices>().set(layer_of(*layer_), matrix_of(quarter, origin), "turned");
    const auto placed = book().placed(false);
    EXPECT_LT(length(placed[0].fit.shape.point - there - Vec3d{10, 0, 0}), 0.01);
    EXPECT_NEAR(std::fabs(placed[0].fit.shape.axis[1]), 1, 1e-6);
    EXPECT_EQ(placed[0].fit.shape.radius, 2);
    EXPECT_EQ(placed[1].fit.shape.point, there) << "not written, so it is not moved";
    EXPECT_NE(book().placed(true)[1].fit.shape.point, there);
    EXPECT_EQ(placed[2].fit.shape.point, there) << "no layer shows its cloud";
    EXPECT_EQ(book().list()[0].fit.shape.point, there);
    scene_of(document_).part<LayerMatrices>().set(
        layer_of(*layer_), matrix_of(Affine::rotation({1, 0, 0}, 1, there, 2), origin), "scaled");
    try {
        book().placed(false);
        FAIL();
    } catch (const Error& error) {
        const std::string words = error.what();
        EXPECT_NE(words.find("layer tree scales"), std::string::npos) << words;
        EXPECT_NE(words.find("Cylinder 1"), std::string::npos) << words;
    }
    book().change([](PrimitiveList& list) { list.hide(0, true); });
    EXPECT_NO_THROW(book().placed(false));
    EXPECT_THROW(book().placed(true), Error);
}

TEST_F(PrimitiveBooks, AnotherCloudOfTheSameNameIsNotTheirs)
{
    const test::TemporaryFolder other;
    const fs::path same_name = other / tree_.filename();
    Primitive primitive = pipe(same_name.string());
    EXPECT_EQ(book().layer_of(primitive), &layer_of(*layer_)) << "the project was moved";
    fs::create_directory(same_name);
    EXPECT_EQ(book().layer_of(primitive), nullptr) << "it is where it was, and not open";
}

TEST_F(PrimitiveBooks, HowTheirPointsWereReachedIsKept)
{
    const auto cloud = Registry::instance().find(*layer_)->cloud;
    const auto all = std::make_shared<const PointSet>(PointSet::all_of(cloud->tree()));
    ReachedFrom from;
    from.shape = pipe("").fit.shape;
    from.threshold = 0.1 / 3;
    from.normal_angle = 0.4;
    from.step = 0.7;
    from.seeds = {far_away + Vec3d{0.1, 0.2, 0.3}, far_away};
    from.limit.clips = {{Region::sphere(far_away, 0.3), true}};
    from.limit.region = Region::box({far_away, far_away + Vec3d{1, 2, 3}});
    from.limit.box = Box3d{far_away, far_away + Vec3d{3, 3, 3}};
    from.limit.where = {parse_condition("classification != 2..4, 7")};
    book().change([&](PrimitiveList& list) { list.add(pipe(cloud_name(layer_of(*layer_)))); });
    book().keep_points(book().list()[0], all, from);
    const QByteArray file =
        with_parts("<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n</MeshLabProject>\n", scene_of(document_));
    book().replace({});
    book().take_reached("[]");
    take_parts(file, scene_of(document_));
    const ReachedFrom* const back = book().reached(book().list()[0]);
    ASSERT_NE(back, nullptr) << file.toStdString();
    EXPECT_EQ(text_of(back->shape), text_of(from.shape));
    EXPECT_EQ(back->threshold, from.threshold);
    EXPECT_EQ(back->normal_angle, from.normal_angle);
    EXPECT_EQ(back->step, from.step);
    EXPECT_EQ(back->seeds, from.seeds);
    ASSERT_EQ(back->limit.clips.size(), 3u);
    EXPECT_EQ(back->limit.clips[0].region.text(), Region::box(*from.limit.box).text());
    EXPECT_EQ(back->limit.clips[1].region.text(), from.limit.region->text());
    EXPECT_EQ(back->limit.clips[2].region.text(), from.limit.clips[0].region.text());
    EXPECT_TRUE(back->limit.clips[2].outside && !back->limit.clips[0].outside);
    ASSERT_EQ(back->limit.where.size(), 1u);
    EXPECT_EQ(back->limit.where[0].text, from.limit.where[0].text);
    // Nothing is kept for primitives that are no longer in the list, nor for very many seeds.
    book().change([](PrimitiveList& list) { list.clear(); });
    EXPECT_TRUE(book().reached_text().isEmpty());
    from.seeds.assign(20001, far_away);
    Primitive many = pipe("many");
    book().change([&](PrimitiveList& list) { list.add(many); });
    book().keep_points(book().list()[0], all, from);
    EXPECT_TRUE(book().reached_text().isEmpty());
    const QString good = R"({"of": "a", "shape": "sphere 0 0 0 1", "threshold": 1, "normal_angle": 4, "step": 1,)"
                         R"( "seeds": [[1, 2, 3]], "clips": [], "where": []})";
    EXPECT_NO_THROW(book().take_reached("[" + good + "]"));
    for (const auto& [from_text, to_text] :
         std::vector<std::pair<const char*, const char*>>{{"sphere", "potato"},
                                                          {"[1, 2, 3]", "[1, 2]"},
                                                          {"\"step\": 1", "\"step\": -1"},
                                                          {"\"a\"", "\"\""},
                                                          {"\"clips\": []", "\"clips\": [{\"region\": \"x\"}]"},
                                                          {"\"where\": []", "\"where\": [\"=\"]"},
                                                          {"{", "["}})
        try {
            book().take_reached("[" + QString(good).replace(from_text, to_text) + "]");
            ADD_FAILURE() << from_text;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::bad_format) << error.what();
        }
}

TEST(FitSettings, AreTypedAndKept)
{
    const test::TemporaryFolder folder;
    QSettings::setPath(QSettings::NativeFormat, QSettings::UserScope, QString::fromStdString(folder.path().string()));
    QCoreApplication::setOrganizationName("pcm");
    QCoreApplication::setApplicationName("fit settings");
    FitSettings settings = kept_fit_settings();
    EXPECT_FALSE(settings.kind);
    EXPECT_EQ(options_of(settings).kinds.size(), shape_kinds().size());
    settings.kind = ShapeKind::torus;
    settings.estimator = Estimator::prosac;
    settings.outline = OutlineKind::concave;
    settings.grow = false;
    settings.by_radius = true;
    const auto type = [&](const std::string& key, const char* text) {
        for (std::size_t i = 0; i < fit_numbers().size(); ++i)
            if (fit_numbers()[i].key == key) settings.numbers[i] = text;
    };
    type("Threshold", "0.25");
    type("Neighbourhood", "1.5");
    type("NormalAngle", "90");
    type("Probability", "0.9999");
    type("Iterations", "123");
    type("LargestRadius", "7");
    keep(settings);
    const FitSettings kept = kept_fit_settings();
    ASSERT_EQ(kept.numbers.size(), fit_numbers().size());
    for (const QString& number : kept.numbers) EXPECT_EQ(number, "") << "the next cloud has other ones";
    EXPECT_EQ(kept.kind, settings.kind);
    EXPECT_TRUE(kept.by_radius);
    const FitAtOptions options = options_of(settings);
    EXPECT_TRUE(options.kinds.empty());
    EXPECT_EQ(options.fit.kind, ShapeKind::torus);
    EXPECT_EQ(options.fit.estimator, Estimator::prosac);
    EXPECT_EQ(options.outline.kind, OutlineKind::concave);
    EXPECT_FALSE(options.grow);
    EXPECT_EQ(options.fit.threshold, 0.25);
    EXPECT_EQ(options.radius, 1.5);
    EXPECT_EQ(options.count, 0u);
    EXPECT_DOUBLE_EQ(options.fit.normal_angle, pi / 2);
    EXPECT_EQ(options.fit.probability, 0.9999);
    EXPECT_EQ(options.fit.iterations, 123u);
    EXPECT_EQ(options.fit.largest_radius, 7);
    settings.by_radius = false;
    type("Neighbourhood", "800");
    EXPECT_EQ(options_of(settings).count, 800u);
    for (const auto& [key, text] : std::vector<std::pair<std::string, const char*>>{
             {"Threshold", "-1"}, {"Probability", "1"}, {"Iterations", "1.5"}, {"Step", "many"}, {"Step", "nan"}}) {
        const auto good = settings;
        type(key, text);
        EXPECT_THROW(options_of(settings), Error) << key << " " << text;
        settings = good;
    }
    QSettings().setValue("PointCloudFit/Shape", "potato");
    EXPECT_FALSE(kept_fit_settings().kind);
}

// A pipe of radius 2 on a floor, at map coordinates, with 2 mm noise.
fs::path pipe_on_a_floor(const test::TemporaryFolder& folder)
{
    Grid grid;
    grid.scale = {0.001, 0.001, 0.001};
    grid.offset = far_away;
    std::vector<test::LasPoint> points;
    std::uint32_t random = 1;
    const auto next = [&] { return static_cast<double>((random = random * 1664525u + 1013904223u) >> 8) / (1 << 24); };
    const auto add = [&](double x, double y, double z) {
        test::LasPoint point;
        point.x = static_cast<std::int32_t>(std::lround(x * 1000));
        point.y = static_cast<std::int32_t>(std::lround(y * 1000));
        point.z = static_cast<std::int32_t>(std::lround(z * 1000));
        points.push_back(point);
    };
    const auto noise = [&] { return 0.004 * (next() + next() - 1); };
    for (int i = 0; i < 12000; ++i) {
        const double angle = 2 * pi * next(), r = 2 + noise();
        add(r * std::cos(angle), r * std::sin(angle), 1 + 9 * next());
    }
    for (int i = 0; i < 12000; ++i) add(20 * next() - 10, 20 * next() - 10, noise());
    const fs::path las = folder / "pipe.las";
    test::write_las_points(las, grid, points);
    return tree_of(las, 2000);
}

class PrimitiveFilters : public testing::Test {
protected:
    const test::TemporaryFolder folder_;
    const fs::path tree_ = pipe_on_a_floor(folder_);
};

TEST_F(PrimitiveFilters, FitsWritesAndExtracts)
{
    FilterCall call("Fit Primitive");
    const fs::path json = folder_ / "pipe.json", part = folder_ / "part.pct";
    call.set("Tree", tree_).set("Places", StringValue("500002 4800000 105"));
    call.set("Name", StringValue("duct")).set("OutputFile", json).set("PointsOutput", part);
    ASSERT_TRUE(call.apply()) << call.log();
    const auto written = read_primitives(json);
    ASSERT_EQ(written.size(), 1u);
    EXPECT_EQ(written[0].name, "duct");
    EXPECT_EQ(written[0].fit.shape.kind, ShapeKind::cylinder);
    EXPECT_NEAR(written[0].fit.shape.radius, 2, 0.001);
    EXPECT_NEAR(std::fabs(written[0].fit.shape.axis[2]), 1, 1e-6);
    EXPECT_NEAR(written[0].bounds.to - written[0].bounds.from, 9, 0.1);
    EXPECT_GT(written[0].points, 11500u);
    EXPECT_EQ(PointCloud::open(part)->info().points, written[0].points);
    EXPECT_EQ(scene_of(call.document).part<PrimitiveBook>().list().size(), 1u);
    EXPECT_NE(call.log().find("  radius      "), std::string::npos) << call.log();
    EXPECT_EQ(models_of(call.document).size(), 1u) << "a layer of its points";
    // An existing file is not replaced unasked.
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("exists"), std::string::npos) << call.log();
}

TEST_F(PrimitiveFilters, RefusedFitsLeaveNothing)
{
    FilterCall call("Fit Primitive");
    const fs::path json = folder_ / "no.json";
    call.set("Tree", tree_).set("OutputFile", json);
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("'Places' is needed"), std::string::npos) << call.log();
    call.set("Places", StringValue("500008 4800008 100")).choose("Shape", 3);  // a sphere on the floor
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("no sphere was fitted"), std::string::npos) << call.log();
    EXPECT_FALSE(fs::exists(json));
    EXPECT_TRUE(scene_of(call.document).part<PrimitiveBook>().list().empty());
    call.choose("Shape", 1).set("OutputFile", folder_ / "no.stl");
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("no.stl: the extension says no format"), std::string::npos) << call.log();
    call.set("OutputFile", json).set("Threshold", FloatValue(-1));
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("'Threshold': '-1' is not a number greater than 0"), std::string::npos) << call.log();
}

TEST_F(PrimitiveFilters, DetectsLabelsAndExports)
{
    FilterCall call("Detect Primitives");
    const fs::path list = folder_ / "all.json", labelled = folder_ / "labelled.pct";
    call.set("Tree", tree_).set("OutputFile", list).set("Labels", true).set("Output", labelled);
    ASSERT_TRUE(call.apply()) << call.log();
    const auto found = read_primitives(list);
    ASSERT_EQ(found.size(), 2u) << call.log();
    EXPECT_TRUE(PointCloud::open(labelled)->info().schema.find("primitive").has_value());
    EXPECT_EQ(scene_of(call.document).part<PrimitiveBook>().list().size(), 2u);
    // As a drawing.
    FilterCall drawing("Export Primitives");
    EXPECT_FALSE(drawing.apply());
    EXPECT_NE(drawing.log().find("no output file"), std::string::npos) << drawing.log();
    const fs::path script = folder_ / "all.scr";
    drawing.set("OutputFile", script);
    EXPECT_FALSE(drawing.apply());
    EXPECT_NE(drawing.log().find("no primitives"), std::string::npos) << drawing.log();
    drawing.set("ListFile", list);
    ASSERT_TRUE(drawing.apply()) << drawing.log();
    std::ifstream file(script);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    EXPECT_NE(text.find("CYLINDER"), std::string::npos);
    // Labels need a place to go.
    call.set("Output", fs::path()).set("OutputFile", folder_ / "again.json");
    EXPECT_FALSE(call.apply());
    EXPECT_NE(call.log().find("no output is given"), std::string::npos) << call.log();
    EXPECT_FALSE(fs::exists(folder_ / "again.json"));
}

}  // namespace
}  // namespace pcm::host
