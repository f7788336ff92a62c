// Colours by value: ranges, ramps, any attribute; and the conditions that hide points.
#include "tests/gl/gl_support.h"

#include "pcm/gl/draw/cloud_facts.h"
#include "pcm/io/reader.h"
#include "pcm/update/append.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

using namespace pcm;
using namespace pcm::test;

namespace {

Camera camera_of(double x, double y, double z, double half)
{
    return view_of(translation(-x, -y, -z), orthographic(half, half, -100, 100), 60, 60);
}

// A cube of random points, 10 units wide, and an outlier far above it.
std::vector<LasPoint> cube_with_outlier(std::size_t count)
{
    std::vector<LasPoint> points = random_points(count, 10000, 31);
    points[7].z = 1000000;
    points[7].intensity = 65535;
    for (std::size_t i = 0; i < count; ++i) points[i].classification = static_cast<std::uint8_t>(i % 5);
    return points;
}

// A row of points from left to right, one unit apart, seen from above with 4 pixels per unit.
std::vector<LasPoint> row(std::size_t count)
{
    std::vector<LasPoint> points(count);
    for (std::size_t i = 0; i < count; ++i) {
        points[i].x = static_cast<std::int32_t>(1000 * i);
        points[i].y = 0;
        points[i].z = static_cast<std::int32_t>(100 * i);
        points[i].source_id = static_cast<std::uint16_t>(40 + 10 * i);
        points[i].classification = static_cast<std::uint8_t>(i);
        points[i].red = static_cast<std::uint16_t>(256 * i + 5);
    }
    return points;
}
Camera row_camera() { return view_of(translation(-5, 0, 0), orthographic(5.5, 2.75, -10, 10), 88, 44); }
Pixel pixel_of(const std::vector<Pixel>& pixels, std::size_t i) { return pixels[22 * 88 + 8 * i + 4]; }

::testing::AssertionResult shows(const Pixel& pixel, const std::array<float, 3>& colour)
{
    const std::uint8_t found[3] = {pixel.r, pixel.g, pixel.b};
    for (std::size_t c = 0; c < 3; ++c)
        if (std::abs(static_cast<float>(found[c]) - 255 * colour[c]) > 1.5f)
            return ::testing::AssertionFailure() << int(pixel.r) << ' ' << int(pixel.g) << ' ' << int(pixel.b);
    return ::testing::AssertionSuccess();
}

CloudReport first_report(Drawing& drawing, const Framebuffer& framebuffer, const Camera& camera)
{
    return draw_until_done(drawing, framebuffer, camera, {0, 0, 0}, everything()).clouds.at(0);
}

}  // namespace

TEST(ColourValues, TheRangeIsThatOfTheCloudWhateverIsInViewOrLoadedFirst)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    make_cloud(folder, "cube", grid_at({0, 0, 0}), cube_with_outlier(20000), 1000);
    // A second part, in another place, with other heights and intensities.
    std::vector<LasPoint> more = random_points(5000, 10000, 32);
    for (LasPoint& p : more) {
        p.x += 30000;
        p.z += 20000;
        p.intensity = static_cast<std::uint16_t>(p.intensity + 6000);
    }
    write_las_points(folder / "more.las", grid_at({0, 0, 0}), more);
    append_points(folder / "cube.pct", *open_reader(folder / "more.las"), {"more.las"});

    const Framebuffer framebuffer(60, 60);
    for (const ColourMode mode : {ColourMode::height, ColourMode::intensity, ColourMode::attribute}) {
        std::optional<ValueRange> range;
        for (const Camera& camera : {camera_of(20, 5, 15, 30), camera_of(1, 1, 0, 1), camera_of(39, 9, 29, 1)}) {
            Drawing drawing(PointCloud::open(folder / "cube.pct"));
            drawing.style.colour = mode;
            drawing.style.attribute = "intensity";
            const CloudReport report = first_report(drawing, framebuffer, camera);
            ASSERT_TRUE(report.range) << name_of(mode);
            if (!range) range = report.range;
            EXPECT_EQ(*report.range, *range) << name_of(mode);
            drawing.release();
        }
        // The same colours, whichever part was loaded first.
        const Camera overview = camera_of(20, 5, 15, 30);
        std::vector<std::vector<Pixel>> pictures;
        for (const Camera& first : {overview, camera_of(1, 1, 0, 1), camera_of(39, 9, 29, 1)}) {
            const auto cloud = PointCloud::open(folder / "cube.pct");
            // The part in view may be in memory before the first frame, as another view may have left it.
            for (const SampledChunk& sampled : coarsest_chunks(*cloud->tree()))
                if (pictures.size() == 1 && cloud->tree()->box(sampled.node).min[0] < 20)
                    cloud->cache().get(sampled.node, ColumnSet::all(cloud->info().schema));
            Drawing drawing(cloud);
            drawing.style.colour = mode;
            drawing.style.attribute = "intensity";
            first_report(drawing, framebuffer, first);
            first_report(drawing, framebuffer, overview);
            pictures.push_back(framebuffer.read());
            EXPECT_TRUE(pictures.back() == pictures.front()) << name_of(mode);
            drawing.release();
        }
        // The outlier does not count, the second part does.
        const bool is_height = mode == ColourMode::height;
        EXPECT_LT(range->low, is_height ? 1 : 400);
        EXPECT_GT(range->high, is_height ? 25 : 7000);
        EXPECT_LT(range->high, is_height ? 30.5 : 9001);
    }
}

