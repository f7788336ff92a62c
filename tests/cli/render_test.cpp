// pcmlab render as a user meets it: pictures, JSON, exit codes.

#include "tests/answer_faults.h"
#include "tests/cli/command.h"
#include "tests/paths.h"
#include "tests/sanitizers.h"

#include <fstream>
#include <iterator>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file)
{
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

class RenderWithout : public CommandTest {};

// Debian's packages and scripts of others may install pcmlab without pcmlab-render.
// Pictures are drawn under the address sanitizer by the tests of the rooms that draw; here it takes minutes.
TEST_F(RenderWithout, PCM_NOT_UNDER_ADDRESS(PcmlabSaysWhatIsMissing))
{
    fs::copy_file(pcm::paths::command, folder_ / "pcmlab");
    const std::string command = path("pcmlab") + " render a.pct -o a.png 2>" + path("message.txt");
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
    const std::string message = bytes_of(folder_ / "message.txt");
    EXPECT_NE(message.find((folder_ / "pcmlab-render").string()), std::string::npos) << message;
    EXPECT_NE(message.find("is missing"), std::string::npos) << message;
    EXPECT_NE(pcmlab("--help").out.find("render"), std::string::npos);
    // What needs no OpenGL does not start it.
    EXPECT_EQ(std::system((path("pcmlab") + " render --help >" + path("help.txt")).c_str()), 0);
    EXPECT_NE(bytes_of(folder_ / "help.txt").find("--eye-dome"), std::string::npos);
    const std::string wrong = path("pcmlab") + " render a.pct -o a.png --converge 0 2>" + path("message.txt");
    EXPECT_EQ(WEXITSTATUS(std::system(wrong.c_str())), 2);
}

TEST_F(RenderWithout, PCM_NOT_UNDER_ADDRESS(PcmlabItselfNeedsNoOpenGL))
{
    const std::string program = bytes_of(pcm::paths::command);
    for (const char* library : {"libGL.so", "libEGL.so", "libOpenGL.so", "libGLEW.so", "libpng16.so"})
        EXPECT_EQ(program.find(library), std::string::npos) << library;
}

}  // namespace

#ifdef PCM_HAVE_RENDER

#include "pcm/offscreen/image.h"

namespace {

using pcm::Image;
using pcm::read_png;

class Render : public CommandTest {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 20000, 4), {{0.01, 0.01, 0.01}, {500000, 4800000, 0}});
        ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las")).code, 0);
        const Result tried = pcmlab("render " + path("in.pct") + " -o " + path("tried.png") + " --size 16x16");
        PCM_REQUIRE_DRAWING(tried);
        ASSERT_EQ(tried.code, 0) << tried.err;
    }
    // The JSON of a small picture.
    Json render(const std::string& arguments, const std::string& size = "160x120")
    {
        const Result result = pcmlab("render --json --size " + size + " " + arguments);
        EXPECT_EQ(result.code, 0) << arguments << ": " << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
    Image picture(const std::string& name) { return read_png(folder_ / name); }
    static std::size_t covered(const Image& image)
    {
        std::size_t count = 0;
        for (std::size_t i = 3; i < image.rgba.size(); i += 4) count += image.rgba[i] > 0;
        return count;
    }
};

// Chunks that are larger than the whole cache are drawn all the same, one after the other; heights are found in them
// first.
TEST_F(Render, PCM_NOT_UNDER_ADDRESS(ACacheTooSmallForAChunkIsSlowAndNotEndless))
{
    const Json small = render(path("in.pct") + " --colour height --converge 1 --l2 1 -o " + path("small.png"));
    EXPECT_EQ(small["pictures"][0]["points_drawn"], 20000);
    EXPECT_EQ(small["pictures"][0]["full_resolution"], true);
}

