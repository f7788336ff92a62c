// Pictures of a small scene, as they are kept in frozen/ at a quarter of their size: a change of how points look fails
// here. Where the change is wanted, run this test with PCM_FREEZE=1 in the environment, look at the
// pictures, and commit them with it.
#include "tests/frozen_files.h"
#include "tests/offscreen_support.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include "pcm/build/builder.h"
#include "pcm/filter/neighbour_attributes.h"
#include "pcm/generate/scene.h"
#include "pcm/gl/base/gl_state.h"
#include "pcm/offscreen/image.h"
#include "pcm/offscreen/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

namespace {

using namespace pcm;
namespace fs = std::filesystem;

constexpr int wide = 160, high = 120, block = 4;

struct FrozenPicture {
    std::string name;
    CloudStyle style;
    RenderOptions options;
    CameraFrame camera;  // without an eye: the overview
    std::vector<Clip> clips;
};
void PrintTo(const FrozenPicture& picture, std::ostream* out) { *out << picture.name; }

CameraFrame from(const Vec3d& eye, const Vec3d& target, std::optional<double> angle = 50)
{
    CameraFrame frame;
    frame.eye = eye;
    frame.target = target;
    frame.angle = angle;
    frame.height = 12;
    return frame;
}

// Exact whatever the machine's speed: no budget, the last of the frames.
RenderOptions resting(unsigned frames = 1)
{
    RenderOptions options;
    options.frame_budget_ms = 1e6;
    options.smooth_frames = frames;
    return options;
}

const CameraFrame overview;
const Vec3d tank{500040, 4800020, 96};
const CameraFrame near_tank = from({500049, 4800031, 99}, tank);

CloudStyle coloured(ColourMode colour, const std::string& attribute = {})
{
    CloudStyle style;
    style.colour = colour;
    style.attribute = attribute;
    return style;
}

std::vector<FrozenPicture> of_splats()
{
    std::vector<FrozenPicture> pictures{{"fitted", {}, resting(4), overview, {}},
                                        {"near", {}, resting(), near_tank, {}}};
    for (const auto& [name, mode] : {std::pair{"constant", SplatMode::constant},
                                     {"adaptive", SplatMode::adaptive},
                                     {"affine", SplatMode::affine},
                                     {"perspective", SplatMode::perspective}}) {
        CloudStyle style;
        style.splats = mode;
        style.point_size_px = 3;
        pictures.push_back({name, style, resting(), near_tank, {}});
    }
    FrozenPicture large{"large", {}, resting(), near_tank, {}};
    large.style.radius_scale = 1.8f;
    FrozenPicture coarse{"coarse", {}, resting(), overview, {}};
    coarse.options.converge = false;
    coarse.options.target_spacing_px = 8;
    FrozenPicture gaps = coarse;
    gaps.name = "gaps";
    gaps.options.fill_gaps = false;
    FrozenPicture flat{"no_lighting", {}, resting(), near_tank, {}};
    flat.options.eye_dome = 0;
    FrozenPicture sampled = flat;
    sampled.name = "samples";
    sampled.options.samples = 4;
    const FrozenPicture parallel{"parallel", {}, resting(), from({500060, 4800040, 120}, tank, {}), {}};
    for (const FrozenPicture& more : {large, coarse, gaps, flat, sampled, parallel}) pictures.push_back(more);
    return pictures;
}

std::vector<FrozenPicture> of_colours()
{
    std::vector<FrozenPicture> pictures;
    for (const ColourTraits& traits : colour_modes())
        if (traits.mode != ColourMode::rgb)
            pictures.push_back({std::string("colour_") + traits.name,
                                coloured(traits.mode, traits.mode == ColourMode::attribute ? "point_source_id" : ""),
                                resting(),
                                overview,
                                {}});
    FrozenPicture turbo{"turbo_range", coloured(ColourMode::height), resting(), near_tank, {}};
    turbo.style.ramp = ColourRamp::turbo;
    turbo.style.range = ValueRange{94, 99};
    FrozenPicture bright{"brightness", {}, resting(), near_tank, {}};
    bright.style.brightness = 1.5f;
    bright.style.gamma = 1.8f;
    FrozenPicture some{"condition", {}, resting(), overview, {}};
    some.style.where = {parse_condition("classification=6"), parse_condition("z<98")};
    FrozenPicture inside{
        "clip", {}, resting(), overview, {{Region::box({tank - Vec3d{12, 12, 9}, tank + Vec3d{12, 12, 9}}), false}}};
    FrozenPicture outside{"clip_outside", {}, resting(), overview, {{Region::sphere(tank, 14), true}}};
    for (const FrozenPicture& more : {turbo, bright, some, inside, outside}) pictures.push_back(more);
    return pictures;
}

std::vector<FrozenPicture> frozen_pictures()
{
    std::vector<FrozenPicture> pictures = of_splats();
    for (const FrozenPicture& more : of_colours()) pictures.push_back(more);
    return pictures;
}

class FrozenPictures : public testing::TestWithParam<FrozenPicture> {
protected:
    static void SetUpTestSuite()
    {
        folder_ = std::make_unique<test::TemporaryFolder>();
        SceneOptions scene;
        scene.points = 40000;
        generate_scene(*folder_ / "site.las", scene, false);
        BuildOptions options;
        options.chunk_points = 3000;
        build_tree({*folder_ / "site.las"}, *folder_ / "site.pct", options);
        NeighbourAttributeOptions discs;
        discs.wanted.normal = discs.wanted.radius = true;
        compute_neighbour_attributes(*folder_ / "site.pct", discs);
    }
    static void TearDownTestSuite() { folder_.reset(); }

