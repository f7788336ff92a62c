// File systems without locks, as network file systems can be mounted: what is safe is done, and the rest says why not.

#include "tests/cli/command.h"
#include "tests/faults.h"

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class NoLocks : public CommandTest {
protected:
    NoLocks()
    {
        EXPECT_EQ(pcmlab("generate -n 3000 --no-truth " + path("a.las")).code, 0);
        EXPECT_EQ(pcmlab("build -m 64M " + path("a.las")).code, 0);
        fs::create_directory(work_);
        fs::copy(folder_ / "a.las", work_ / "a.las");
        fs::copy(folder_ / "a.pct", work_ / "a.pct", fs::copy_options::recursive);
    }

    // With no locks, or without something else of tests/faults/preload.cpp, below the folder "work".
    Result without_locks(const std::string& arguments, const std::string& without = "flock")
    {
        return pcmlab(arguments, "TMPDIR=" + work("tmp") + " LD_PRELOAD='" + std::string(paths::faults) +
                                     "' ASAN_OPTIONS=" + asan_ + " PCM_FAULT=count PCM_FAULT_WITHOUT=" + without +
                                     " PCM_FAULT_UNDER='" + fs::weakly_canonical(work_).string() + "'");
    }
    std::string work(const std::string& name) const { return path("work/" + name); }
    Json info(const std::string& name)
    {
        const Result result = pcmlab("info --json " + work(name));
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }

    const fs::path work_ = folder_ / "work";
    const std::string asan_ = "verify_asan_link_order=0:detect_leaks=0";
};

TEST_F(NoLocks, ANewTreeIsBuiltAndSaysSo)
{
    const Result built = without_locks("build --json -m 64M " + work("a.las") + " -o " + work("b.pct"));
    ASSERT_EQ(built.code, 0) << built.err;
    EXPECT_NE(Json::parse(built.out)["notes"].dump().find("no locks"), std::string::npos) << built.out;
    EXPECT_EQ(info("b.pct")["points"], 3000);
    const Result with = pcmlab("build --json -m 64M " + work("a.las") + " -o " + work("c.pct"));
    EXPECT_EQ(with.out.find("no locks"), std::string::npos) << with.out;
    EXPECT_EQ(without_locks("build -m 64M --overwrite " + work("a.las") + " -o " + work("b.pct")).code, 0);
    EXPECT_EQ(without_locks("voxel -s 1 -m 64M " + work("a.las") + " -o " + work("v.pct")).code, 0);
    EXPECT_EQ(without_locks("convert " + work("a.pct") + " " + work("a.xyz")).code, 0);
    for (const auto& entry : fs::directory_iterator(work_))
        EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
}

// A running build cannot be distinguished from an interrupted one.
TEST_F(NoLocks, TheRemainsOfABuildAreNotTakenOver)
{
    fs::create_directories(work_ / "b.pct.part" / "tree");
    std::ofstream(work_ / "b.pct.part" / "building");
    const std::string build = "build -m 64M " + work("a.las") + " -o " + work("b.pct");
    const std::string copy = "outliers " + work("a.pct") + " -o " + work("b.pct");
    for (const std::string& command : {build, copy}) {
        const Result refused = without_locks(command);
        EXPECT_EQ(refused.code, 1);
        for (const char* words : {"b.pct.part", "no locks", "remove the folder"})
            EXPECT_NE(refused.err.find(words), std::string::npos) << refused.err;
        EXPECT_TRUE(fs::exists(work_ / "b.pct.part" / "building"));
    }
    fs::remove_all(work_ / "b.pct.part");
    EXPECT_EQ(without_locks(build).code, 0);
}

TEST_F(NoLocks, ACopyIsChangedAndATreeInPlaceIsNot)
{
    const Result copy = without_locks("outliers -a 1 " + work("a.pct") + " -o " + work("o.pct"));
    EXPECT_EQ(copy.code, 0) << copy.err;
    EXPECT_LT(info("o.pct")["points"], 3000);
    const std::string append = "append " + work("a.pct") + " " + work("a.las");
    for (const std::string& command : {"outliers --in-place -a 1 " + work("a.pct"), append}) {
        const Result refused = without_locks(command);
        EXPECT_EQ(refused.code, 1);
        for (const char* words : {"not changed in place", "no locks", "write a copy"})
            EXPECT_NE(refused.err.find(words), std::string::npos) << refused.err;
        EXPECT_EQ(refused.err.find("another"), refused.err.find("another file system")) << refused.err;
        EXPECT_EQ(info("a.pct")["points"], 3000);
    }
    EXPECT_EQ(pcmlab(append).code, 0);
}

// Where files without names cannot be made either.
TEST_F(NoLocks, ScratchFilesHaveNamesOfTheirOwn)
{
    fs::create_directories(work_ / "tmp" / "update.tmp");
    std::ofstream(work_ / "tmp" / "update.tmp" / "values") << "mine";
    const Result counted = without_locks("outliers --count --json -a 1 " + work("a.pct"), "flock,tmpfile");
    EXPECT_EQ(counted.code, 0) << counted.err;
    EXPECT_EQ(Json::parse(counted.out)["outliers"],
              Json::parse(pcmlab("outliers --count --json -a 1 " + work("a.pct")).out)["outliers"]);
    EXPECT_EQ(fs::file_size(work_ / "tmp" / "update.tmp" / "values"), 4u);
    EXPECT_EQ(std::distance(fs::directory_iterator(work_ / "tmp"), fs::directory_iterator()), 1);
}

}  // namespace