TEST_F(Render, PCM_NOT_UNDER_ADDRESS(TheWholeCloudInFull))
{
    const Json json = render(path("in.pct") + " -o " + path("a.png"));
    ASSERT_EQ(json["pictures"].size(), 1u);
    const Json& drawn = json["pictures"][0];
    EXPECT_EQ(drawn["points_drawn"], 20000);
    EXPECT_EQ(drawn["full_resolution"], true);
    EXPECT_EQ(drawn["screen_error_px"], 0);
    EXPECT_GE(drawn["uploaded_bytes"], 20000 * 12);
    EXPECT_GT(drawn["ms"], 0);
    EXPECT_EQ(drawn["file"], (folder_ / "a.png").string());
    EXPECT_EQ(pcm::test::faults_of_answer(*pcm::ops::find_operation("render"), pcm::ops::Json::parse(json.dump())), "");
    EXPECT_EQ(json["points"], 20000);
    EXPECT_EQ(json["points_in"], 20000);
    EXPECT_EQ(json["output"], (folder_ / "a.png").string());
    EXPECT_FALSE(json["drawn_with"].get<std::string>().empty());
    const Image image = picture("a.png");
    EXPECT_EQ(image.width, 160);
    EXPECT_EQ(image.height, 120);
    EXPECT_GT(covered(image), 160u * 120 / 10);
    EXPECT_EQ(image.pixel(0, 0)[3], 0);  // the background is transparent

    // Full resolution draws every point, whatever the budgets and the memory: the same picture.
    for (const char* budget :
         {"", " --point-budget 900", " --frame-budget 1", " --l1 1M", " --target-px 50 --threads 1"}) {
        const Json again = render(path("in.pct") + " --overwrite -o " + path("b.png") + budget);
        EXPECT_EQ(again["pictures"][0]["full_resolution"], true) << budget;
        EXPECT_EQ(again["pictures"][0]["points_drawn"], 20000) << budget;
        EXPECT_EQ(picture("b.png"), image) << budget;
    }
    const Result text = pcmlab("render --size 32x32 " + path("in.pct") + " -o " + path("c.png"));
    EXPECT_NE(text.out.find("20,000 points, every point in view"), std::string::npos) << text.out;
}

TEST_F(Render, PCM_NOT_UNDER_ADDRESS(ClipsShowWhatConditionsOnCoordinatesShow))
{
    const Json box = Json::parse(pcmlab("query --json --count " + path("in.pct")).out)["bounds"];
    const std::string middle = std::to_string((box["min"][0].get<double>() + box["max"][0].get<double>()) / 2 + 0.005);
    const std::string half = "box -1e9 -1e9 -1e9 " + middle + " 1e9 1e9";
    const auto both = [&](const std::string& clips, const std::string& where) {
        render(path("in.pct") + " --overwrite -o " + path("a.png") + " " + clips);
        render(path("in.pct") + " --overwrite -o " + path("b.png") + " --where '" + where + "'");
        EXPECT_EQ(picture("a.png"), picture("b.png")) << clips;
        EXPECT_GT(covered(picture("a.png")), 500u);
    };
    both("--clip '" + half + "'", "x<" + middle);
    both("--clip-outside '" + half + "'", "x>" + middle);
    const Json none = render(path("in.pct") + " --overwrite -o " + path("a.png") + " --clip '" + half +
                             "' --clip-outside '" + half + "'");
    EXPECT_EQ(covered(picture("a.png")), 0u);
    const Result text =
        pcmlab("render --size 32x32 " + path("in.pct") + " -o " + path("c.png") + " --clip '" + half + "'");
    EXPECT_NE(text.out.find("every point in view that is not clipped"), std::string::npos) << text.out;
    EXPECT_NE(pcmlab("render " + path("in.pct") + " -o " + path("d.png") + " --clip 'box 1 2'").code, 0);
}

// Not under the address sanitizer: much drawing in software.
TEST_F(Render, PCM_NOT_UNDER_ADDRESS(UntilTheTargetWithinABudget))
{
    const Json few =
        render(path("in.pct") + " -o " + path("few.png") + " --until target --target-px 0.01 --point-budget 3000");
    EXPECT_LE(few["pictures"][0]["points_drawn"], 3000);
    EXPECT_GT(few["pictures"][0]["points_drawn"], 0);
    EXPECT_EQ(few["pictures"][0]["full_resolution"], false);
    EXPECT_GT(few["pictures"][0]["screen_error_px"], 0);
    const Json target = render(path("in.pct") + " -o " + path("target.png") + " --until target --target-px 3");
    EXPECT_LE(target["pictures"][0]["screen_error_px"], 3);
    EXPECT_LT(target["pictures"][0]["points_drawn"], 20000);
}

