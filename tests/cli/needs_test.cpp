// What is decoded, read, uploaded, compiled and loaded for a scene is what it shows, and nothing else.
#include "tests/cli/command.h"

#include "pcm/tree/tree.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

using Names = std::vector<std::string>;

class Needs : public CommandTest {
protected:
    void SetUp() override
    {
        ASSERT_EQ(pcmlab("generate -q -n 60000 --no-truth --origin 0 0 0 " + path("scene.las")).code, 0);
        ASSERT_EQ(pcmlab("build -q --chunk-points 4000 " + path("scene.las") + " -o " + path("scene.pct")).code, 0);
    }

    // The answer of a picture from a corner, in which all points are, unless the options have another camera.
    Json drawn(const std::string& tree, const std::string& options)
    {
        const std::string camera =
            options.find("--eye") == std::string::npos ? " --eye 140 140 90 --target 30 30 -3" : "";
        const Result result = pcmlab("render " + path(tree) + " -o " + path("a.png") +
                                     " --overwrite --size 160x120 --json -q" + camera + " " + options);
        drawing_ = result;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }

    // Bytes of these columns, headers included, in the nodes that have points in `box`.
    std::uint64_t stored_bytes(const std::string& name, const Names& attributes, bool sizes,
                               const pcm::Box3d& box) const
    {
        const auto tree = pcm::Tree::open(folder_ / name);
        pcm::ColumnSet columns = pcm::ColumnSet::named(tree->info().schema, attributes);
        columns.sizes = sizes;
        for (pcm::NodeId node = 0; node < tree->nodes().size(); ++node)
            if (tree->nodes()[node].points > 0 && tree->box(node).intersects(box)) tree->read_chunk(node, columns);
        return tree->reads().bytes;
    }

    Result drawing_;
};

const pcm::Box3d everywhere{{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}};

// Columns of the picture, and what a point takes in video memory, bytes.
struct Scene {
    const char* what;
    const char* options;
    Names attributes;  // decoded in addition to positions and sizes
    unsigned vertex_bytes;
};

TEST_F(Needs, PCM_NOT_UNDER_SANITIZERS(APictureDecodesAndUploadsWhatItShows))
{
    const std::vector<Scene> scenes = {
        {"positions alone", "--colour uniform", {}, 16},
        {"its own colours", "", {"rgb"}, 20},
        {"heights, which positions are", "--colour height", {}, 16},
        {"one attribute of thirteen", "--colour intensity", {"intensity"}, 20},
        {"one class", "--colour uniform --where classification=2", {"classification"}, 16},
    };
    for (const Scene& scene : scenes) {
        SCOPED_TRACE(scene.what);
        const Json answer = drawn("scene.pct", scene.options);
        PCM_REQUIRE_DRAWING(drawing_);
        ASSERT_EQ(drawing_.code, 0) << drawing_.err;
        const Json &reads = answer["reads"][0], &picture = answer["pictures"][0], &cloud = picture["clouds"][0];
        Names expected = {"positions", "sizes"};
        for (const std::string& name : scene.attributes) expected.push_back(name);
        EXPECT_EQ(reads["columns"], Json(expected));
        EXPECT_EQ(reads["bytes"], stored_bytes("scene.pct", scene.attributes, true, everywhere));
        EXPECT_EQ(reads["chunks"], picture["nodes_drawn"]) << "a chunk is read once";
        EXPECT_EQ(cloud["vertex_bytes"], scene.vertex_bytes);
        EXPECT_EQ(picture["uploaded_bytes"], scene.vertex_bytes * cloud["points_drawn"].get<std::uint64_t>());
    }
}

