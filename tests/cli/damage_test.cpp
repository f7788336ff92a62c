// What the command says of trees whose files are damaged, missing or another tree's: what is wrong, and what to do.

#include "tests/cli/command.h"

#include <sys/stat.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <vector>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class DamageTest : public CommandTest {
protected:
    // Three generations in three data files.
    void SetUp() override
    {
        run("generate -n 6000 --seed 3 " + path("scene.las"));
        run("generate -n 3000 --seed 4 " + path("more.las"));
        run("build --chunk-points 1000 " + path("scene.las"));
        run("append " + path("scene.pct") + " " + path("more.las"));
        run("delete " + path("scene.pct") + " --where 'x<500002'");
        run("build --chunk-points 1000 " + path("more.las") + " -o " + path("other.pct"));
        for (const auto& entry : fs::directory_iterator(tree_)) {
            std::ifstream file(entry.path(), std::ios::binary);
            files_[entry.path().filename().string()] = std::string(std::istreambuf_iterator<char>(file), {});
        }
        ASSERT_EQ(files_.count("chunks-002.bpc"), 1u);
    }
    void run(const std::string& arguments)
    {
        const Result result = pcmlab(arguments);
        ASSERT_EQ(result.code, 0) << arguments << ": " << result.err;
    }
    void put(const std::string& name, const std::string& bytes) const
    {
        fs::remove_all(tree_ / name);
        std::ofstream(tree_ / name, std::ios::binary) << bytes;
    }
    void restore() const
    {
        fs::remove_all(tree_);
        fs::create_directory(tree_);
        for (const auto& [name, bytes] : files_) put(name, bytes);
    }
    // verify either finds the tree damaged and names the way out, or does not, and ends with "intact".
    bool expect_verdict(const std::string& when)
    {
        const Result result = pcmlab("verify " + path("scene.pct"));
        const std::string all = result.out + result.err;
        const bool says_intact = all.find(": intact;") != std::string::npos;
        EXPECT_EQ(says_intact, result.code == 0) << when << ": " << all;
        EXPECT_EQ(all.find("in a terminal: pcmlab repair " + tree_.string()) == std::string::npos, result.code == 0)
            << when << ": " << all;
        return result.code == 0;
    }

    const fs::path tree_ = folder_ / "scene.pct";
    std::map<std::string, std::string> files_;
};

TEST_F(DamageTest, VerifySaysOfEveryFileThatItIsDamagedAndWhatToDo)
{
    using Change = std::function<void(const std::string& name)>;
    const auto flipped = [this](double where) {
        return [this, where](const std::string& name) {
            std::string bytes = files_[name];
            bytes[static_cast<std::size_t>(where * static_cast<double>(bytes.size() - 1))] ^= 0x55;
            put(name, bytes);
        };
    };
    const auto cut = [this](double part) {
        return [this, part](const std::string& name) {
            put(name,
                files_[name].substr(0, static_cast<std::size_t>(part * static_cast<double>(files_[name].size()))));
        };
    };
    const std::vector<std::pair<const char*, Change>> changes = {
        {"first byte", flipped(0)},
        {"a third", flipped(0.3)},
        {"the middle", flipped(0.5)},
        {"the end", flipped(1)},
        {"half of it", cut(0.5)},
        {"empty", cut(0)},
        {"missing", [this](const std::string& name) { fs::remove(tree_ / name); }},
        {"a folder",
         [this](const std::string& name) {
             fs::remove(tree_ / name);
             fs::create_directory(tree_ / name);
         }},
        {"a FIFO",
         [this](const std::string& name) {
             fs::remove(tree_ / name);
             mkfifo((tree_ / name).c_str(), 0666);
         }},
        {"another tree's",
         [this](const std::string& name) {
             const fs::path other = folder_ / "other.pct" / name;
             fs::remove(tree_ / name);
             fs::copy_file(fs::exists(other) ? other : folder_ / "other.pct/chunks-000.bpc", tree_ / name);
         }},
    };
    for (const char* name : {"about.pct", "index.pct", "chunks-002.bpc"})
        for (const auto& [what, change] : changes) {
            restore();
            change(name);
            const std::string when = std::string(name) + ", " + what;
            // The last data file ends with a record that only a lost index needs.
            const bool is_record = name == std::string("chunks-002.bpc") && what == std::string("the end");
            EXPECT_EQ(expect_verdict(when), is_record) << when;
        }
}