// A chunk may arrive between two looks at a fact. If the second one found it, a cloud of one colour would be shown in
// that colour, as the first did not know it, and nothing would be missing.
TEST(ColourValues, AFactDoesNotBecomeKnownWithinAFrame)
{
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at({0, 0, 0}), random_points(3000, 10000, 34));
    CloudStyle style;
    style.colour = ColourMode::rgb;
    const auto none_failed = [](NodeId) { return false; };
    CloudFacts facts(cloud);
    facts.begin_frame();
    EXPECT_EQ(facts.find(style, none_failed), nullptr);
    for (const SampledChunk& sampled : coarsest_chunks(*cloud->tree()))
        cloud->cache().get(sampled.node, ColumnSet::all(cloud->info().schema));
    EXPECT_EQ(facts.find(style, none_failed), nullptr);
    EXPECT_TRUE(facts.lacks());
    facts.begin_frame();
    EXPECT_NE(facts.find(style, none_failed), nullptr);
    EXPECT_FALSE(facts.lacks());
}

// The first look: colours, else classes, else heights, as bright as the intensity where that is more than noise.
TEST(ColourValues, CloudsWithoutColoursShowTheirShape)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const Framebuffer framebuffer(60, 60);
    const auto shown = [&](const char* name, ColourMode asked, const std::function<void(LasPoint&, std::size_t)>& set) {
        std::vector<LasPoint> points = random_points(3000, 10000, 33);
        for (std::size_t i = 0; i < points.size(); ++i) {
            points[i].red = points[i].green = points[i].blue = 0;
            points[i].classification = 1;
            set(points[i], i);
        }
        Drawing drawing(make_cloud(folder, name, grid_at({0, 0, 0}), points));
        drawing.style.colour = asked;
        const CloudReport report = first_report(drawing, framebuffer, camera_of(5, 5, 5, 6));
        EXPECT_GT(count_lit(framebuffer.read()), 1000u) << name;
        drawing.release();
        return std::string(name_of(report.style.colour)) + " | " + report.notice;
    };
    const std::string blank = "all sampled points have the same colours";
    const auto smooth = [](LasPoint& p) { p.intensity = static_cast<std::uint16_t>(100 + p.x / 10); };
    EXPECT_EQ(shown("coloured", ColourMode::rgb, [](LasPoint& p, std::size_t i) { p.red = i == 5 ? 60000 : 0; }),
              "rgb | ");
    EXPECT_EQ(shown("black", ColourMode::rgb, [&](LasPoint& p, std::size_t) { smooth(p); }),
              "height-intensity | " + blank + ": height-intensity is shown");
    EXPECT_EQ(shown("white", ColourMode::rgb,
                    [&](LasPoint& p, std::size_t) {
                        smooth(p);
                        p.red = p.green = p.blue = 65535;
                    }),
              "height-intensity | " + blank + ": height-intensity is shown");
    EXPECT_EQ(shown("noise", ColourMode::rgb,
                    [](LasPoint& p, std::size_t i) { p.intensity = static_cast<std::uint16_t>(i * 7919 % 1000); }),
              "height | " + blank + ", the intensity shows no shape: height is shown");
    EXPECT_EQ(shown("constant", ColourMode::rgb, [](LasPoint& p, std::size_t) { p.intensity = 77; }),
              "height | " + blank + ", the intensity shows no shape: height is shown");
    // Ground and buildings are classes; one of both next to unclassified points is not enough.
    const auto classed = [&](std::uint8_t few) {
        return [smooth, few](LasPoint& p, std::size_t i) {
            smooth(p);
            p.classification = i % 10 == 0 ? few : 2;
        };
    };
    EXPECT_EQ(shown("classified", ColourMode::rgb, classed(6)),
              "classification | " + blank + ": classification is shown");
    EXPECT_EQ(shown("ground", ColourMode::rgb, classed(1)),
              "height-intensity | " + blank + ": height-intensity is shown");
    // What is asked for is shown.
    EXPECT_EQ(shown("asked_classes", ColourMode::classification, classed(2)), "classification | ");
    EXPECT_EQ(shown("asked_intensity", ColourMode::intensity,
                    [](LasPoint& p, std::size_t i) { p.intensity = static_cast<std::uint16_t>(i * 7919 % 1000); }),
              "intensity | ");
}

