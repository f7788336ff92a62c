#include "pcm/view/camera_path.h"

#include "tests/sanitizers.h"
#include "tests/support.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/view/frustum.h"

#include <array>
#include <cmath>
#include <fstream>
#include <random>

namespace {

using namespace pcm;

constexpr double degree = pi / 180;
using Vec4 = std::array<double, 4>;

Vec4 times(const Matrix4d& m, const Vec4& v)
{
    Vec4 result{};
    for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < 4; ++c) result[r] += m[c * 4 + r] * v[c];
    return result;
}

// Eye space and normalised device coordinates of a point in source coordinates.
Vec4 in_eye(const Camera& view, const Vec3d& p)
{
    return times(view.modelview, {p[0] - view.origin[0], p[1] - view.origin[1], p[2] - view.origin[2], 1});
}

Vec3d on_screen(const Camera& view, const Vec3d& p)
{
    const Vec4 clip = times(view.projection, in_eye(view, p));
    return {clip[0] / clip[3], clip[1] / clip[3], clip[2] / clip[3]};
}

CameraFrame looking(const Vec3d& eye, const Vec3d& target, std::optional<double> angle, double height = 0)
{
    CameraFrame frame;
    frame.eye = eye;
    frame.target = target;
    frame.angle = angle;
    frame.height = height;
    return frame;
}

Box3d box_of(const Vec3d& min, const Vec3d& max)
{
    Box3d box;
    box.extend(min);
    box.extend(max);
    return box;
}

TEST(Camera, SeesItsTargetInTheMiddleAndUpIsUp)
{
    const Box3d box = box_of({499900, 4799900, 90}, {500100, 4800100, 130});
    for (const Vec3d& origin : {Vec3d{500000, 4800000, 0}, Vec3d{499900, 4799900, 90}}) {
        const CameraFrame frame = looking({499990, 4799800, 150}, {500000, 4800000, 100}, 60);
        const Camera view = view_of(frame, origin, box, 640, 480);
        EXPECT_EQ(view.origin, origin);
        EXPECT_EQ(view.width, 640);
        EXPECT_EQ(view.height, 480);
        const Vec3d middle = on_screen(view, frame.target);
        EXPECT_NEAR(middle[0], 0, 1e-9);
        EXPECT_NEAR(middle[1], 0, 1e-9);
        const Vec4 eye = in_eye(view, frame.eye);
        for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(eye[a], 0, 1e-9);
        EXPECT_NEAR(in_eye(view, frame.target)[2], -std::hypot(10, 200, 50), 1e-9);
        EXPECT_GT(on_screen(view, {500000, 4800000, 110})[1], 0.01);
        EXPECT_GT(on_screen(view, {500010, 4800000, 100})[0], 0.01);
        // A vertical angle of 60 degrees: 30 degrees above the axis is the upper edge.
        const double distance = std::hypot(10, 200, 50);
        const Vec4 top = times(view.projection, {0, distance * std::tan(30 * degree), -distance, 1});
        EXPECT_NEAR(top[1] / top[3], 1, 1e-12);
        const Vec4 side = times(view.projection, {distance * std::tan(30 * degree) * 640 / 480, 0, -distance, 1});
        EXPECT_NEAR(side[0] / side[3], 1, 1e-12);
    }
}

TEST(Camera, TheWholeBoxIsBetweenThePlanes)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> anywhere(-1, 1);
    for (int i = 0; i < 2000; ++i) {
        const double size = std::pow(10, 6 * anywhere(random));
        const Vec3d centre{5e6 * anywhere(random), 5e6 * anywhere(random), 1e3 * anywhere(random)};
        const auto point = [&](double scale) {
            return Vec3d{centre[0] + scale * anywhere(random), centre[1] + scale * anywhere(random),
                         centre[2] + scale * anywhere(random)};
        };
        const Box3d box = box_of(point(size), point(size));
        const bool parallel = i % 2;
        const CameraFrame frame = looking(point(3 * size), point(size),
                                          parallel ? std::nullopt : std::optional<double>(50), parallel ? size : 0);
        const Camera view = view_of(frame, centre, box, 300, 200);
        ASSERT_TRUE(Frustum::of(view));
        for (unsigned corner = 0; corner < 8; ++corner) {
            Vec3d p{};
            for (std::size_t a = 0; a < 3; ++a) p[a] = corner >> a & 1u ? box.max[a] : box.min[a];
            const Vec4 clip = times(view.projection, in_eye(view, p));
            EXPECT_LE(clip[2], clip[3] + 1e-6 * std::abs(clip[3]));  // never beyond the far plane
            if (parallel) EXPECT_GE(clip[2], -clip[3] - 1e-6);
            // Nor is what curves away behind it.
            auto behind = in_eye(view, p);
            behind[2] -= 0.05 * std::max({box.extent(0), box.extent(1), box.extent(2)});
            const Vec4 curved = times(view.projection, behind);
            EXPECT_LE(curved[2], curved[3] + 1e-6 * std::abs(curved[3]));
        }
    }
}

