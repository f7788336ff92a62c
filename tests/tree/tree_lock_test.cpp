#include "pcm/tree/tree_lock.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <sys/wait.h>
#include <unistd.h>

#include <optional>

namespace {

using namespace pcm;
using namespace pcm::test;

ErrorCode locking(const std::filesystem::path& folder)
{
    try {
        const TreeLock lock(folder);
    } catch (const Error& error) {
        return error.code();
    }
    return ErrorCode::cancelled;  // it was free
}

TEST(TreeLock, IsHeldByOne)
{
    const TemporaryFolder folder;
    {
        const TreeLock lock(folder.path());
        EXPECT_EQ(locking(folder.path()), ErrorCode::exists);
        const pid_t child = fork();
        if (child == 0) _exit(locking(folder.path()) == ErrorCode::exists ? 0 : 1);
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_EQ(status, 0);
    }
    EXPECT_EQ(locking(folder.path()), ErrorCode::cancelled);
}

TEST(TreeLock, EndsWithTheProcessThatHoldsIt)
{
    const TemporaryFolder folder;
    const pid_t child = fork();
    if (child == 0) {
        const TreeLock lock(folder.path());
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    EXPECT_EQ(locking(folder.path()), ErrorCode::cancelled);
}

TEST(TreeLock, NamesTheReasonWhenItCannotLock)
{
    const TemporaryFolder folder;
    EXPECT_EQ(locking(folder / "none"), ErrorCode::not_found);
}

}  // namespace