// At one height the hue is one, and brightness grows with the intensity, from a half on.
TEST(ColourValues, IntensityIsTheBrightnessOfHeight)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    std::vector<LasPoint> points = row(11);
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i].intensity = static_cast<std::uint16_t>(1000 + 100 * i);
        points[i].z = 0;
    }
    points.push_back(points.back());
    points.back().z = 5000;  // there is a range of heights
    Drawing drawing(make_cloud(folder, "row", grid_at({0, 0, 0}), points));
    const Framebuffer framebuffer(88, 44);
    drawing.style.point_size_px = 5;
    drawing.style.colour = ColourMode::height_intensity;
    drawing.style.range = ValueRange{-5, 0, 1};
    const CloudReport report = first_report(drawing, framebuffer, row_camera());
    EXPECT_EQ(report.style.colour, ColourMode::height_intensity);
    EXPECT_EQ(*report.range, (ValueRange{-5, 0, 1}));
    const auto pixels = framebuffer.read();
    for (const std::size_t i : {std::size_t(0), std::size_t(5), std::size_t(10)}) {
        std::array<float, 3> colour = ramp_colour(1);
        for (float& c : colour) c *= 0.5f + 0.05f * static_cast<float>(i);
        EXPECT_TRUE(shows(pixel_of(pixels, i), colour)) << i;
    }
    drawing.release();
}

TEST(ColourValues, AnyAttributeOnAnyRampInAnyRange)
{
    PCM_REQUIRE_GL(context, Profile::core);
    const TemporaryFolder folder;
    Drawing drawing(make_cloud(folder, "row", grid_at({0, 0, 0}), row(11)));
    const Framebuffer framebuffer(88, 44);
    drawing.style.point_size_px = 5;
    drawing.style.colour = ColourMode::attribute;
    drawing.style.attribute = "point_source_id";  // 40 to 140
    CloudReport report = first_report(drawing, framebuffer, row_camera());
    EXPECT_EQ(*report.range, (ValueRange{40, 140, 1}));
    for (std::size_t i = 0; i < 11; ++i)
        EXPECT_TRUE(shows(pixel_of(framebuffer.read(), i), ramp_colour(static_cast<float>(i) / 10))) << i;

    const std::uint64_t uploaded = drawing.l1()->statistics().uploaded_bytes;
    for (const RampTraits& ramp : colour_ramps()) {
        drawing.style.ramp = ramp.ramp;
        drawing.style.range = ValueRange{60, 100, 1};
        report = first_report(drawing, framebuffer, row_camera());
        EXPECT_EQ(*report.range, (ValueRange{60, 100, 1}));
        const auto pixels = framebuffer.read();
        for (std::size_t i = 0; i < 11; ++i)
            EXPECT_TRUE(shows(pixel_of(pixels, i), ramp_colour((static_cast<float>(i) - 2) / 4, ramp.ramp)))
                << ramp.name << i;
    }
    // Ranges and ramps change without another upload.
    EXPECT_EQ(drawing.l1()->statistics().uploaded_bytes, uploaded);

    drawing.style.range.reset();
    drawing.style.ramp = ColourRamp::automatic;
    drawing.style.attribute = "rgb[0]";
    report = first_report(drawing, framebuffer, row_camera());
    EXPECT_EQ(*report.range, (ValueRange{5, 2565, 1}));
    EXPECT_TRUE(shows(pixel_of(framebuffer.read(), 5), ramp_colour(0.5f)));
    // The whole attribute is no number.
    drawing.style.attribute = "rgb";
    report = first_report(drawing, framebuffer, row_camera());
    EXPECT_EQ(report.notice.find("the cloud has no attribute 'rgb' (attributes: intensity, "), 0u) << report.notice;
    EXPECT_EQ(*report.range, (ValueRange{0, 1, 1}));
    EXPECT_TRUE(shows(pixel_of(framebuffer.read(), 10), ramp_colour(1)));
    drawing.style.colour = ColourMode::height;
    drawing.style.range = ValueRange{0.5, 2.5, 1};
    first_report(drawing, framebuffer, row_camera());
    EXPECT_TRUE(shows(pixel_of(framebuffer.read(), 10), ramp_colour(0.25f)));
    drawing.release();
}