TEST_F(DamageTest, AnyCommandThatMeetsADamagedChunkNamesTheRepair)
{
    for (const auto& [name, bytes] : files_)
        if (name.compare(0, 7, "chunks-") == 0)
            for (std::size_t at = 200; at < bytes.size(); at += 400) {
                std::string damaged = bytes;
                damaged[at] ^= 0x55;
                put(name, damaged);
            }
    std::string damaged = files_["chunks-002.bpc"];
    for (std::size_t at = 1000; at < damaged.size(); at += 200) damaged[at] ^= 0x55;
    put("chunks-002.bpc", damaged);
    const std::string tree = path("scene.pct"), way_out = "in a terminal: pcmlab repair " + tree_.string();
    for (const std::string& command :
         {"query " + tree + " --where 'intensity>3'", "convert " + tree + " " + path("o.las"),
          "normals --in-place " + tree, "select " + tree + " --where 'intensity>3'",
          "subsample " + tree + " -o " + path("s.pct") + " --points 100 --exact"}) {
        const Result result = pcmlab(command);
        EXPECT_EQ(result.code, 1) << command << result.out;
        EXPECT_NE(result.err.find(way_out), std::string::npos) << command << ": " << result.err;
        EXPECT_EQ(result.err.find(way_out), result.err.rfind(way_out)) << "twice: " << result.err;
    }
}

TEST_F(DamageTest, RepairNamesAForeignDataFileAndTheWayOut)
{
    const std::string tree = path("scene.pct");
    const auto expect_refused = [&](const std::string& file, const std::string& way_out) {
        const Result result = pcmlab("repair " + tree);
        EXPECT_EQ(result.code, 1) << result.out;
        EXPECT_NE(result.err.find(file), std::string::npos) << result.err;
        EXPECT_NE(result.err.find("another tree"), std::string::npos) << result.err;
        EXPECT_NE(result.err.find(way_out), std::string::npos) << result.err;
    };
    const fs::path other = folder_ / "other.pct/chunks-000.bpc";
    fs::copy_file(other, tree_ / "chunks-000.bpc", fs::copy_options::overwrite_existing);
    expect_refused("chunks-000.bpc", "put the tree's own back");
    // The way out: it is moved away, and the rest is kept.
    fs::remove(tree_ / "chunks-000.bpc");
    EXPECT_EQ(pcmlab("repair " + tree).code, 0);
    EXPECT_EQ(pcmlab("verify " + tree).code, 0);
    // Or the tree's own is put back.
    restore();
    EXPECT_EQ(pcmlab("verify " + tree).code, 0);
    // A file after the tree's own: it is kept, and reported.
    fs::copy_file(other, tree_ / "chunks-003.bpc");
    const Result repaired = pcmlab("repair " + tree);
    EXPECT_EQ(repaired.code, 3);
    EXPECT_NE(repaired.err.find("chunks-003.bpc"), std::string::npos) << repaired.err;
    EXPECT_TRUE(fs::exists(tree_ / "chunks-003.bpc"));
    const Result appended = pcmlab("append " + tree + " " + path("more.las"));
    EXPECT_EQ(appended.code, 1);
    EXPECT_NE(appended.err.find("chunks-003.bpc: this file has the name of the tree's next data file"),
              std::string::npos)
        << appended.err;
    EXPECT_TRUE(fs::exists(tree_ / "chunks-003.bpc"));
}

}  // namespace