// More than a first frame draws, before the time that points take is known.
TEST_F(Render, PCM_NOT_UNDER_ADDRESS(TheTargetIsReachedByLargeClouds))
{
    ASSERT_EQ(pcmlab("generate " + path("large.las") + " -n 350000 --no-truth").code, 0);
    ASSERT_EQ(pcmlab("build " + path("large.las") + " -o " + path("large.pct") + " --chunk-points 5000").code, 0);
    const std::string some = " --converge 1 --until target --target-px 0.01 --overwrite -o " + path("a.png");
    for (const char* time : {"", " --frame-budget 100000"}) {
        const Json all = render(path("large.pct") + some + time);
        EXPECT_EQ(all["pictures"][0]["points_drawn"], 350000) << time;
        EXPECT_LE(all["pictures"][0]["screen_error_px"], 0.01) << time;
    }
    const Json few = render(path("large.pct") + some + " --point-budget 320000");
    EXPECT_GT(few["pictures"][0]["points_drawn"], 305000);
    EXPECT_LE(few["pictures"][0]["points_drawn"], 320000);
}

// Smooth by default, on request of more or fewer frames or none.
TEST_F(Render, PCM_NOT_UNDER_ADDRESS(ThePictureIsTheMeanOfFrames))
{
    const auto partly = [&](const std::string& name) {
        const Image image = picture(name);
        std::size_t count = 0;
        for (std::size_t i = 3; i < image.rgba.size(); i += 4) count += image.rgba[i] > 0 && image.rgba[i] < 255;
        return count;
    };
    for (const auto& [option, frames] : {std::pair{"", 16}, {" --converge 5", 5}, {" --converge 1", 1}}) {
        const Json json = render(path("in.pct") + " --overwrite -o " + path("a.png") + option);
        EXPECT_EQ(json["pictures"][0]["frames_averaged"], frames) << option;
        EXPECT_EQ(json["pictures"][0]["full_resolution"], true);
        EXPECT_EQ(json["pictures"][0]["points_drawn"], 20000);
        EXPECT_EQ(partly("a.png") > 20, frames > 1) << option;
    }
    const Json target =
        render(path("in.pct") + " --overwrite -o " + path("a.png") + " --until target --target-px 3 --converge 4");
    EXPECT_EQ(target["pictures"][0]["frames_averaged"], 4);
    EXPECT_GT(partly("a.png"), 20u);
    const std::string small = "render --overwrite --size 32x32 " + path("in.pct") + " -o " + path("a.png");
    EXPECT_NE(pcmlab(small).out.find("every point in view, mean of 16 frames, in"), std::string::npos);
    EXPECT_EQ(pcmlab(small + " --converge 1").out.find("frames"), std::string::npos);
    for (const char* wrong : {" --converge 0", " --converge 257", " --converge x"})
        EXPECT_EQ(pcmlab(small + wrong).code, 2) << wrong;
}

TEST_F(Render, PCM_NOT_UNDER_ADDRESS(DiscsArePerspectiveOnes))
{
    ASSERT_EQ(pcmlab("normals --in-place --radii " + path("in.pct")).code, 0);
    render(path("in.pct") + " -o " + path("a.png") + " --discs");
    render(path("in.pct") + " -o " + path("b.png") + " --splats perspective");
    render(path("in.pct") + " -o " + path("c.png"));
    EXPECT_EQ(picture("a.png"), picture("b.png"));
    EXPECT_FALSE(picture("a.png") == picture("c.png"));
    EXPECT_EQ(pcmlab("render " + path("in.pct") + " -o " + path("d.png") + " --discs --splats constant").code, 2);
}

TEST_F(Render, PCM_NOT_UNDER_ADDRESS(BackgroundAndColourAreAsRequested))
{
    render(path("in.pct") + " -o " + path("a.png") +
           " --background white --eye-dome 0 --converge 1 --uniform-colour '#ff8000'");
    Image image = picture("a.png");
    EXPECT_EQ(image.pixel(0, 0)[0], 255);
    EXPECT_EQ(image.pixel(0, 0)[2], 255);
    std::size_t orange = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const std::uint8_t* p = &image.rgba[i];
        EXPECT_EQ(p[3], 255);
        const bool white = p[0] == 255 && p[1] == 255 && p[2] == 255;
        const bool point = p[0] == 255 && p[1] == 128 && p[2] == 0;
        ASSERT_TRUE(white || point) << int(p[0]) << ' ' << int(p[1]) << ' ' << int(p[2]);
        orange += point;
    }
    EXPECT_GT(orange, 1000u);
    // With several samples per pixel, pixels at edges are partly covered; on a transparent background they keep their
    // colour.
    render(path("in.pct") + " --overwrite -o " + path("a.png") +
           " --samples 4 --splats constant --point-size 3.5 --eye-dome 0 --uniform-colour 255,128,0");
    image = picture("a.png");
    std::size_t partly = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const std::uint8_t* p = &image.rgba[i];
        if (p[3] == 0) continue;
        EXPECT_NEAR(p[0], 255, 3);
        EXPECT_NEAR(p[1], 128, 3);
        EXPECT_NEAR(p[2], 0, 3);
        partly += p[3] < 255;
    }
    EXPECT_GT(partly, 0u);
}

