#include "pcm/system/scratch_folder.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class ScratchFolders : public testing::Test {
protected:
    std::set<std::string> names() const
    {
        std::set<std::string> all;
        for (const auto& entry : fs::directory_iterator(folder_.path())) all.insert(entry.path().filename().string());
        return all;
    }
    // As a process leaves its folder that is killed.
    fs::path left_behind(const std::string& name)
    {
        const fs::path copy = folder_ / name;
        const ScratchFolder scratch(folder_ / "template");
        fs::copy(scratch.work().parent_path(), copy, fs::copy_options::recursive);
        fs::create_directories(copy / "work" / "input.pct");
        std::ofstream(copy / "work" / "input.pct" / "chunks-000.bpc") << "many bytes";
        return copy;
    }
    const TemporaryFolder folder_;
    const fs::path output_ = folder_ / "o.pct";
};

TEST_F(ScratchFolders, AreRemovedWithTheirFiles)
{
    {
        const ScratchFolder one(output_), two(output_);
        EXPECT_NE(one.work(), two.work());
        for (const ScratchFolder* scratch : {&one, &two}) {
            EXPECT_TRUE(fs::is_empty(scratch->work()));
            std::ofstream(scratch->work() / "file") << "bytes";
        }
        EXPECT_EQ(names().size(), 2u);
    }
    EXPECT_EQ(names(), std::set<std::string>{});
    EXPECT_THROW(ScratchFolder(folder_ / "none" / "o.pct"), Error);
}

TEST_F(ScratchFolders, ThoseOfKilledProcessesAreRemovedByTheNext)
{
    left_behind("o.pct.part-1-0");
    fs::create_directory(folder_ / "o.pct.part-2-0");  // killed before the marker was made
    fs::create_directory(folder_ / "o.pct.part-3-0");  // and after it
    std::ofstream(folder_ / "o.pct.part-3-0" / "scratch");
    const fs::path of_another = left_behind("p.pct.part-1-0");
    {
        const ScratchFolder next(output_);
        EXPECT_EQ(names().size(), 2u);
    }
    EXPECT_EQ(names(), std::set<std::string>{"p.pct.part-1-0"});
}

TEST_F(ScratchFolders, OneInUseStays)
{
    const fs::path used = left_behind("o.pct.part-1-0");
    const int lock = ::open((used / "scratch").c_str(), O_RDWR);
    ASSERT_EQ(::flock(lock, LOCK_EX), 0);
    {
        const ScratchFolder next(output_);
    }
    EXPECT_TRUE(fs::exists(used / "work" / "input.pct" / "chunks-000.bpc"));
    ::close(lock);
    {
        const ScratchFolder next(output_);
    }
    EXPECT_EQ(names(), std::set<std::string>{});
}

// Whatever has such a name without being a scratch folder, and what others have put into one.
TEST_F(ScratchFolders, NothingElseIsRemoved)
{
    fs::create_directories(folder_ / "o.pct.input" / "work");
    fs::create_directories(folder_ / "o.pct.part-1-0" / "work");
    fs::create_directories(folder_ / "o.pct.part-2-0" / "work");
    std::ofstream(folder_ / "o.pct.part-2-0" / "scratch") << "notes of mine";
    std::ofstream(folder_ / "o.pct.part-3-0") << "a file";
    std::ofstream(left_behind("o.pct.part-4-0") / "letter.txt") << "mine";
    fs::create_directory(folder_ / "elsewhere");
    std::ofstream(left_behind("kept") / "letter.txt") << "mine";
    fs::create_directory_symlink("kept", folder_ / "o.pct.part-5-0");
    left_behind("o.pct.part-6");
    const std::set<std::string> before = names();
    {
        const ScratchFolder next(output_);
    }
    EXPECT_EQ(names(), before);
    EXPECT_TRUE(fs::exists(folder_ / "o.pct.part-1-0" / "work"));
    EXPECT_TRUE(fs::exists(folder_ / "o.pct.part-2-0" / "work"));
    EXPECT_TRUE(fs::exists(folder_ / "o.pct.part-4-0" / "letter.txt"));
    EXPECT_TRUE(fs::exists(folder_ / "kept" / "work" / "input.pct" / "chunks-000.bpc"));
    EXPECT_TRUE(fs::exists(folder_ / "o.pct.part-6" / "work" / "input.pct" / "chunks-000.bpc"));
}

}  // namespace
