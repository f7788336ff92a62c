// Clips: a picture through them is that of the points that they leave.
#include "tests/gl/gl_support.h"

#include "pcm/build/builder.h"
#include "pcm/cloud/condition.h"
#include "pcm/gl/draw/view_clips.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iomanip>
#include <limits>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

constexpr int size = 96;
constexpr std::int32_t side = 10000;  // side of the cube, grid steps of 1 mm

Vec3d at(double x, double y, double z) { return map_offset + Vec3d{x, y, z}; }

Camera camera_of(bool from_above)
{
    return from_above ? view_of(translation(-5, -5, -30), orthographic(6, 6, 1, 100), size, size)
                      : view_of(overview(10), perspective(0.9, 1, 0.1, 1000), size, size);
}

// What a view that rests shows.
std::vector<Pixel> picture_of(Drawing& drawing, const Camera& camera, const std::vector<Clip>& clips,
                              const RenderOptions& options = everything(), FrameReport* last = nullptr)
{
    const Framebuffer framebuffer(size, size);
    SceneItem item;
    item.cloud = &drawing.drawn;
    item.origin = map_offset;
    item.style = drawing.style;
    item.clips = clips;
    FrameReport report;
    for (int frame = 0; frame < 3000; ++frame) {
        framebuffer.clear();
        report = drawing.renderer.draw(drawing.picture, camera, {item}, options);
        EXPECT_EQ(report.error, "");
        if (!report.refining || !report.error.empty()) break;
        if (!report.repaint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_TRUE(report.full_resolution);
    if (last) *last = report;
    return framebuffer.read();
}

std::vector<Condition> conditions(const std::vector<std::string>& texts)
{
    std::vector<Condition> list;
    for (const std::string& text : texts) list.push_back(parse_condition(text));
    return list;
}

std::vector<LasPoint> kept_of(const std::vector<LasPoint>& points, const std::vector<Clip>& clips)
{
    std::vector<LasPoint> kept;
    for (const LasPoint& p : points) {
        bool holds = true;
        for (const Clip& clip : clips) holds = holds && clip.holds(at(p.x * 0.001, p.y * 0.001, p.z * 0.001));
        if (holds) kept.push_back(p);
    }
    return kept;
}

class ClipsIn : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, ClipsIn, testing::Values(Profile::compatibility, Profile::core),
                         [](const auto& info) { return info.param == Profile::core ? "Core" : "Compatibility"; });

}  // namespace

// Conditions on coordinates, of which the points are chosen before they are uploaded, are the reference: the points
// have the same sizes then.
TEST_P(ClipsIn, ABoxShowsWhatConditionsOnCoordinatesShow)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto cloud = make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, side, 4), 1000);
    // The faces are at positions of the grid, which belong to the box.
    const std::vector<Clip> box{{Region::box({at(2.5, 1, 3), at(8, 7.25, 9)}), false}};
    const auto where =
        conditions({"x >= 500002.5", "x <= 500008", "y >= 5000001", "y <= 5000007.25", "z >= 103", "z <= 109"});
    for (const SplatMode mode : {SplatMode::constant, SplatMode::adaptive})
        for (const bool from_above : {false, true})
            for (const unsigned samples : {1u, 4u}) {
                SCOPED_TRACE(testing::Message() << int(mode) << from_above << samples);
                RenderOptions options = everything();
                options.samples = samples;
                Drawing clipped(cloud), chosen(cloud);
                clipped.style.splats = chosen.style.splats = mode;
                clipped.style.colour = chosen.style.colour = ColourMode::rgb;
                chosen.style.where = where;
                EXPECT_EQ(picture_of(clipped, camera_of(from_above), box, options),
                          picture_of(chosen, camera_of(from_above), {}, options));
                clipped.release();
                chosen.release();
            }
}

