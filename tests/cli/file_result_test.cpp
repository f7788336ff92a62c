// Results whose name is that of a file: written as the file, or refused before any work; never a folder of that name.
#include "tests/cli/command.h"
#include "tests/sanitizers.h"

#include <cmath>
#include <sstream>

namespace pcm::test {
namespace {

namespace fs = std::filesystem;

class FileResult : public CommandTest {
protected:
    FileResult()
    {
        EXPECT_EQ(pcmlab("generate -q -n 6000 --no-truth --origin 0 0 0 " + path("scene.las")).code, 0);
        EXPECT_EQ(pcmlab("build -q " + path("scene.las") + " -o " + path("t.pct")).code, 0);
    }
    std::uint64_t points_in(const std::string& name)
    {
        const Result result = pcmlab("info --json --scan " + path(name));
        EXPECT_EQ(result.code, 0) << result.err;
        if (result.code != 0) return 0;
        const Json json = Json::parse(result.out);
        return (json["scanned"].is_object() ? json["scanned"]["points"] : json["points"]).get<std::uint64_t>();
    }
};

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(FileResult, PCM_NOT_UNDER_ADDRESS(IsWrittenInTheFormatOfItsName))
{
    const std::string pairs = " --pair 0 0 0 1 0 0 --pair 9 0 0 10 0 0 --pair 0 9 0 1 9 0 --pair 0 0 5 1 0 5 -o ";
    const std::pair<std::string, std::string> commands[] = {
        {"voxel " + path("t.pct") + " --size 0.5 -o ", ""},
        {"voxel " + path("scene.las") + " --size 0.5 -o ", ""},
        {"subsample " + path("t.pct") + " -n 1234 -o ", ""},
        {"subsample " + path("scene.las") + " -s 0.5 -o ", ""},
        {"subsample " + path("t.pct") + " -n 1234 --nearest-level -o ", ""},
        {"transform " + path("t.pct") + " ", " --translate 1 2 3"},
        {"transform " + path("t.pct") + " ", " --rotate 0 0 1 30 --scale 2"},
        {"align " + path("t.pct") + " " + path("t.pct") + pairs, ""}};
    for (const std::string name : {"out.LAZ", "out.xyz"})
        for (const auto& [before, after] : commands) {
            SCOPED_TRACE(before + name + after);
            fs::remove(folder_ / name);
            const Result made = pcmlab(before + path(name) + after + " --json");
            ASSERT_EQ(made.code, 0) << made.err;
            ASSERT_TRUE(fs::is_regular_file(folder_ / name));
            const Json report = Json::parse(made.out);
            EXPECT_EQ(points_in(name), report["points"]);
            EXPECT_EQ(report["bytes"], fs::file_size(folder_ / name));
            const Result again = pcmlab(before + path(name) + after);
            EXPECT_EQ(again.code, 1);
            EXPECT_NE(again.err.find("exists already"), std::string::npos) << again.err;
            EXPECT_EQ(pcmlab(before + path(name) + after + " --overwrite").code, 0);
        }
    // The same points as those of the tree.
    ASSERT_EQ(pcmlab("voxel -q " + path("t.pct") + " --size 0.5 -o " + path("v.pct")).code, 0);
    ASSERT_EQ(pcmlab("voxel -q " + path("t.pct") + " --size 0.5 -o " + path("v.las")).code, 0);
    EXPECT_EQ(points_in("v.las"), points_in("v.pct"));
    std::size_t entries = 0;
    for (const auto& entry : fs::directory_iterator(folder_.path())) entries += entry.is_directory();
    EXPECT_EQ(entries, 2u) << "t.pct and v.pct";
}

// A file of what changes a tree, and from files: the same as the commands one by one, and nothing else is left.
TEST_F(FileResult, OfOperationsThatChangeATree)
{
    const auto bytes_of = [&](const std::string& name) {
        std::ifstream file(folder_ / name, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    const auto names = [&] {
        std::set<std::string> found;
        for (const auto& entry : fs::directory_iterator(folder_.path())) found.insert(entry.path().filename());
        return found;
    };
    const std::pair<std::string, std::string> commands[] = {{"outliers ", " -k 8 -a 2"},
                                                            {"normals ", " -k 8"},
                                                            {"radii ", " -k 8"},
                                                            {"delete ", " --where 'z>1'"},
                                                            {"transform --translate 1 2 3 ", ""}};
    for (const auto& [before, options] : commands) {
        SCOPED_TRACE(before);
        const std::string after = options + (options.empty() ? " " : " -o ");  // transform has it by its place
        ASSERT_EQ(pcmlab(before + path("t.pct") + after + path("by-hand.pct")).code, 0);
        ASSERT_EQ(pcmlab("convert -q " + path("by-hand.pct") + " " + path("by-hand.las")).code, 0);
        const std::set<std::string> present = names();
        for (const std::string input : {"t.pct", "scene.las"}) {
            const Result made = pcmlab(before + path(input) + after + path("out.las") + " --json");
            ASSERT_EQ(made.code, 0) << made.err;
            const Json json = Json::parse(made.out);
            EXPECT_EQ(json["input"], Json{(folder_ / input).string()});
            EXPECT_EQ(json["output"], (folder_ / "out.las").string());
            EXPECT_EQ(json["points"], points_in("out.las"));
            EXPECT_EQ(json["points_in"], points_in("scene.las"));
            EXPECT_TRUE(bytes_of("out.las") == bytes_of("by-hand.las")) << input;
            EXPECT_EQ(pcmlab(before + path(input) + after + path("out.las")).code, 1) << "it exists";
            EXPECT_EQ(pcmlab(before + path(input) + after + path("out.las") + " --overwrite").code, 0);
            fs::remove(folder_ / "out.las");
            EXPECT_EQ(names(), present);
        }
        ASSERT_EQ(pcmlab(before + path("scene.las") + after + path("tree.pct")).code, 0);
        EXPECT_EQ(points_in("tree.pct"), points_in("by-hand.pct"));
        EXPECT_EQ(pcmlab("verify " + path("tree.pct")).code, 0);
        fs::remove_all(folder_ / "tree.pct");
        fs::remove_all(folder_ / "by-hand.pct");
        fs::remove(folder_ / "by-hand.las");
    }
}

TEST_F(FileResult, OfFilesIsRefusedWhereItCannotBe)
{
    const std::string file = path("scene.las"), to = " -o " + path("out.las");
    const std::tuple<std::string, int, std::string> mistakes[] = {
        {"outliers " + file, 2, "no output is given: " + (folder_ / "scene.las").string() + " is not a tree"},
        {"outliers " + file + " --in-place", 2, "no output is given"},
        {"outliers " + file + " --in-place" + to, 2, "give either --output or --in-place, not both"},
        {"outliers " + path("t.pct") + " --in-place" + to, 2, "give either --output or --in-place, not both"},
        {"outliers " + file + " --count" + to, 2, "this only counts"},
        {"outliers " + file + " --method radius" + to, 2, "the method radius needs --radius"},
        {"outliers " + path("none.las") + to, 1, "no such file or folder"},
        {"outliers " + file + " -o " + file + " --overwrite", 1, "the output is one of the inputs"},
        {"delete " + file + " --where 'z>1'", 2, "no output is given"},
        {"delete " + file + " --where 'none>1'" + to, 1, "no attribute 'none'"},
        {"set " + file + " classification=3", 1, "files are not changed"},
        {"radii " + file + " --device gpu" + to, 2, "is computed on the processor"}};
    for (const auto& [command, code, message] : mistakes) {
        const Result result = pcmlab(command);
        EXPECT_EQ(result.code, code) << command;
        EXPECT_NE(result.err.find(message), std::string::npos) << command << "\n" << result.err;
        EXPECT_EQ(result.err.find(".part"), std::string::npos) << result.err;
        EXPECT_FALSE(fs::exists(folder_ / "out.las")) << command;
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 3)
        << "scene.las, t.pct and what is printed";
}

TEST_F(FileResult, IsRefusedWhereOnlyATreeIsMade)
{
    const std::string tree = path("t.pct"), to = " -o " + path("clean.laz");
    for (const std::string& command :
         {"build " + path("scene.las") + to, "select " + tree + " --where 'z>0' --classify 7" + to,
          "select " + tree + " --where 'z>0' --delete" + to,
          "select " + tree + " --where 'z>0' --save-attribute mine" + to,
          "detect " + tree + " --shape plane --label shape" + to, "compact " + tree + to,
          "merge " + path("clean.laz") + " " + tree + " " + tree}) {
        const Result result = pcmlab(command);
        EXPECT_EQ(result.code, 1) << command << "\n" << result.out;
        EXPECT_NE(result.err.find("this is the name of a file (.laz), and a tree is a folder"), std::string::npos)
            << command << "\n"
            << result.err;
        EXPECT_NE(result.err.find("clean.pct"), std::string::npos) << result.err;
        EXPECT_FALSE(fs::exists(folder_ / "clean.laz")) << command;
    }
    const Result odd = pcmlab("voxel " + tree + " --size 1 -o " + path("a.e57"));
    EXPECT_EQ(odd.code, 1) << odd.out;
    EXPECT_FALSE(fs::exists(folder_ / "a.e57"));
    // A tree that an earlier version gave such a name is a tree still.
    fs::rename(folder_ / "t.pct", folder_ / "t.laz");
    EXPECT_EQ(pcmlab("compact " + path("t.laz")).code, 0);
    EXPECT_EQ(pcmlab("verify " + path("t.laz")).code, 0);
}

// Half of a level's spacing lies between that level and all points.
TEST_F(FileResult, ASpacingIsExactUnlessALevelIsAskedFor)
{
    const Json levels = Json::parse(pcmlab("info --json " + path("t.pct")).out)["level"];
    const double spacing = levels[levels.size() - 2]["spacing"].get<double>() / 1.9;
    const auto subsample = [&](const std::string& options) {
        const Result made = pcmlab("subsample --json --overwrite " + path("t.pct") + " -o " + path("thin.xyz") +
                                   " -s " + std::to_string(spacing) + options);
        EXPECT_EQ(made.code, 0) << made.err;
        return Json::parse(made.out)["points"].get<std::size_t>();
    };
    const std::size_t all = subsample(" --nearest-level");
    for (const std::string options : {"", " --exact"}) {
        const std::size_t points = subsample(options);
        EXPECT_LT(points, all);
        std::ifstream file(folder_ / "thin.xyz");
        std::vector<std::array<double, 3>> places;
        for (std::string line; std::getline(file, line);) {
            if (line[0] == '#') continue;  // names of the columns
            std::istringstream numbers(line);
            std::array<double, 3> p{};
            numbers >> p[0] >> p[1] >> p[2];
            places.push_back(p);
        }
        ASSERT_EQ(places.size(), points);
        double least = 1e9;
        for (std::size_t i = 0; i < places.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                least = std::min(least, std::hypot(places[i][0] - places[j][0], places[i][1] - places[j][1],
                                                   places[i][2] - places[j][2]));
        EXPECT_GE(least, spacing * (1 - 1e-6));
    }
    EXPECT_EQ(pcmlab("subsample --exact --nearest-level -s 1 " + path("t.pct") + " -o " + path("b.pct")).code, 2);
}

}  // namespace
}  // namespace pcm::test