TEST(Camera, OrthographicHeightIsTheVisibleHeight)
{
    const Camera view = view_of(looking({0, 0, 50}, {0, 10, 0}, std::nullopt, 20), {0, 0, 0},
                                box_of({-100, -100, -5}, {100, 100, 5}), 200, 100);
    const Vec4 top = times(view.projection, {0, 10, -30, 1}), side = times(view.projection, {20, 0, -30, 1});
    EXPECT_NEAR(top[1] / top[3], 1, 1e-12);
    EXPECT_NEAR(side[0] / side[3], 1, 1e-12);
    EXPECT_EQ(top[3], 1);
}

TEST(Camera, BoxesThatAreEmptyFlatOrBehindGiveAValidCamera)
{
    EXPECT_TRUE(Frustum::of(view_of(looking({0, 0, 0}, {1, 0, 0}, 60), {0, 0, 0}, Box3d(), 10, 10)));
    // Entirely behind the camera; one point; one plane, face on.
    EXPECT_TRUE(
        Frustum::of(view_of(looking({0, 0, 0}, {1, 0, 0}, 60), {0, 0, 0}, box_of({-9, -1, -1}, {-8, 1, 1}), 10, 10)));
    EXPECT_TRUE(
        Frustum::of(view_of(looking({0, 0, 0}, {1, 0, 0}, 60), {0, 0, 0}, box_of({3, 0, 0}, {3, 0, 0}), 10, 10)));
    EXPECT_TRUE(Frustum::of(
        view_of(looking({0, 0, 0}, {1, 0, 0}, std::nullopt, 3), {0, 0, 0}, box_of({3, -1, -1}, {3, 1, 1}), 10, 10)));
}

// The same cloud in other units gives the same picture.
TEST(Camera, TheOverviewDoesNotDependOnTheUnit)
{
    const Box3d box{{-1, -2, -0.5}, {1, 2, 0.5}};
    const Camera usual = view_of(overview_of(box, 45, 400, 300), {0, 0, 0}, box, 400, 300);
    for (const int k : {-100, -60, -40, 40, 100, 400}) {
        const auto scaled = [&](const Vec3d& p) { return std::ldexp(1.0, k) * p; };
        const Box3d other{scaled(box.min), scaled(box.max)};
        const Camera view = view_of(overview_of(other, 45, 400, 300), {0, 0, 0}, other, 400, 300);
        for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(view.modelview[i], usual.modelview[i], 1e-12) << k;
        for (std::size_t i = 12; i < 15; ++i)
            EXPECT_NEAR(std::ldexp(view.modelview[i], -k), usual.modelview[i], 1e-12) << k;
    }
}

