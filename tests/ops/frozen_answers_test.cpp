// What operations answer and write of two small clouds, as it is kept in the files of frozen/: a number that changes
// fails here. Where the change is wanted, run this test with PCM_FREEZE=1 in the environment, look
// at what `git diff` shows of the files, and commit them with it.
#include "tests/ops/frozen_answers.h"
#include "tests/frozen_files.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include "pcm/fit/random_numbers.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>

namespace {

using namespace pcm::ops;
namespace fs = std::filesystem;

// A line of frozen_calls.json. An argument's value is true, a word, or a list of words, in which @ is the folder of the
// test, and @out/copy.pct a copy of its site.pct.
struct FrozenCall {
    std::string name, operation;
    Json values = Json::object();
};
void PrintTo(const FrozenCall& call, std::ostream* out) { *out << call.name; }

std::string text_of(const fs::path& file)
{
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

std::vector<FrozenCall> frozen_calls()
{
    std::vector<FrozenCall> calls;
    const Json listed = Json::parse(text_of(PCM_FROZEN_CALLS));
    for (const auto& [name, call] : listed.items()) calls.push_back({name, call[0].get<std::string>(), call[1]});
    return calls;
}

// What it answers to programs, and to people.
Json run(const std::string& name, const Json& values)
{
    const Row* const row = find_operation(name);
    if (!row) throw std::logic_error("there is no operation " + name);
    const auto operation = row->make();
    for (const auto& [key, value] : values.items()) {
        Argument* const argument = operation->arguments().find(key);
        if (!argument) throw std::logic_error(name + " has no argument " + key);
        if (value.is_boolean())
            argument->set(value.get<bool>());
        else if (value.is_string())
            argument->set(std::vector<std::string>{value}, key);
        else
            argument->set(value.get<std::vector<std::string>>(), key);
    }
    const Result result = operation->run({});
    Json answer = json_of(row->name, result);
    answer["makes"] = static_cast<int>(result.makes);
    answer["good"] = result.good;
    answer["lines"] = all_lines(result);
    return answer;
}

// Points of a cone, a ring, a ball, a wall and some that belong to nothing, in floating point, as text.
void write_shapes(const fs::path& file)
{
    pcm::SampleNumbers random(5);
    const auto unit = [&] { return static_cast<double>(random.below(1u << 30)) / (1u << 30); };
    std::ofstream out(file);
    out.precision(9);
    for (int i = 0; i < 15000; ++i) {
        const double a = 2 * M_PI * unit(), b = 2 * M_PI * unit(), s = unit(), noise = 0.002 * (unit() + unit() - 1);
        const double ring = 0.3 + noise, cone = (0.5 + 2 * s) * 0.4 + noise;
        double x = 10 * unit(), y = 10 * unit(), z = 3 * unit();
        if (i % 5 == 0) x = 2 + cone * std::cos(a), y = 2 + cone * std::sin(a), z = 2.5 - 2 * s;
        if (i % 5 == 1)
            x = 7 + (1 + ring * std::cos(b)) * std::cos(a), y = 7 + (1 + ring * std::cos(b)) * std::sin(a),
            z = 1 + ring * std::sin(b);
        if (i % 5 == 2)
            x = 3 + (0.8 + noise) * std::cos(a) * std::cos(b / 4),
            y = 7 + (0.8 + noise) * std::sin(a) * std::cos(b / 4), z = 1 + (0.8 + noise) * std::sin(b / 4);
        if (i % 5 == 3) x = 6 + 3 * s, y = 1 + noise, z = 2 * unit();
        out << x << ' ' << y << ' ' << z << ' ' << i % 7 << '\n';
    }
}

class FrozenAnswers : public testing::TestWithParam<FrozenCall> {
protected:
    static void SetUpTestSuite()
    {
        folder_ = std::make_unique<pcm::test::TemporaryFolder>();
        run("generate", {{"output", here("site.laz")}, {"points", "30000"}});
        run("build", {{"input", here("site.laz")}, {"output", here("site.pct")}, {"chunk_points", "4000"}});
        write_shapes(folder_->path() / "shapes.xyz");
        run("build", {{"input", here("shapes.xyz")},
                      {"output", here("shapes.pct")},
                      {"columns", "x,y,z,kind"},
                      {"normals", "12"}});
    }
    static void TearDownTestSuite() { folder_.reset(); }
    static std::string here(const std::string& name) { return (*folder_ / name).string(); }

    // What a call wrote: a cloud's statistics, a text's sums.
    static Json written(const fs::path& folder)
    {
        static const std::set<std::string> clouds{".pct", ".las", ".laz", ".ply", ".pcd",
                                                  ".xyz", ".e57", ".pts", ".bpc"};
        Json files = Json::object();
        for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
            const fs::path& path = entry.path();
            Json& file = files[path.filename().string()];
            if (clouds.count(path.extension().string()))
                file = run("info", {{"input", path.string()}, {"statistics", "on"}});
            else if (path.extension() == ".json")
                file = Json::parse(text_of(path));
            else
                file = pcm::test::frozen_text(text_of(path), folder_->path());
        }
        return files;
    }

    static std::unique_ptr<pcm::test::TemporaryFolder> folder_;
};
std::unique_ptr<pcm::test::TemporaryFolder> FrozenAnswers::folder_;

TEST_P(FrozenAnswers, PCM_NOT_UNDER_SANITIZERS(AreThoseOfBefore))
{
    const FrozenCall& call = GetParam();
    const fs::path out = *folder_ / "out";
    fs::remove_all(out);
    fs::create_directory(out);
    std::string values = call.values.dump();
    for (std::size_t at = 0; (at = values.find('@', at)) != std::string::npos;) values.replace(at, 1, here(""));
    if (call.operation == "set") fs::copy(*folder_ / "site.pct", out / "copy.pct", fs::copy_options::recursive);
    Json now;
    try {
        now["answer"] = run(call.operation, Json::parse(values));
    } catch (const std::exception& error) {
        now = json_of_error(error);
    }
    now["written"] = written(out);
    now = pcm::test::frozen(now, folder_->path());
    const fs::path file = fs::path(PCM_FROZEN_ANSWERS) / (call.name + ".json");
    if (pcm::test::is_freezing()) {
        std::ofstream(file) << pcm::test::kept_text(now) << "\n";
        GTEST_SKIP() << "written: " << file;
    }
    ASSERT_TRUE(fs::exists(file)) << "run this test once with PCM_FREEZE=1";
    EXPECT_EQ(pcm::test::differences(Json::parse(text_of(file)), now), "");
}

INSTANTIATE_TEST_SUITE_P(Of, FrozenAnswers, testing::ValuesIn(frozen_calls()),
                         [](const auto& info) { return info.param.name; });

TEST(FrozenFiles, AreThoseOfTheCalls)
{
    std::vector<std::string> names;
    for (const FrozenCall& call : frozen_calls()) names.push_back(call.name);
    pcm::test::expect_files_of(names, PCM_FROZEN_ANSWERS);
}

// What is kept notices what it should: a digit, an order, a key more, a letter of a text.
TEST(FrozenFiles, DifferWhereAnythingDiffers)
{
    using pcm::test::differences;
    using pcm::test::frozen;
    using pcm::test::frozen_text;
    Json list = Json::array();
    for (int i = 0; i < 20; ++i) list.push_back(i);
    Json other = list;
    std::swap(other[3], other[4]);
    EXPECT_EQ(differences(frozen(list, "/x"), frozen(list, "/x")), "");
    EXPECT_NE(differences(frozen(list, "/x"), frozen(other, "/x")), "");
    EXPECT_EQ(differences({{"a", 1.0}}, {{"a", 1.0 + 1e-7}}), "");
    EXPECT_NE(differences({{"a", 1.0}}, {{"a", 1.0 + 1e-5}}), "");
    EXPECT_NE(differences({{"a", 1.0}}, {{"a", 1.0}, {"b", nullptr}}), "");
    EXPECT_NE(differences({{"a", nullptr}}, {{"a", 0}}), "");
    EXPECT_EQ(frozen({{"seconds", 2}, {"output", "/x/y.pct"}}, "/x"), Json({{"output", "@/y.pct"}}));
    EXPECT_EQ(pcm::test::frozen_line("0.52 s, 3,210 points +- 1e-05, 3 MB"), "#, #points +- #, #");
    EXPECT_EQ(differences(frozen_text("LINE 1.5 -2", "/x"), frozen_text("LINE 1.5 -2.0000000001", "/x")), "");
    EXPECT_NE(differences(frozen_text("LINE 1.5 -2", "/x"), frozen_text("LINE 1.5 -2.1", "/x")), "");
    EXPECT_NE(differences(frozen_text("LINE 1.5 -2", "/x"), frozen_text("LINF 1.5 -2", "/x")), "");
    EXPECT_NE(differences(frozen_text("AB 1", "/x"), frozen_text("BA 1", "/x")), "");
}

}  // namespace
