// verify_tree() and repair_tree() agree on every damage, and a repaired tree is whole.

#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/update/append.h"
#include "pcm/update/erase.h"
#include "pcm/update/repair.h"
#include "tests/sanitizers.h"
#include "tests/update/model.h"

#include <fstream>
#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class Verdicts : public testing::Test {
protected:
    // Three generations; what the second has written is no longer in use.
    void SetUp() override
    {
        build(surface(300, 0, 0, 10, 1), path_);
        append(path_, surface(200, 50, 0, 10, 2));
        Selection selection;
        selection.box = Box3d{{1055, 1900, -100}, {1100, 2100, 100}};
        ASSERT_GT(erase_points(path_, selection).points_deleted, 0u);
        fs::remove(path_ / "lock");
        for (const auto& entry : fs::directory_iterator(path_)) {
            std::ifstream file(entry.path(), std::ios::binary);
            files_[entry.path().filename().string()] = std::string(std::istreambuf_iterator<char>(file), {});
        }
        ASSERT_GE(files_.size(), 5u);
    }

    void put(const std::string& name, const std::string& bytes) const
    {
        std::ofstream(path_ / name, std::ios::binary | std::ios::trunc) << bytes;
    }
    void restore() const
    {
        fs::remove_all(path_);
        fs::create_directory(path_);
        for (const auto& [name, bytes] : files_) put(name, bytes);
    }

    static RepairOptions check()
    {
        RepairOptions options;
        options.check_only = true;
        options.threads = 1;
        return options;
    }
    bool verify_finds_nothing(std::string& why) const
    {
        try {
            const VerifyReport report = verify_tree(path_, 1);
            for (const auto* faults : {&report.faults, &report.around})
                for (const std::string& fault : *faults) why += fault + "; ";
            return why.empty();
        } catch (const Error& error) {
            why = error.what();
            return false;
        }
    }
    bool repair_finds_nothing(std::string& why) const
    {
        try {
            const RepairReport report = repair_tree(path_, check());
            for (const auto* faults : {&report.faults, &report.restored})
                for (const std::string& fault : *faults) why += fault + "; ";
            return report.whole();
        } catch (const Error& error) {
            why = error.what();
            return false;
        }
    }
    // Both agree; returns whether there is damage.
    bool expect_agreement(const std::string& when) const
    {
        std::string verify, repair;
        const bool whole = verify_finds_nothing(verify);
        EXPECT_EQ(repair_finds_nothing(repair), whole) << when << "\nverify: " << verify << "\nrepair: " << repair;
        return !whole;
    }
    // A repair that succeeds leaves a whole tree, and a second one finds nothing to do.
    void expect_repaired(const std::string& when) const
    {
        RepairOptions options;
        options.threads = 1;
        try {
            const RepairReport report = repair_tree(path_, options);
            EXPECT_TRUE(report.verified) << when;
        } catch (const Error&) {
            return;  // nothing of the tree can be saved
        }
        std::string why;
        EXPECT_TRUE(verify_finds_nothing(why)) << when << ": " << why;
        EXPECT_TRUE(repair_finds_nothing(why)) << when << ": " << why;
    }

    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct";
    std::map<std::string, std::string> files_;
};

TEST_F(Verdicts, OfAWholeTree) { EXPECT_FALSE(expect_agreement("whole")); }

// Not under the thread sanitizer: all of it runs in one thread.
TEST_F(Verdicts, PCM_NOT_UNDER_THREAD(OfASingleByteAnywhere))
{
    std::map<std::string, int> damaged;
    int tried = 0;
    for (const auto& [name, bytes] : files_)
        for (std::size_t at = 0; at < bytes.size();
             at += tries(1, 7) + (at > 200 ? bytes.size() / tries(300, 40) : 0)) {
            std::string changed = bytes;
            changed[at] = static_cast<char>(changed[at] ^ (at % 2 ? 0x01 : 0x80));
            put(name, changed);
            const std::string when = name + ", byte " + std::to_string(at);
            damaged[name] += expect_agreement(when);
            if (++tried % 13 == 0) {
                expect_repaired(when);
                restore();
            }
            put(name, bytes);
        }
    for (const auto& [name, bytes] : files_)
        if (name != "chunks-001.bpc") EXPECT_GT(damaged[name], tries(100, 14)) << name;
    EXPECT_FALSE(expect_agreement("restored"));
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(Verdicts, PCM_NOT_UNDER_THREAD(OfLengthsAndMissingFiles))
{
    for (const auto& [name, bytes] : files_) {
        for (const std::size_t length : {std::size_t(0), std::size_t(1), std::size_t(8), std::size_t(27),
                                         bytes.size() / 2, bytes.size() - 8, bytes.size() - 1}) {
            const std::string when = name + ", " + std::to_string(length) + " bytes";
            put(name, bytes.substr(0, length));
            expect_agreement(when);
            expect_repaired(when);
            restore();
        }
        put(name, bytes + "more");
        expect_agreement(name + ", longer");
        expect_repaired(name + ", longer");
        restore();
        fs::remove(path_ / name);
        EXPECT_TRUE(expect_agreement(name + ", missing"));
        expect_repaired(name + ", missing");
        restore();
    }
}

// Each file of another generation.
TEST_F(Verdicts, OfFilesOfAnotherTime)
{
    erase_points(path_, [] {
        Selection selection;
        selection.where.push_back(parse_condition("classification=5"));
        return selection;
    }());
    std::map<std::string, std::string> later;
    for (const auto& entry : fs::directory_iterator(path_)) {
        std::ifstream file(entry.path(), std::ios::binary);
        later[entry.path().filename().string()] = std::string(std::istreambuf_iterator<char>(file), {});
    }
    restore();
    for (const auto& [name, bytes] : later) {
        put(name, bytes);
        expect_agreement("later " + name);
        expect_repaired("later " + name);
        restore();
    }
    for (const auto& [name, bytes] : files_) {
        for (const auto& [of_later, now] : later) put(of_later, now);
        put(name, bytes);
        expect_agreement("earlier " + name);
        expect_repaired("earlier " + name);
        restore();
    }
}

}  // namespace