TEST(Camera, TheOverviewShowsAllAndFillsThePicture)
{
    for (const Box3d& box :
         {box_of({0, 0, 0}, {1, 1, 1}), box_of({499000, 4799000, 10}, {501000, 4803000, 60}),
          box_of({-1e-6, 0, 0}, {1e-6, 5e-6, 0}), box_of({0, 0, 0}, {0, 0, 900}), box_of({5e6, 5e6, 5}, {5e6, 5e6, 5})})
        for (const auto& [width, height] : {std::pair{640, 480}, {100, 800}})
            for (const std::optional<double> angle :
                 {std::optional<double>(45), std::optional<double>(), std::optional<double>(120)}) {
                const CameraFrame frame = overview_of(box, angle, width, height);
                EXPECT_NO_THROW(check(frame));
                const Camera view = view_of(frame, box.centre(), box, width, height);
                ASSERT_TRUE(Frustum::of(view));
                double largest = 0;
                Box3d shown;
                for (unsigned corner = 0; corner < 8; ++corner) {
                    const Vec3d p =
                        on_screen(view, {corner & 1u ? box.max[0] : box.min[0], corner & 2u ? box.max[1] : box.min[1],
                                         corner & 4u ? box.max[2] : box.min[2]});
                    largest = std::max({largest, std::abs(p[0]), std::abs(p[1])});
                    shown.extend(p);
                    EXPECT_LE(std::abs(p[2]), 1);
                }
                EXPECT_LE(largest, 1 / 1.05 + 1e-6);
                if (box.diagonal() == 0 || angle == 120)
                    continue;  // a wide angle keeps a distance from the nearest corner
                EXPECT_GT(largest, 1 / 1.05 - 1e-6) << box.max[1] << ' ' << width;
                const std::size_t tight =
                    shown.extent(0) > shown.extent(1) ? 0 : 1;  // the side that fills the picture is centred
                EXPECT_NEAR(shown.min[tight], -shown.max[tight], 1e-6);
            }
    EXPECT_THROW(overview_of(Box3d(), 45, 10, 10), Error);
}

// Camera path files: written, read, damaged.
class PathFile : public testing::Test {
protected:
    CameraPath read(const std::string& text)
    {
        std::ofstream(file_, std::ios::binary) << text;
        return CameraPath::read(file_);
    }
    void refused(const std::string& text, const std::string& part)
    {
        try {
            read(text);
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::bad_format) << text;
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
            EXPECT_EQ(error.path(), file_);
        }
    }
    static std::string with(const std::string& frames, const std::string& coordinates = "source")
    {
        return R"({"format": "pcm camera path", "version": 1, "name": "tour", "coordinates": ")" + coordinates +
               R"(", "frames": [)" + frames + "]}";
    }
    test::TemporaryFolder folder_;
    std::filesystem::path file_ = folder_ / "way.json";
};

TEST_F(PathFile, TextIsReadBackWithEveryDigitAndName)
{
    CameraPath path;
    path.name = "tour \"one\"";
    path.frames.push_back({{500010.1234567891, 4800020.1, 1.0 / 3}, {1, 2, 3}, {0, 0.6, 0.8}, 61.5, 0, true, "north"});
    path.frames.push_back({{0, 0, 1e-9}, {1, 2, -3e9}, {0, 1, 0}, {}, 0.125, false, ""});
    const CameraPath again = read(path.text());
    EXPECT_EQ(again.name, path.name);
    EXPECT_FALSE(again.in_box);
    ASSERT_EQ(again.frames.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(again.frames[i].eye, path.frames[i].eye);
        EXPECT_EQ(again.frames[i].target, path.frames[i].target);
        EXPECT_EQ(again.frames[i].up, path.frames[i].up);
        EXPECT_EQ(again.frames[i].angle, path.frames[i].angle);
        EXPECT_EQ(again.frames[i].height, path.frames[i].height);
        EXPECT_EQ(again.frames[i].rest, path.frames[i].rest);
        EXPECT_EQ(again.frames[i].name, path.frames[i].name);
    }
    path.in_box = true;
    EXPECT_TRUE(read(path.text()).in_box);
    EXPECT_THROW(CameraPath::of_text("{", "bookmarks"), Error);
    refused(R"({"format": "pcm camera path", "version": 1, "coordinates": "source", "frames": [
            {"eye": [0, 0, 1], "target": [0, 0, 0], "up": [0, 1, 0], "angle": 60, "name": 3}]})",
            "'name' is not a text");
}

