// Paths, names and coordinate systems that are not UTF-8: finished work is reported, in JSON that every reader takes.
#include "tests/cli/command.h"
#include "tests/io/crs_records.h"
#include "tests/sanitizers.h"

#include <set>

namespace pcm::test {
namespace {

namespace fs = std::filesystem;

const std::string replaced = "\xEF\xBF\xBD";  // U+FFFD

struct Call {
    std::string command, arguments;
    bool named = true;  // the report names a path
};

// The names below are those of the folder that the shell is in.
const std::vector<Call>& calls()
{
    static const std::vector<Call> all = {
        {"generate", "-n 20000 --origin 0 0 0 $D/scene.las"},
        {"build", "$D/scene.las -o $D/t.pct"},
        {"build", "$D/scene.las -o $D/u.pct"},
        {"convert", "$D/t.pct $D/c.ply"},
        {"info", "$D/t.pct"},
        {"info", "$D/scene.las"},
        {"verify", "$D/t.pct"},
        {"append", "$D/u.pct $D/scene.las"},
        {"delete", "$D/u.pct --box -1000 -1000 -1000 0 1000 1000"},
        {"compact", "$D/u.pct -o $D/compacted.pct"},
        {"repair", "$D/u.pct"},
        {"query", "$D/t.pct --nearest 1 2 3", false},
        {"query", "$D/t.pct", false},
        {"pick", "$D/t.pct --ray 0 0 1000 0 0 -1", false},
        {"select", "$D/t.pct --where 'z > 0' --extract $D/part.las"},
        {"set", "$D/t.pct intensity=7"},
        {"radii", "$D/t.pct -o $D/r.pct"},
        {"normals", "$D/t.pct -o $D/n.pct"},
        {"outliers", "$D/t.pct -o $D/o.pct"},
        {"transform", "$D/t.pct $D/moved.pct --translate 1 2 3"},
        {"align", "$D/t.pct $D/t.pct --pair 0 0 0 1 0 0 --pair 9 0 0 10 0 0 --pair 0 9 0 1 9 0 -o $D/aligned.pct"},
        {"merge", "$D/merged.pct $D/t.pct $D/moved.pct"},
        {"voxel", "$D/t.pct --size 0.5 -o $D/v.pct"},
        {"subsample", "$D/t.pct --points 500 -o $D/s.pct"},
        {"run", "$D/t.pct --outliers 8 --normals 8 -o $D/chain.laz"},
        {"detect", "$D/t.pct --shape plane --out $D/found.json"},
        {"fit", "$D/t.pct --at $PLACE --shape plane --add $D/list.json --name p$D"},
        {"measure", "distance --points 0 0 0 1 1 1 --name m$D -o $D/measures.json"},
        {"measure", "--list $D/measures.json"},
        {"profile", "$D/t.pct --line -50 0 50 0 --width 1 -o $D/p.csv"},
        {"volume", "$D/t.pct --reference 0 --side 2"},
        {"primitives", "$D/list.json -o $D/list.csv"},
#ifdef PCM_HAVE_RENDER
        {"render", "$D/t.pct --size 32x32 -o $D/picture.png"},
#endif
    };
    return all;
}

class Encoding : public CommandTest {
protected:
    Encoding() { fs::create_directory(folder_ / "\xE9t\xE9"); }
    // In the shell's words, D is a folder whose name is Latin-1, and PLACE a point of the tree in it.
    Result in_folder(const std::string& arguments)
    {
        return pcmlab(arguments,
                      "cd '" + folder_.path().string() + "'; D=$(printf '\\351t\\351'); PLACE='" + place_ + "';");
    }
    std::string place_;
};

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(Encoding, PCM_NOT_UNDER_ADDRESS(EveryCommandReportsPathsThatAreNotUtf8))
{
    std::set<std::string> tried;
    for (const Call& call : calls()) {
        SCOPED_TRACE(call.command + " " + call.arguments);
        const Result result = in_folder(call.command + " --json " + call.arguments);
        ASSERT_EQ(result.code, 0) << result.err;
        ASSERT_TRUE(Json::accept(result.out)) << result.out;
        if (call.named) EXPECT_NE(result.out.find(replaced), std::string::npos) << result.out;
        tried.insert(call.command);
        if (call.command != "build") continue;
        const Json nearest = Json::parse(in_folder("query --json $D/t.pct --nearest 0 0 0").out);
        place_.clear();
        for (const Json& x : nearest["neighbours"][0]["position"]) place_ += (place_.empty() ? "" : " ") + x.dump();
    }
    std::set<std::string> listed;
    std::istringstream lines(pcmlab("help").out);
    for (std::string line; std::getline(lines, line);)
        if (line.size() > 3 && line.compare(0, 2, "  ") == 0 && std::islower(line[2]))
            listed.insert(line.substr(2, line.find(' ', 2) - 2));
    ASSERT_GT(listed.size(), 20u);
#ifndef PCM_HAVE_RENDER
    listed.erase("render");
#endif
    EXPECT_EQ(tried, listed) << "commands that no call above tries";
}

// An update that was done three times because its report failed three times would have four times the points.
TEST_F(Encoding, AnAppendIsDoneOnceAndReportedOnce)
{
    ASSERT_EQ(in_folder("generate -n 3000 --no-truth $D/a.las").code, 0);
    ASSERT_EQ(in_folder("build $D/a.las -o $D/a.pct").code, 0);
    const Result result = in_folder("append --json $D/a.pct $D/a.las || exit 1; " + std::string(paths::command) +
                                    " info --json $D/a.pct");
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("\"points\": 6000"), std::string::npos) << result.out;
}

TEST_F(Encoding, InfoOfASystemInLatin1)
{
    std::string wkt = wkt_utm(32);
    wkt.insert(wkt.find('"') + 1, "M\xE9ridien ");
    std::mt19937_64 random(9);
    LasFile file = random_las(random, 4, 6, 50);
    file.vlrs = {{"LASF_Projection", 2112, wkt}};
    file.encoding = 1 | 16;
    write_file(folder_ / "a.las", file.bytes());
    ASSERT_EQ(pcmlab("build -q " + path("a.las")).code, 0);
    for (const char* name : {"a.las", "a.pct"}) {
        const Result result = pcmlab("info --json " + path(name));
        ASSERT_EQ(result.code, 0) << result.err;
        const std::string text = Json::parse(result.out)["crs"]["wkt"];
        EXPECT_NE(text.find("M" + replaced + "ridien "), std::string::npos) << text;
    }
}

// Lists that are written are read again.
TEST_F(Encoding, ListsKeepNamesThatAreNotUtf8)
{
    ASSERT_EQ(in_folder("measure point --points 1 2 3 --name n$D -o list.json").code, 0);
    const Result result = in_folder("measure --json --list list.json");
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(Json::parse(result.out)["measures"][0]["name"], "n" + replaced + "t" + replaced);
}

}  // namespace
}  // namespace pcm::test