TEST_F(Render, PCM_NOT_UNDER_ADDRESS(TheCameraIsWhereItIsPut))
{
    LasRecord point{};
    point.x = 1000;
    point.y = 2000;
    point.z = 300;
    point.red = 65535;
    LasRecord other = point;
    other.x += 300;  // 3 units to the right, seen from above with y upwards
    other.red = 0;
    other.blue = 65535;
    write_las(folder_ / "two.las", {point, other}, {{0.01, 0.01, 0.01}, {0, 0, 0}});
    ASSERT_EQ(pcmlab("build " + path("two.las")).code, 0);
    // Ten units from bottom to top are 100 pixels.
    const std::string squares = " --splats constant --point-size 4 --eye-dome 0 --converge 1";
    render(
        path("two.pct") + " -o " + path("a.png") + " --eye 10 20 50 --target 10 20 3 --up 0 1 0 --height 10" + squares,
        "100x100");
    const Image image = picture("a.png");
    EXPECT_EQ(covered(image), 2u * 16);
    EXPECT_EQ(image.pixel(50, 50)[0], 255);
    EXPECT_EQ(image.pixel(80, 50)[2], 255);
    EXPECT_EQ(image.pixel(20, 50)[3], 0);
    // In perspective, 90 degrees, 5 units away: the same ten units.
    render(path("two.pct") + " -o " + path("b.png") + " --eye 10 20 8 --target 10 20 3 --up 0 1 0 --angle 90" + squares,
           "100x100");
    EXPECT_EQ(picture("b.png"), image);
    // Without a camera, everything is in view.
    EXPECT_EQ(covered((render(path("two.pct") + " -o " + path("c.png") + squares), picture("c.png"))), 2u * 16);
    EXPECT_EQ(
        covered((render(path("two.pct") + " -o " + path("d.png") + squares + " --orthographic"), picture("d.png"))),
        2u * 16);
}

// Splats as large as the distances of points, with eye-dome lighting: surfaces without holes, and shape without
// colours.
TEST_F(Render, PCM_NOT_UNDER_ADDRESS(TheDefaultLook))
{
    const std::string white =
        path("in.pct") + " --overwrite --converge 1 --uniform-colour '#ffffff' -o " + path("a.png");
    render(white);
    const Image usual = picture("a.png");
    render(white + " --splats fitted --eye-dome 1");
    EXPECT_EQ(picture("a.png"), usual);
    render(white + " --splats constant --point-size 1");
    EXPECT_GT(covered(usual), covered(picture("a.png")));
    render(white + " --splats adaptive");
    EXPECT_FALSE(picture("a.png") == usual);
    render(white + " --eye-dome 0");
    const Image flat = picture("a.png");
    EXPECT_EQ(covered(flat), covered(usual));
    for (std::size_t i = 0; i < flat.rgba.size(); i += 4) {
        if (flat.rgba[i + 3] == 0) continue;
        EXPECT_EQ(flat.rgba[i], 255);
    }
    // Stairs show their steps.
    std::ofstream stairs(folder_ / "stairs.xyz");
    for (int i = 0; i < 14400; ++i) stairs << i % 120 << " " << i / 120 << " " << 9 * (i / 120 / 30) << "\n";
    stairs.close();
    ASSERT_EQ(pcmlab("build " + path("stairs.xyz")).code, 0);
    render(path("stairs.pct") + " --uniform-colour '#ffffff' --eye 60 280 150 --target 60 60 10 -o " + path("s.png"));
    const Image steps = picture("s.png");
    std::size_t darker = 0;
    for (std::size_t i = 0; i < steps.rgba.size(); i += 4) darker += steps.rgba[i + 3] != 0 && steps.rgba[i] < 240;
    EXPECT_GT(darker, 100u);
    // A flat cloud seen from the front: its splats curve away behind it, and are seen whole.
    std::ofstream text(folder_ / "flat.xyz");
    for (int i = 0; i < 400; ++i) text << i % 20 << " " << i / 20 << " 3\n";
    text.close();
    ASSERT_EQ(pcmlab("build " + path("flat.xyz")).code, 0);
    for (const char* projection : {" --height 22", " --angle 50"}) {
        render(path("flat.pct") + " --overwrite -o " + path("b.png") +
                   " --eye 9.5 9.5 30 --target 9.5 9.5 3 --up 0 1 0" + projection,
               "100x100");
        EXPECT_GT(covered(picture("b.png")), 6000u) << projection;
        EXPECT_GT(picture("b.png").pixel(50, 50)[3], 0) << projection;
    }
}

