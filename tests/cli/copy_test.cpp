// Commands that change a copy: whether a tree of the copy's name is replaced is known before the work begins.
#include "tests/cli/command.h"
#include "tests/sanitizers.h"

namespace {

using namespace pcm::test;

class Copies : public CommandTest {
protected:
    Copies()
    {
        EXPECT_EQ(pcmlab("generate -q -n 4000 --no-truth " + path("a.las")).code, 0);
        EXPECT_EQ(pcmlab("build -q -m 64M " + path("a.las")).code, 0);
        EXPECT_EQ(pcmlab("generate -q -n 100 --no-truth --seed 2 " + path("b.las")).code, 0);
        EXPECT_EQ(pcmlab("build -q -m 64M " + path("b.las")).code, 0);
    }
    std::uint64_t points_of(const std::string& tree)
    {
        return Json::parse(pcmlab("info --json " + path(tree)).out)["points"].get<std::uint64_t>();
    }
};

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(Copies, PCM_NOT_UNDER_ADDRESS(ReplaceATreeOnlyWhenThatIsAsked))
{
    const std::string tree = path("a.pct"), copy = " -q -o " + path("b.pct");
    const std::string shape = " --threshold 0.3 --min-points 50 --label shape";
    for (const std::string& command :
         {"normals " + tree, "radii " + tree, "outliers " + tree, "outliers --label " + tree,
          "select --where 'classification=2' --classify 6 " + tree,
          "select --where 'classification=2' --delete " + tree,
          "select --where 'classification=2' --save-attribute mine " + tree, "detect " + tree + shape}) {
        const Result refused = pcmlab(command + copy);
        EXPECT_EQ(refused.code, 1) << command;
        EXPECT_NE(refused.err.find("choose another name or overwrite it"), std::string::npos) << refused.err;
        ASSERT_EQ(points_of("b.pct"), 100u) << command;
        const Result itself = pcmlab(command + " -q --overwrite -o " + tree);
        EXPECT_EQ(itself.code, 1) << command;
        EXPECT_NE(itself.err.find("the output is the input tree"), std::string::npos) << itself.err;
        const Result done = pcmlab(command + copy + " --overwrite");
        EXPECT_EQ(done.code, 0) << command << done.err;
        EXPECT_GT(points_of("b.pct"), 1000u) << command;
        EXPECT_EQ(points_of("a.pct"), 4000u) << command;
        ASSERT_EQ(pcmlab("build -q -m 64M --overwrite " + path("b.las")).code, 0);
    }
}

// The output is refused before the search for primitives and for the points, which would find the damage.
TEST_F(Copies, AreRefusedBeforeTheWork)
{
    {
        std::fstream chunks(folder_ / "a.pct/chunks-000.bpc", std::ios::in | std::ios::out | std::ios::binary);
        chunks.seekp(static_cast<std::streamoff>(std::filesystem::file_size(folder_ / "a.pct/chunks-000.bpc") / 2));
        chunks << "damage";
    }
    for (const std::string command : {"detect --label shape", "select --delete --where 'z > 0'"}) {
        const Result refused = pcmlab(command + " " + path("a.pct") + " -o " + path("b.pct"));
        EXPECT_EQ(refused.code, 1);
        EXPECT_NE(refused.err.find("choose another name or overwrite it"), std::string::npos) << refused.err;
        const Result damaged = pcmlab(command + " " + path("a.pct") + " -o " + path("c.pct"));
        EXPECT_EQ(damaged.code, 1);
        EXPECT_NE(damaged.err.find("pcmlab repair"), std::string::npos) << damaged.err;
    }
}

}  // namespace