// Discs are drawn by shaders of their own.
TEST_P(ClipsIn, ABoxShowsTheSameDiscs)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    {
        std::ofstream file(folder / "discs.ply");
        file << "ply\nformat ascii 1.0\nelement vertex 6000\nproperty double x\nproperty double y\nproperty double z\n"
                "property float nx\nproperty float ny\nproperty float nz\nend_header\n"
             << std::fixed << std::setprecision(3);
        for (const LasPoint& p : random_points(6000, side, 9))
            file << 500000 + p.x * 0.001 << " " << 5000000 + p.y * 0.001 << " " << 100 + p.z * 0.001 << " "
                 << p.red - 30000.5 << " " << p.green - 30000.5 << " " << p.blue - 30000.5 << "\n";
    }
    BuildOptions build;
    build.chunk_points = 1000;
    build_tree({folder / "discs.ply"}, folder / "discs.pct", build);
    const auto cloud = PointCloud::open(folder / "discs.pct");
    const std::vector<Clip> box{{Region::box({at(2.5, 1, 3), at(8, 7.25, 9)}), false}};
    const auto where =
        conditions({"x >= 500002.5", "x <= 500008", "y >= 5000001", "y <= 5000007.25", "z >= 103", "z <= 109"});
    for (const SplatMode mode : {SplatMode::affine, SplatMode::perspective})
        for (const bool from_above : {false, true}) {
            SCOPED_TRACE(testing::Message() << int(mode) << from_above);
            Drawing clipped(cloud), chosen(cloud);
            clipped.style.splats = chosen.style.splats = mode;
            chosen.style.where = where;
            const auto picture = picture_of(clipped, camera_of(from_above), box);
            EXPECT_EQ(picture, picture_of(chosen, camera_of(from_above), {}));
            EXPECT_GT(count_lit(picture), 500u);
            clipped.release();
            chosen.release();
        }
}

TEST_P(ClipsIn, ShowThePointsThatTheyLeave)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto points = random_points(20000, side, 5);
    const auto cloud = make_cloud(folder, "all", grid_at(map_offset), points, 1000);
    const Region turned = parse_region("oriented-box 500005 5000005 105 3 2 4 30");
    const Region ball = Region::sphere(at(5, 5, 5), 3.5), beam = Region::ray(at(5, 5, 0), {0, 1, 3}, 2);
    const Region wedge = Region::convex(at(5, 5, 5), {{{1, 1, 0}, 1}, {{-1, 1, 0.5}, 1}});
    const std::vector<std::vector<Clip>> cases{{{turned, false}},
                                               {{turned, true}},
                                               {{wedge, false}},
                                               {{wedge, true}},
                                               {{ball, false}},
                                               {{ball, true}, {turned, false}},
                                               {{beam, true}, {turned, true}, {wedge, false}},
                                               {{turned, true}, {wedge, true}}};
    for (std::size_t i = 0; i < cases.size(); ++i) {
        SCOPED_TRACE(i);
        const auto rest = kept_of(points, cases[i]);
        ASSERT_GT(rest.size(), 100u);
        ASSERT_LT(rest.size(), 19900u);
        const auto left = make_cloud(folder, "left" + std::to_string(i), grid_at(map_offset), rest, 1000);
        Drawing clipped(cloud), reference(left);
        EXPECT_EQ(picture_of(clipped, camera_of(false), cases[i]), picture_of(reference, camera_of(false), {}));
        clipped.release();
        reference.release();
    }
}

TEST_P(ClipsIn, AreMovedWithoutUploadingAPointAgain)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    Drawing drawing(make_cloud(folder, "cube", grid_at(map_offset), random_points(20000, side, 6), 1000));
    const auto all = picture_of(drawing, camera_of(false), {});
    const std::uint64_t uploaded = drawing.l1()->statistics().uploaded_bytes;
    std::vector<std::vector<Pixel>> pictures{all};
    for (const double x : {2.0, 3.0, 4.0}) {
        const auto picture =
            picture_of(drawing, camera_of(false), {{Region::box({at(x, 0, 0), at(x + 1, 10, 10)}), false}});
        for (const auto& other : pictures) EXPECT_NE(picture, other);
        pictures.push_back(picture);
    }
    EXPECT_EQ(picture_of(drawing, camera_of(false), {}), all);
    EXPECT_EQ(drawing.l1()->statistics().uploaded_bytes, uploaded);
    drawing.release();
}