TEST_F(Render, PCM_NOT_UNDER_ADDRESS(APathGivesOnePicturePerFrame))
{
    std::ofstream(folder_ / "way.json")
        << R"({"format": "pcm camera path", "version": 1, "coordinates": "box", "frames": [
        {"eye": [0, -3, 2], "target": [0, 0, 0], "angle": 45}, {"eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "height": 2.5, "rest": true}]})";
    const Json json = render(path("in.pct") + " --path " + path("way.json") + " -o " + path("out/deep"));
    ASSERT_EQ(json["pictures"].size(), 2u);
    for (const char* name : {"out/deep/0001.png", "out/deep/0002.png"})
        EXPECT_GT(covered(picture(name)), 1000u) << name;
    for (const Json& drawn : json["pictures"]) EXPECT_EQ(drawn["full_resolution"], true);
    EXPECT_FALSE(picture("out/deep/0001.png") == picture("out/deep/0002.png"));
    const Result text =
        pcmlab("render --size 160x120 " + path("in.pct") + " --path " + path("way.json") + " -o " + path("w%02d.png"));
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_NE(text.out.find("2 pictures"), std::string::npos) << text.out;
    EXPECT_EQ(bytes_of(folder_ / "w02.png"), bytes_of(folder_ / "out/deep/0002.png"));
    const Result one = pcmlab("render " + path("in.pct") + " --path " + path("way.json") + " -o " + path("w.png"));
    EXPECT_EQ(one.code, 1);
    EXPECT_NE(one.err.find("picture%04d.png"), std::string::npos) << one.err;
}

TEST_F(Render, PCM_NOT_UNDER_ADDRESS(SeveralTreesAtOnce))
{
    write_las(folder_ / "more.las", records(Shape::volume, 3000, 9), {{0.01, 0.01, 0.01}, {500000, 4800000, 0}});
    ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("more.las")).code, 0);
    const Json json = render(path("in.pct") + " " + path("more.pct") + " -o " + path("a.png"));
    EXPECT_EQ(json["pictures"][0]["points_drawn"], 23000);
    EXPECT_EQ(json["pictures"][0]["full_resolution"], true);
}

TEST_F(Render, PCM_NOT_UNDER_ADDRESS(AMissingAttributeIsReported))
{
    const Json json = render(path("in.pct") + " -o " + path("a.png") + " --splats perspective");
    ASSERT_EQ(json["notes"].size(), 1u);
    // Every point has a size, which stands for a radius.
    EXPECT_EQ(json["notes"][0], "the cloud has no normals: adaptive splats are drawn");
}

TEST_F(Render, RefusesWithTheReason)
{
    const auto refused = [&](const std::string& arguments, int code, const std::string& part) {
        const Result result = pcmlab("render " + arguments);
        EXPECT_EQ(result.code, code) << arguments << result.out;
        EXPECT_NE((result.err + result.out).find(part), std::string::npos) << arguments << ": " << result.err;
    };
    const std::string in = path("in.pct") + " ", out = " -o " + path("a.png") + " ";
    refused("", 2, "required");
    refused(in, 2, "--output");
    refused(in + "-o " + path("a.jpg"), 1, "PNG");
    refused(in + "-o " + path("a%s.png"), 1, "%");
    refused(in + "-o " + path("tried.png"), 1, "already");
    refused(in + out + "--size 12", 1, "12");
    refused(in + out + "--size 100000x100000", 1, "100000");
    refused(in + out + "--colour pink", 1, "an attribute: intensity");
    refused(in + out + "--splats round", 2, "round");
    refused(in + out + "--background pink", 1, "pink");
    refused(in + out + "--background 1,2,300", 1, "1,2,300");
    refused(in + out + "--l1 100K", 1, "video memory");
    refused(in + out + "--samples 0", 2, "samples");
    refused(in + out + "--angle 180", 1, "180");
    refused(in + out + "--height -1", 1, "height");
    refused(in + out + "--eye 1 2", 2, "--eye");
    refused(in + out + "--eye 1 2 3 --target 1 2 3", 1, "'eye'");
    refused(in + out + "--angle 50 --height 3", 2, "leave out --angle");
    refused(in + out + "--path " + path("none.json") + " --up 0 0 1", 2, "leave out --eye");
    refused(in + out + "--discs --splats fitted", 2, "--splats");
    refused(in + out + "--path " + path("none.json"), 1, "none.json");
    refused(path("none.pct") + out, 1, "none.pct");
    refused(in + in + out, 1, "twice");
    refused(in + "-o " + path("none/a.png"), 1, "none/a.png");
    EXPECT_FALSE(fs::exists(folder_ / "a.png"));
    EXPECT_EQ(pcmlab("render --help").code, 0);
    EXPECT_NE(pcmlab("render --help").out.find("pcmlab render"), std::string::npos);
}

