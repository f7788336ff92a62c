// Several outputs of one command are written all or none, whatever fails.

#include "tests/cli/command.h"
#include "tests/faults.h"

#include <map>
#include <optional>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class Outputs : public CommandTest {
protected:
    Outputs() { start_again(); }

    void start_again()
    {
        fs::remove_all(work_);
        fs::create_directory(work_);
    }
    std::string work(const std::string& name) const { return (work_ / name).string(); }
    void write(const std::string& name, const std::string& text) const { std::ofstream(work_ / name) << text; }
    std::string text_of(const std::string& name) const
    {
        std::ifstream file(work_ / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    // All of the files, by name.
    std::map<std::string, std::string> files() const
    {
        std::map<std::string, std::string> found;
        for (const auto& entry : fs::directory_iterator(work_))
            found[entry.path().filename().string()] =
                entry.is_directory() ? "a folder" : text_of(entry.path().filename().string());
        return found;
    }

    // With every fault at many calls: all outputs are the new ones (the command reports it), or everything is as
    // before.
    void expect_all_or_none(const std::vector<std::string>& command, const std::map<std::string, std::string>& before)
    {
        const auto prepare = [&] {
            start_again();
            for (const auto& [name, text] : before) write(name, text);
        };
        prepare();
        const long calls = count_calls(command, work_);
        const auto after = files();
        ASSERT_EQ(after.size(), 3u);
        for (const auto& [name, text] : before) EXPECT_NE(after.at(name), text);
        bool failed = false;
        for (const std::string kind : {"full", "eio", "late"})
            for (const long at : spread(calls, 30)) {
                const std::string when = kind + " at " + std::to_string(at) + " of " + std::to_string(calls);
                prepare();
                const Faulty done = run_with_fault(command, work_, kind, at);
                EXPECT_EQ(files(), done.code == 1 ? before : after) << when << ": " << done.err;
                EXPECT_TRUE(done.code == 0 || done.code == 1 || done.code == 3) << when << ": " << done.err;
                failed = failed || done.code == 1;
            }
        EXPECT_TRUE(failed);
        for (const long at : spread(calls, 12)) {
            prepare();
            ASSERT_TRUE(run_with_fault(command, work_, "kill", at).killed);
            for (const auto& [name, text] : after) {
                const auto old = before.find(name);
                const std::string now = text_of(name);
                EXPECT_TRUE(now == text || now == (old == before.end() ? "" : old->second)) << name << ": " << now;
            }
            std::vector<std::string> again = command;
            if (std::find(again.begin(), again.end(), "--overwrite") == again.end()) again.push_back("--overwrite");
            EXPECT_EQ(run_with_fault(again, work_, "count").code, 0);
            EXPECT_EQ(files(), after) << "killed at " << at;
        }
    }

    const fs::path work_ = folder_ / "work";
};

TEST_F(Outputs, OfMeasure)
{
    const std::vector<std::string> command{
        paths::command, "measure", "distance",        "-p", "0",           "0", "0", "1", "1", "1", "-o",
        work("a.csv"),  "-o",      work("b.geojson"), "-o", work("c.json")};
    expect_all_or_none(command, {});
    std::vector<std::string> overwriting = command;
    overwriting.push_back("--overwrite");
    expect_all_or_none(overwriting, {{"a.csv", "old"}, {"c.json", "older"}});
}

TEST_F(Outputs, OfPrimitives)
{
    const fs::path list = folder_ / "list.json";
    std::ofstream(list) << R"({"format": "pcm primitives", "version": 1, "primitives": [
        {"name": "s", "kind": "sphere", "point": [1, 2, 3], "radius": 2}]})";
    const std::vector<std::string> command{paths::command, "primitives",   list.string(), "-o",         work("a.csv"),
                                           "-o",           work("b.json"), "-o",          work("c.scr")};
    expect_all_or_none(command, {});
    std::vector<std::string> overwriting = command;
    overwriting.push_back("--overwrite");
    expect_all_or_none(overwriting, {{"b.json", "old"}, {"c.scr", "older"}});
}

TEST_F(Outputs, TwoOfOneNameAreRefused)
{
    const Result result = pcmlab("measure point -p 1 2 3 -o " + path("work/a.csv") + " -o " + path("work/./a.csv"));
    EXPECT_EQ(result.code, 1);
    EXPECT_NE(result.err.find("two outputs have this name"), std::string::npos) << result.err;
    EXPECT_TRUE(files().empty());
}

// The list of detected primitives and the labels of the points.
TEST_F(Outputs, OfDetect)
{
    ASSERT_EQ(pcmlab("generate -n 6000 --no-truth " + path("a.las")).code, 0);
    ASSERT_EQ(pcmlab("build " + path("a.las") + " -m 64M").code, 0);
    const auto attributes_of = [&](const fs::path& tree) {
        return Json::parse(pcmlab("info --json '" + tree.string() + "'").out)["attributes"].size();
    };
    const std::size_t attributes = attributes_of(folder_ / "a.pct");
    const auto prepare = [&] {
        start_again();
        fs::copy(folder_ / "a.pct", work_ / "a.pct", fs::copy_options::recursive);
    };
    const std::vector<std::string> detect{paths::command, "detect", work("a.pct"), "--min-points", "50",
                                          "-t",           "1",      "--threshold", "0.3",          "--label",
                                          "shape",        "--out",  work("o.csv")};
    for (const bool in_place : {true, false}) {
        std::vector<std::string> command = detect;
        if (in_place)
            command.push_back("--in-place");
        else
            command.insert(command.end(), {"-o", work("o.pct")});
        const fs::path labelled = work_ / (in_place ? "a.pct" : "o.pct");
        prepare();
        const long calls = count_calls(command, work_);
        const std::string list = text_of("o.csv");
        ASSERT_FALSE(list.empty());
        EXPECT_EQ(attributes_of(labelled), attributes + 1);
        bool failed = false;
        for (const std::string kind : {"full", "eio", "kill"})
            for (const long at : spread(calls, 10)) {
                const std::string when = kind + " at " + std::to_string(at) + " of " + std::to_string(calls);
                prepare();
                const Faulty done = run_with_fault(command, work_, kind, at);
                const bool listed = fs::exists(work_ / "o.csv");
                const bool done_labels = fs::exists(labelled) && attributes_of(labelled) > attributes;
                if (listed) EXPECT_EQ(text_of("o.csv"), list) << when;
                if (listed) EXPECT_TRUE(done_labels) << when;
                if (fs::exists(labelled) && !in_place) EXPECT_TRUE(done_labels) << when;
                if (done.killed) continue;
                if (done.code == 0) EXPECT_TRUE(listed && done_labels) << when;
                if (done.code == 3) EXPECT_TRUE(done_labels) << when << ": " << done.err;
                if (done.code == 1) EXPECT_FALSE(listed || done_labels) << when << ": " << done.err;
                failed = failed || done.code == 1;
            }
        EXPECT_TRUE(failed);
    }
}

}  // namespace
