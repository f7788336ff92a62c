// --skip-bad-lines and --skip-bad-files, and folders of folders: what is left out is counted, in the text and in JSON.

#include "tests/cli/command.h"

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class BadInput : public CommandTest {
protected:
    void SetUp() override
    {
        fs::create_directories(folder_ / "tiles" / "inner");
        write("tiles/a.xyz", "1 2 3\n4 5 6\n");
        write("tiles/b.las", "this is no LAS file");
        write("tiles/inner/c.csv",
              "N,E,Z\n10,20,3\n11,oops,4\n12,22,5\n13,23,6\n14,24,7\n15,25,8\n16,26,9\n17,27,1\n"
              "18,28,2\n19,29,3\n20,30,4\n21,31,5\n");
        write("tiles/._a.las", "x");
        write("tiles/notes.md", "x");
    }
    void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
};

constexpr const char* skip_both = " --skip-bad-lines --skip-bad-files ";

void expect_counts(const Json& json, int lines, int files)
{
    EXPECT_EQ(json["lines_skipped"], lines) << json;
    EXPECT_EQ(json["files_skipped"], files) << json;
    EXPECT_EQ(json["files_incomplete"], 0) << json;
}

TEST_F(BadInput, IsRefusedUnlessItIsToBeSkipped)
{
    for (const std::string command : {"build ", "convert ", "info --scan "}) {
        const std::string out = command == "info --scan " ? ""
                                : command == "build "     ? " -o " + path("o.pct")
                                                          : path("o.xyz");
        for (const char* option : {" ", " --skip-bad-lines "}) {
            const Result result = pcmlab(command + path("tiles") + option + out);
            EXPECT_EQ(result.code, 1) << command << option;
            EXPECT_NE(result.err.find("b.las"), std::string::npos) << result.err;
        }
        EXPECT_FALSE(fs::exists(folder_ / "o.pct"));
        EXPECT_FALSE(fs::exists(folder_ / "o.xyz"));
    }
}

TEST_F(BadInput, SkippedLinesAndFilesAreCounted)
{
    const std::string tiles = path("tiles") + skip_both;
    const auto expect_notes = [](const std::string& text) {
        for (const char* part :
             {"1 input cannot be read and is left out: b.las", "c.csv: 1 bad line was skipped, the first",
              "line 3: found 'oops'", "1 hidden file or folder (._a.las)", "1 file of another format (notes.md)",
              "N→y, E→x"})
            EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
    };
    const Result info = pcmlab("info --json --scan " + tiles);
    ASSERT_EQ(info.code, 0) << info.err;
    expect_counts(Json::parse(info.out), 1, 1);
    EXPECT_EQ(Json::parse(info.out)["scanned"]["points"], 13);
    EXPECT_EQ(Json::parse(info.out)["files"].size(), 2u);
    expect_notes(pcmlab("info --scan " + tiles).out);

    const Result built = pcmlab("build --json " + tiles + " -o " + path("o.pct"));
    ASSERT_EQ(built.code, 0) << built.err;
    expect_counts(Json::parse(built.out), 1, 1);
    EXPECT_EQ(Json::parse(built.out)["points"], 13);
    EXPECT_EQ(Json::parse(pcmlab("info --json " + path("o.pct")).out)["sources"], Json({"a.xyz", "c.csv"}));
    expect_notes(pcmlab("build " + tiles + " --overwrite -o " + path("o.pct")).out);

    for (const char* name : {"o.las", "o.xyz", "o.ply", "o2.pct"}) {
        const Result converted = pcmlab("convert --json " + tiles + path(name));
        ASSERT_EQ(converted.code, 0) << converted.err;
        expect_counts(Json::parse(converted.out), 1, 1);
        EXPECT_EQ(Json::parse(pcmlab("info --json --scan " + path(name)).out)["points"], 13) << name;
    }
    expect_notes(pcmlab("convert " + tiles + path("p.xyz")).out);

    const Result appended = pcmlab("append --json " + path("o.pct") + " " + tiles);
    ASSERT_EQ(appended.code, 0) << appended.err;
    expect_counts(Json::parse(appended.out), 1, 1);
    EXPECT_EQ(Json::parse(appended.out)["points_added"], 13);
    EXPECT_EQ(Json::parse(pcmlab("info --json " + path("o.pct")).out)["sources"],
              Json({"a.xyz", "c.csv", "a.xyz", "c.csv"}));
}

// A file that opens and fails later goes in as far as it can be read, with a count, or not at all.
TEST_F(BadInput, AFileThatFailsLater)
{
    write("late.pts", "100\n1 2 3\n4 5 6\n");
    // One with a bad line too, unless lines are skipped.
    const Result line = pcmlab("info --json --scan --skip-bad-files " + path("tiles"));
    ASSERT_EQ(line.code, 0) << line.err;
    EXPECT_EQ(Json::parse(line.out)["files_incomplete"], 1) << line.out;
    EXPECT_NE(line.out.find("c.csv: line 3: found 'oops'"), std::string::npos) << line.out;
    const std::string inputs = path("late.pts") + " " + path("tiles/a.xyz");
    EXPECT_EQ(pcmlab("convert " + inputs + " " + path("o.las")).code, 1);
    EXPECT_FALSE(fs::exists(folder_ / "o.las"));
    for (const char* name : {"o.las", "o.pct", "o.ply"}) {
        const Result result = pcmlab("convert --json --skip-bad-files " + inputs + " " + path(name));
        ASSERT_EQ(result.code, 0) << result.err;
        const Json json = Json::parse(result.out);
        EXPECT_EQ(json["files_incomplete"], 1) << json;
        EXPECT_EQ(json["files_skipped"], 0) << json;
        EXPECT_NE(result.out.find("late.pts could be read in part"), std::string::npos) << result.out;
        EXPECT_EQ(json["points"], Json::parse(pcmlab("info --json --scan " + path(name)).out)["points"]);
    }
}

TEST_F(BadInput, MissingInputsAndNothingAtAll)
{
    const Result missing =
        pcmlab("info --json --scan --skip-bad-files " + path("tiles/a.xyz") + " " + path("none.las"));
    ASSERT_EQ(missing.code, 0) << missing.err;
    expect_counts(Json::parse(missing.out), 0, 1);
    EXPECT_EQ(pcmlab("info --skip-bad-files " + path("none.las")).code, 1);
    EXPECT_EQ(pcmlab("convert --skip-bad-files " + path("none.las") + " " + path("o.xyz")).code, 1);
    EXPECT_EQ(pcmlab("info --skip-bad-files --columns \"x y\" " + path("tiles/a.xyz")).code, 1);
}

}  // namespace