    static Image draw(const Offscreen& screen, const FrozenPicture& picture)
    {
        OffscreenScene scene({*folder_ / "site.pct"});
        scene.clip(picture.clips);
        const CameraFrame camera =
            picture.camera.eye == picture.camera.target ? overview_of(scene.box(), 45, wide, high) : picture.camera;
        const Camera view = scene.view_of(camera, wide, high);
        FrameReport report;
        do {
            screen.clear({0.2f, 0.3f, 0.4f, 1});
            report = scene.draw(view, picture.style, picture.options);
            if (report.refining && !report.repaint) scene.wait();
        } while (report.refining);
        return screen.read();
    }

    static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> FrozenPictures::folder_;

// The mean of every block of pixels.
Image quartered(const Image& image)
{
    Image small{wide / block, high / block, {}};
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x)
            for (int c = 0; c < 4; ++c) {
                int sum = 0;
                for (int k = 0; k < block * block; ++k)
                    sum += image.pixel(x * block + k % block, y * block + k / block)[c];
                small.rgba.push_back(static_cast<std::uint8_t>(sum / (block * block)));
            }
    return small;
}

TEST_P(FrozenPictures, PCM_NOT_UNDER_SANITIZERS(LookAsBefore))
{
    std::string why;
    const auto screen = test::make_offscreen(wide, high, why);
    if (!screen) GTEST_SKIP() << why;
    if (!gl_is_software()) GTEST_SKIP() << "pictures are kept of the software renderer";
    const Image now = quartered(draw(*screen, GetParam()));
    const fs::path file = fs::path(PCM_FROZEN_PICTURES) / (GetParam().name + ".png");
    if (test::is_freezing()) {
        write_png(file, now, false);
        GTEST_SKIP() << "written: " << file;
    }
    const Image kept = read_png(file);
    ASSERT_EQ(kept.rgba.size(), now.rgba.size());
    double sum = 0;
    int largest = 0;
    for (std::size_t i = 0; i < now.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        const int difference = std::abs(int(now.rgba[i]) - int(kept.rgba[i]));
        sum += difference;
        largest = std::max(largest, difference);
    }
    EXPECT_LE(largest, 6) << "of 255";
    EXPECT_LE(sum / static_cast<double>(now.rgba.size()), 0.2) << "on average";
}

INSTANTIATE_TEST_SUITE_P(Of, FrozenPictures, testing::ValuesIn(frozen_pictures()), [](const auto& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST(FrozenPictureFiles, AreThoseThatAreDrawn)
{
    std::vector<std::string> names;
    for (const FrozenPicture& picture : frozen_pictures()) names.push_back(picture.name);
    test::expect_files_of(names, PCM_FROZEN_PICTURES);
}

}  // namespace