TEST(ColourValues, ConditionsHidePoints)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    const std::vector<LasPoint> points = cube_with_outlier(20000);
    std::vector<LasPoint> some;
    for (const LasPoint& p : points)
        if (p.classification == 2 && p.z < 4000) some.push_back(p);
    Drawing drawing(make_cloud(folder, "cube", grid_at({0, 0, 0}), points, 1000));
    Drawing part(make_cloud(folder, "part", grid_at({0, 0, 0}), some, 1000));
    const Framebuffer framebuffer(60, 60);
    const Camera camera = camera_of(5, 5, 5, 6);

    drawing.style.colour = part.style.colour = ColourMode::classification;
    CloudReport report = first_report(drawing, framebuffer, camera);
    EXPECT_EQ(report.points_hidden, 0u);
    EXPECT_EQ(report.classes, ClassSet(31));
    const auto whole = framebuffer.read();
    drawing.style.where = {parse_condition("classification=2"), parse_condition("z<4")};
    for (int again = 0; again < 2; ++again) {
        const FrameReport frame = draw_until_done(drawing, framebuffer, camera, {0, 0, 0}, everything());
        report = frame.clouds.at(0);
        EXPECT_TRUE(frame.full_resolution);
        EXPECT_EQ(frame.points_drawn, some.size());
        EXPECT_EQ(report.points_drawn, some.size());
        EXPECT_EQ(report.points_drawn + report.points_hidden, 20000u);
        EXPECT_EQ(report.classes, ClassSet(4));
        EXPECT_EQ(report.notice, "");
    }
    const auto filtered = framebuffer.read();
    first_report(part, framebuffer, camera);
    EXPECT_TRUE(framebuffer.read() == filtered);  // as a cloud that has only these

    // Nothing is left; then everything again.
    drawing.style.where = {parse_condition("intensity<0")};
    report = first_report(drawing, framebuffer, camera);
    EXPECT_EQ(report.points_drawn, 0u);
    EXPECT_EQ(count_lit(framebuffer.read()), 0u);
    drawing.style.where = {parse_condition("nothing=1")};
    report = first_report(drawing, framebuffer, camera);
    EXPECT_NE(report.notice.find("'nothing=1' is not applied"), std::string::npos) << report.notice;
    EXPECT_TRUE(framebuffer.read() == whole);
    drawing.style.where.clear();
    first_report(drawing, framebuffer, camera);
    EXPECT_TRUE(framebuffer.read() == whole);
    drawing.release();
    part.release();
}

TEST(ColourValues, ADamagedPartIsLeftOutOfTheRange)
{
    PCM_REQUIRE_GL(context, Profile::compatibility);
    const TemporaryFolder folder;
    make_cloud(folder, "cube", grid_at({0, 0, 0}), random_points(5000, 10000, 34), 1000);
    std::vector<LasPoint> more = random_points(5000, 10000, 35);
    for (LasPoint& p : more) p.intensity = static_cast<std::uint16_t>(p.intensity + 9000);
    write_las_points(folder / "more.las", grid_at({0, 0, 0}), more);
    append_points(folder / "cube.pct", *open_reader(folder / "more.las"), {"more.las"});
    std::set<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "cube.pct"))
        if (entry.path().extension() == ".bpc") files.insert(entry.path());
    ASSERT_EQ(files.size(), 2u);
    const auto size = std::filesystem::file_size(*files.rbegin());
    std::ofstream(*files.rbegin(), std::ios::binary) << std::string(size, '#');

    Drawing drawing(PointCloud::open(folder / "cube.pct"));
    drawing.style.colour = ColourMode::intensity;
    const Framebuffer framebuffer(60, 60);
    FrameReport report;
    for (int frame = 0; frame < 2000 && report.points_drawn < 5000; ++frame) {
        framebuffer.clear();
        report = drawing.draw(camera_of(5, 5, 5, 6), {0, 0, 0}, everything());
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(report.points_drawn, 5000u);
    EXPECT_FALSE(report.full_resolution);
    EXPECT_NE(report.error, "");
    ASSERT_TRUE(report.clouds.at(0).range);
    EXPECT_LT(report.clouds[0].range->high, 3001);
    drawing.release();
}