// The budget goes to what is seen, and reports count no hidden points but those next to the border.
TEST_P(ClipsIn, LeaveOutNodesThatTheyHide)
{
    PCM_REQUIRE_GL(context, GetParam());
    const TemporaryFolder folder;
    const auto points = random_points(40000, side, 7);
    Drawing drawing(make_cloud(folder, "cube", grid_at(map_offset), points, 1000));
    const std::vector<Clip> clips{{Region::box({at(0, 0, 0), at(2, 2, 2)}), false}};
    const auto inside = kept_of(points, clips).size();
    FrameReport report;
    picture_of(drawing, camera_of(false), clips, everything(), &report);
    EXPECT_GE(report.points_drawn, inside);
    EXPECT_LT(report.points_drawn, 12 * inside);
    EXPECT_EQ(report.clouds.front().points_drawn, report.points_drawn);
    EXPECT_LT(report.nodes_wanted, drawing.drawn.cloud()->tree()->nodes().size() / 3);
    picture_of(drawing, camera_of(false), {{Region::box({at(20, 0, 0), at(22, 2, 2)}), false}}, everything(), &report);
    EXPECT_EQ(report.points_drawn, 0u);
    EXPECT_EQ(report.nodes_wanted, 0u);
    picture_of(drawing, camera_of(false), {}, everything(), &report);
    EXPECT_EQ(report.points_drawn, 40000u);
    drawing.release();
}

TEST(ViewClips, HalfSpacesAreTheirRegions)
{
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> place(-1, 1);
    const Vec3d centre{5e5, 5e6, 100};
    const std::vector<Region> regions{
        Region::box({centre - Vec3d{0.5, 0.25, 0.5}, centre + Vec3d{0.5, 0.75, 0.125}}),
        Region::box({{-std::numeric_limits<double>::infinity(), 5e6, -std::numeric_limits<double>::infinity()},
                     {std::numeric_limits<double>::infinity(), 5e6 + 0.5, 100}}),
        Region::box({{1, 1, 1}, {0, 0, 0}}), parse_region("oriented-box 500000 5000000 100 0.3 0.2 0.7 30"),
        Region::convex(centre, {{{1, 2, 3}, 0.5}, {{-5, 1, 0}, 1}})};
    for (const Region& region : regions) {
        const auto planes = region.half_spaces();
        ASSERT_TRUE(planes);
        for (int i = 0; i < 2000; ++i) {
            const Vec3d p = centre + Vec3d{place(random), place(random), place(random)};
            bool holds = true;
            for (const Region::Plane& plane : *planes)
                holds = holds && dot(plane.normal, p - region.centre()) + plane.offset >= 0;
            ASSERT_EQ(holds, region.contains(p)) << region.text();
        }
    }
    EXPECT_FALSE(Region::sphere(centre, 1).half_spaces());
    EXPECT_FALSE(Region::ray(centre, {0, 0, 1}, 1).half_spaces());
}

// More than shaders take are tested before points are uploaded.
TEST(ViewClips, NoneIsForgotten)
{
    std::vector<Clip> clips;
    for (int i = 0; i < 6; ++i) clips.push_back({Region::box({{double(i), 0, 0}, {10, 10, 10}}), false});
    const ViewClips view(clips);
    EXPECT_EQ(view.by_point().size(), 2u);
    EXPECT_EQ(view.all().size(), 6u);
    const ClipUniforms uniforms = view.uniforms({0, 0, 0}, {1, 1, 1});
    EXPECT_EQ(uniforms.count, 4);
    EXPECT_EQ(uniforms.ends, (std::array<int, 4>{6, 12, 18, 24}));
}