TEST_F(PathFile, IsReadAsDocumented)
{
    const CameraPath path =
        read(with(R"({"eye": [500010, 4800020, 131.5], "target": [500050, 4800050, 120], "angle": 60},
        {"eye": [5, 4, 400], "target": [5, 4, 0], "up": [0, 1, 0], "height": 250, "rest": true})"));
    EXPECT_EQ(path.name, "tour");
    EXPECT_FALSE(path.in_box);
    ASSERT_EQ(path.frames.size(), 2u);
    EXPECT_EQ(path.frames[0].eye, (Vec3d{500010, 4800020, 131.5}));
    EXPECT_EQ(path.frames[0].up, (Vec3d{0, 0, 1}));
    EXPECT_EQ(path.frames[0].angle, 60);
    EXPECT_FALSE(path.frames[0].rest);
    EXPECT_EQ(path.frames[1].up, (Vec3d{0, 1, 0}));
    EXPECT_FALSE(path.frames[1].angle);
    EXPECT_EQ(path.frames[1].height, 250);
    EXPECT_TRUE(path.frames[1].rest);
    EXPECT_EQ(path.placed(box_of({0, 0, 0}, {1, 2, 3})).frames[0].eye, path.frames[0].eye);
    EXPECT_EQ(
        read(
            R"({"format": "pcm camera path", "version": 1, "coordinates": "box", "frames": [{"eye": [0,0,1], "target": [1,0,0], "angle": 1}]})")
            .name,
        "way");
}

TEST_F(PathFile, InABoxFitsAnyCloud)
{
    const CameraPath path = read(with(R"({"eye": [-1, 1, 2], "target": [0, 0, 0], "height": 0.5})", "box"));
    const CameraPath placed = path.placed(box_of({100, 200, 10}, {140, 220, 15}));
    EXPECT_FALSE(placed.in_box);
    EXPECT_EQ(placed.frames[0].eye, (Vec3d{100, 220, 50}));
    EXPECT_EQ(placed.frames[0].target, (Vec3d{120, 210, 10}));
    EXPECT_EQ(placed.frames[0].height, 10);
    EXPECT_THROW(path.placed(Box3d()), Error);
}

TEST_F(PathFile, ErrorsNameTheFrameAndTheProblem)
{
    const std::string good = R"({"eye": [0, 0, 1], "target": [1, 0, 0], "angle": 60})";
    EXPECT_NO_THROW(read(with(good)));
    refused("", "camera path");
    refused("{", "not JSON");
    refused("[]", "not a camera path");
    refused("{\"format\": 3}", "not a camera path");
    refused(R"({"format": "pcm camera path", "version": 2})", "'version' is not 1");
    refused(with(good, "screen"), "coordinates");
    refused(with(""), "no frames");
    refused(R"({"format": "pcm camera path", "version": 1, "coordinates": "box", "frames": {"a": 1}})", "no frames");
    refused(with(good + ", 7"), "frame 2");
    refused(with(R"({"eye": [0, 0], "target": [1, 0, 0], "angle": 60})"), "'eye'");
    refused(with(R"({"eye": [0, 0, "1"], "target": [1, 0, 0], "angle": 60})"), "'eye'");
    refused(with(R"({"eye": [0, 0, 1], "angle": 60})"), "'target'");
    refused(with(R"({"eye": [0, 0, 1], "target": [1, 0, 0]})"), "'angle' and 'height'");
    refused(with(R"({"eye": [0, 0, 1], "target": [1, 0, 0], "angle": 60, "height": 1})"), "'angle' and 'height'");
    refused(with(R"({"eye": [0, 0, 1], "target": [1, 0, 0], "angle": 180})"), "180 degrees");
    refused(with(R"({"eye": [0, 0, 1], "target": [1, 0, 0], "angle": "wide"})"), "'angle' is not a number");
    refused(with(R"({"eye": [0, 0, 1], "target": [1, 0, 0], "height": 0})"), "'height'");
    refused(with(R"({"eye": [0, 0, 1], "target": [1, 0, 0], "angle": 9, "rest": 1})"), "'rest'");
    refused(with(good + R"(, {"eye": [0, 0, 1], "target": [0, 0, 1], "angle": 60})"),
            "frame 2: 'eye' and 'target' are equal");
    refused(with(R"({"eye": [0, 0, 1], "target": [0, 0, 0], "angle": 60})"), "'up' is parallel");
    refused(with(R"({"eye": [1e308, 0, 1e999], "target": [0, 0, 0], "angle": 60})"), "");
    try {
        CameraPath::read(folder_ / "none.json");
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::not_found);
    }
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(PathFile, PCM_NOT_UNDER_THREAD(CutAnywhereIsRefused))
{
    const std::string whole = with(R"({"eye": [0, 0, 1], "target": [1, 0, 0], "angle": 60})");
    for (std::size_t length = 0; length < whole.size(); ++length) refused(whole.substr(0, length), "");
}

}  // namespace
