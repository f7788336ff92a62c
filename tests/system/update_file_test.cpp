#include "pcm/system/update_file.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <set>
#include <sstream>
#include <thread>
#include <vector>

namespace pcm::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

std::string content(const fs::path& path)
{
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

// Adds a line as slowly as a list is read and written.
void add_line(const fs::path& path, const std::string& line)
{
    update_file(path, [&] {
        const std::string before = content(path);
        std::this_thread::sleep_for(milliseconds(2));
        return before + line + "\n";
    });
}

TEST(UpdateFile, ProcessesAtOnceLoseNothing)
{
    constexpr int processes = 8, lines = 20;
    TemporaryFolder folder;
    const fs::path path = folder / "list";  // made by the first of them
    std::vector<pid_t> children;
    for (int p = 0; p < processes; ++p) {
        const pid_t child = fork();
        if (child == 0) {
            for (int n = 0; n < lines; ++n) add_line(path, std::to_string(p) + " " + std::to_string(n));
            _exit(0);
        }
        children.push_back(child);
    }
    for (const pid_t child : children) {
        int status = -1;
        waitpid(child, &status, 0);
        EXPECT_EQ(status, 0);
    }
    std::istringstream text(content(path));
    std::set<std::string> found;
    for (std::string line; std::getline(text, line);) EXPECT_TRUE(found.insert(line).second) << line;
    EXPECT_EQ(found.size(), static_cast<std::size_t>(processes * lines));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1) << "remains";
}

// As a program without locks does, or any program where the file system has none.
TEST(UpdateFile, AChangeSinceReadingIsReadAgain)
{
    TemporaryFolder folder;
    const fs::path path = folder / "list";
    for (const bool exists : {false, true}) {
        SCOPED_TRACE(exists);
        if (exists) std::ofstream(path) << "first\n";
        int calls = 0;
        update_file(path, [&] {
            const std::string before = content(path);
            if (++calls == 1) {
                std::ofstream(folder / "stranger's") << before << "stranger\n";
                fs::rename(folder / "stranger's", path);
            }
            return before + "mine\n";
        });
        EXPECT_EQ(calls, 2);
        EXPECT_EQ(content(path), exists ? "first\nstranger\nmine\n" : "stranger\nmine\n");
    }
    // A change of the same size, in the same file.
    int calls = 0;
    update_file(path, [&] {
        std::string before = content(path);
        if (++calls == 1) {
            std::this_thread::sleep_for(milliseconds(20));  // longer than a tick of the file system's clock
            std::fstream(path, std::ios::in | std::ios::out) << "FIRST";
        }
        return before + "again\n";
    });
    EXPECT_EQ(content(path), "FIRST\nstranger\nmine\nagain\n");
}

TEST(UpdateFile, AFileThatNeverRestsIsLeftAlone)
{
    TemporaryFolder folder;
    const fs::path path = folder / "list";
    int calls = 0;
    try {
        update_file(path, [&] {
            std::ofstream(path, std::ios::app) << ++calls << "\n";
            return std::string("mine\n");
        });
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::io);
        EXPECT_NE(std::string(error.what()).find("change this file all the time"), std::string::npos) << error.what();
    }
    EXPECT_EQ(content(path).find("mine"), std::string::npos);
}

TEST(UpdateFile, AFolderThatStaysLockedIsNamed)
{
    TemporaryFolder folder;
    const int held = ::open(folder.path().c_str(), O_RDONLY | O_DIRECTORY);
    ASSERT_EQ(::flock(held, LOCK_EX), 0);
    try {
        update_file(
            folder / "list", [] { return std::string("mine\n"); }, milliseconds(30));
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("keeps the folder of this file locked"), std::string::npos);
    }
    ::close(held);
    EXPECT_FALSE(fs::exists(folder / "list"));
    add_line(folder / "list", "mine");  // the lock was given back
    add_line(folder / "list", "mine");
    EXPECT_EQ(content(folder / "list"), "mine\nmine\n");
}

TEST(UpdateFile, AFailureChangesNothing)
{
    TemporaryFolder folder;
    const fs::path path = folder / "list";
    std::ofstream(path) << "first\n";
    EXPECT_THROW(update_file(path, []() -> std::string { throw Error(ErrorCode::bad_format, {}, "no list"); }), Error);
    EXPECT_EQ(content(path), "first\n");
    fs::create_symlink(path, folder / "link");
    add_line(folder / "link", "second");
    EXPECT_EQ(content(path), "first\nsecond\n");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
}

}  // namespace
}  // namespace pcm::test