TEST_F(Render, ADamagedTreeGivesNoPicture)
{
    for (const auto& entry : fs::directory_iterator(folder_ / "in.pct")) {
        if (entry.path().extension() != ".bpc") continue;
        std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
        for (std::uintmax_t at = 300; at < entry.file_size(); at += 301) {
            file.seekp(static_cast<std::streamoff>(at));
            file.put('#');
        }
    }
    const Result result = pcmlab("render " + path("in.pct") + " -o " + path("a.png"));
    EXPECT_EQ(result.code, 1) << result.out;
    EXPECT_NE(result.err.find(".bpc"), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(folder_ / "a.png"));
}

// A cloud of any unit is drawn as the same one in metres, or refused with the reason: never an empty picture of every
// point.
TEST_F(Render, PCM_NOT_UNDER_ADDRESS(CloudsOfAnyUnit))
{
    std::size_t usual = 0;
    for (const int power : {0, -150, -100, -40, -33, -30, -20, -12, -9, 9, 20, 36, 37, 38, 60, 140}) {
        SCOPED_TRACE(power);
        std::ofstream text(folder_ / "unit.xyz");
        for (int i = 0; i < 4000; ++i)
            text << i % 20 << "e" << power << " " << i / 20 % 20 << "e" << power << " " << i / 400 << "e" << power
                 << "\n";
        text.close();
        const Result built = pcmlab("build --overwrite " + path("unit.xyz") + " -o " + path("unit.pct"));
        if (built.code != 0) {
            EXPECT_EQ(power, -150) << built.err;
            continue;
        }
        const std::string command = "render --overwrite --size 100x80 " + path("unit.pct") + " -o " + path("unit.png");
        const Result said = pcmlab(command);
        if (said.code != 0) {
            EXPECT_TRUE(power < -33 || power > 35) << said.err;
            EXPECT_NE(said.err.find("single precision"), std::string::npos) << said.err;
            continue;
        }
        EXPECT_NE(said.out.find("every point in view"), std::string::npos) << said.out;
        const Json drawn = Json::parse(pcmlab(command + " --json").out)["pictures"][0];
        const std::size_t pixels = covered(picture("unit.png"));
        EXPECT_EQ(drawn["pixels"], pixels);
        EXPECT_EQ(drawn["full_resolution"], true);
        EXPECT_GT(pixels, 800u);
        if (power == 0) usual = pixels;
        // Which of the lattice's points are a surface's depends on their order, which the grid's rounding decides.
        EXPECT_NEAR(static_cast<double>(pixels), static_cast<double>(usual), 0.08 * static_cast<double>(usual));
    }
}

TEST_F(Render, PCM_NOT_UNDER_ADDRESS(APictureWithoutPointsClaimsNothing))
{
    const std::string command = "render --overwrite --size 60x40 " + path("in.pct") + " -o " + path("a.png");
    const Result away = pcmlab(command + " --eye 500000 4800000 500 --target 500000 4800000 900 --up 0 1 0");
    EXPECT_EQ(away.code, 0) << away.err;
    EXPECT_EQ(away.out.find("every point"), std::string::npos) << away.out;
    EXPECT_NE(away.out.find("no point is in view"), std::string::npos) << away.out;
    const Result far = pcmlab(command + " --eye 1e50 0 0");
    EXPECT_EQ(far.code, 1) << far.out;
    EXPECT_NE(far.err.find("the view reaches"), std::string::npos) << far.err;
}

}  // namespace

#endif