TEST_F(Needs, PCM_NOT_UNDER_SANITIZERS(NormalsAndRadiiAreReadWhereSplatsAreMadeOfThem))
{
    ASSERT_EQ(pcmlab("normals --radii -q " + path("scene.pct") + " -o " + path("discs.pct")).code, 0);
    Json answer = drawn("discs.pct", "--colour uniform --splats perspective");
    PCM_REQUIRE_DRAWING(drawing_);
    ASSERT_EQ(drawing_.code, 0) << drawing_.err;
    // Sizes stand in for the radii of points that have none.
    EXPECT_EQ(answer["reads"][0]["columns"], Json(Names{"positions", "sizes", "normal", "radius"}));
    EXPECT_EQ(answer["pictures"][0]["clouds"][0]["vertex_bytes"], 32);
    answer = drawn("discs.pct", "--colour uniform --splats constant");
    EXPECT_EQ(answer["reads"][0]["columns"], Json(Names{"positions"}));
    EXPECT_EQ(answer["pictures"][0]["clouds"][0]["vertex_bytes"], 12);
}

TEST_F(Needs, PCM_NOT_UNDER_SANITIZERS(AClipBoxAndAFarViewReadTheirNodesAlone))
{
    Json answer = drawn("scene.pct", "--colour uniform --clip 'box 0 0 -20 15 15 20'");
    PCM_REQUIRE_DRAWING(drawing_);
    ASSERT_EQ(drawing_.code, 0) << drawing_.err;
    const std::uint64_t in_box = stored_bytes("scene.pct", {}, true, {{0, 0, -20}, {15, 15, 20}});
    EXPECT_EQ(answer["reads"][0]["bytes"], in_box);
    EXPECT_LT(in_box, stored_bytes("scene.pct", {}, true, everywhere) / 2);
    answer = drawn("scene.pct", "--colour uniform --eye 6000 6000 4000 --target 30 30 0 --until target");
    EXPECT_EQ(answer["reads"][0]["chunks"], 1);
    EXPECT_EQ(answer["pictures"][0]["nodes_drawn"], 1);
}

TEST_F(Needs, PCM_NOT_UNDER_SANITIZERS(ProgramsAreThoseOfThePicture))
{
    // One of splats and one that brings the picture into the host's; lighting and the mean of frames are one more each.
    const Json one = drawn("scene.pct", "--converge 1 --eye-dome 0 --colour uniform");
    PCM_REQUIRE_DRAWING(drawing_);
    ASSERT_EQ(drawing_.code, 0) << drawing_.err;
    EXPECT_EQ(one["pictures"][0]["programs"], 2);
    EXPECT_EQ(drawn("scene.pct", "--colour uniform")["pictures"][0]["programs"], 4);
}

// Names of the libraries that the command loads, the loader and the vdso left out.
std::set<std::string> libraries_of(const fs::path& log)
{
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(log.parent_path())) {
        if (entry.path().filename().string().rfind(log.filename().string() + ".", 0) != 0) continue;
        std::ifstream file(entry.path());
        for (std::string line; std::getline(file, line);) {
            const std::size_t at = line.find("calling init: ");
            if (at == std::string::npos) continue;
            const std::string name = fs::path(line.substr(at + 14)).filename().string();
            if (name.rfind("ld-", 0) != 0) names.insert(name.substr(0, name.find(".so")));
        }
    }
    return names;
}

TEST_F(Needs, PCM_NOT_UNDER_SANITIZERS(LibrariesThatDrawOrFitForOthersAreNotLoaded))
{
    const std::set<std::string> few = {"libpcmlab", "libstdc++", "libm", "libgcc_s", "libc", "libdxflib"};
    const std::vector<std::string> commands = {"query --count --box 0 0 -9 9 9 9 " + path("scene.pct"),
                                               "fit --at 40 13.2 -4 --shape cylinder " + path("scene.pct"),
                                               "radii " + path("scene.pct") + " -o " + path("radii.pct")};
    for (const std::string& command : commands) {
        const fs::path log = folder_ / ("loaded-" + command.substr(0, 3));
        pcmlab(command + " -q", "LD_DEBUG=files LD_DEBUG_OUTPUT='" + log.string() + "'");
        const std::set<std::string> loaded = libraries_of(log);
        ASSERT_TRUE(loaded.count("libpcmlab")) << "the loader's log is not understood";
        for (const std::string& name : loaded) EXPECT_TRUE(few.count(name)) << command << " loads " << name;
    }
}

}  // namespace
