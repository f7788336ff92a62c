// Names of outputs as a user types them: each command refuses what would lose something, and says what to do.

#include "tests/cli/command.h"
#include "tests/sanitizers.h"

#include <sys/stat.h>

#include <map>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class Names : public CommandTest {
protected:
    Names()
    {
        write_las(folder_ / "in.las", records(Shape::surface, 5000, 1), {});
        EXPECT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las") + " -o " + path("t.pct")).code, 0);
        EXPECT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las") + " -o " + path("u.pct")).code, 0);
    }
    std::map<std::string, std::string> contents(const std::string& tree)
    {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::directory_iterator(folder_ / tree)) {
            std::ifstream file(entry.path(), std::ios::binary);
            files[entry.path().filename()] = {std::istreambuf_iterator<char>(file), {}};
        }
        return files;
    }
    void expect_refused(const std::string& arguments, const std::string& reason)
    {
        const Result result = pcmlab(arguments);
        EXPECT_EQ(result.code, 1) << arguments << "\n" << result.out;
        EXPECT_NE(result.err.find(reason), std::string::npos) << arguments << ": " << result.err;
    }
};

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(Names, PCM_NOT_UNDER_ADDRESS(NoCommandWritesIntoATree))
{
    const auto before = contents("u.pct");
    for (const std::string& name : {"index.pct", "chunks-000.bpc", "about.pct", "new.las", "new.pct"}) {
        const std::string to = path("u.pct/" + name), reason = "of the point cloud tree";
        for (const std::string& overwrite : {"", " --overwrite"}) {
            expect_refused("build " + path("in.las") + " -o " + to + overwrite, reason);
            expect_refused("convert " + path("in.las") + " " + to + overwrite,
                           name == "about.pct" ? "point cloud tree" : reason);
            expect_refused("transform " + path("t.pct") + " " + to + " --translate 1 0 0" + overwrite, reason);
            expect_refused("compact " + path("t.pct") + " -o " + to + overwrite, reason);
            expect_refused("generate -n 100 " + to + overwrite, reason);
        }
    }
    expect_refused("build " + path("in.las") + " -o " + path("u.pct/index.pct"), "did you mean the tree?");
    EXPECT_TRUE(contents("u.pct") == before);
}

TEST_F(Names, GenerateAsksBeforeItReplaces)
{
    std::ofstream(folder_ / "mine.ply") << "mine";
    expect_refused("generate -n 100 " + path("mine.ply"), "mine.ply: the output exists already");
    EXPECT_EQ(fs::file_size(folder_ / "mine.ply"), 4u);
    EXPECT_EQ(pcmlab("generate -n 100 --overwrite " + path("mine.ply")).code, 0);
    const Result info = pcmlab("info --json " + path("mine.ply"));
    EXPECT_NE(info.out.find("PLY"), std::string::npos) << info.out;
    expect_refused("generate -n 100 " + path("x.stl"), "writable are");
}

// Stand-ins in the test's own folder: a command that fails this test must not replace the system's devices.
TEST_F(Names, StreamsAreNoOutputs)
{
    fs::create_symlink("/proc/self/fd/1", folder_ / "stdout.las");
    ASSERT_EQ(mkfifo((folder_ / "fifo.las").c_str(), 0666), 0);
    for (const std::string command : {"convert " + path("in.las") + " ", std::string("generate -n 100 --no-truth ")})
        for (const std::string overwrite : {"", " --overwrite"}) {
            expect_refused(command + path("stdout.las") + overwrite, "open stream");
            expect_refused(command + path("fifo.las") + overwrite, "this is a FIFO");
        }
    EXPECT_TRUE(fs::is_symlink(folder_ / "stdout.las"));
    EXPECT_TRUE(fs::is_fifo(folder_ / "fifo.las"));
}

TEST_F(Names, AFileOfATreeIsTheTree)
{
    for (const char* name : {"t.pct/chunks-000.bpc", "t.pct/about.pct"}) {
        for (const char* command : {"info --json ", "verify --json ", "query --json "}) {
            const Result result = pcmlab(command + path(name));
            ASSERT_EQ(result.code, 0) << result.err;
            EXPECT_EQ(Json::parse(result.out)["points"], 5000) << command;
        }
        const Result converted = pcmlab("convert --overwrite " + path(name) + " " + path("out.las"));
        EXPECT_EQ(converted.code, 0) << converted.err;
        EXPECT_NE(converted.out.find("note: "), std::string::npos) << converted.out;
        EXPECT_NE(converted.out.find("5,000 points"), std::string::npos) << converted.out;
    }
    expect_refused("append " + path("t.pct") + " " + path("t.pct/chunks-000.bpc"), "among the inputs");
    expect_refused("build " + path("t.pct/chunks-000.bpc") + " -o " + path("n.pct"), "only a part of the cloud");
}

#ifdef PCM_HAVE_RENDER
TEST_F(Names, NoPictureIsPutIntoATree)
{
    const auto before = contents("t.pct");
    expect_refused("render --size 32x32 " + path("t.pct") + " -o " + path("t.pct/picture.png"), "inside the folder");
    expect_refused("render --size 32x32 " + path("t.pct") + " -o " + path("t.pct/index.png") + " --overwrite",
                   "inside the folder");
    EXPECT_TRUE(contents("t.pct") == before);
}
#endif

}  // namespace
