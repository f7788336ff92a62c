#include "plugin/scene/tree_cache.h"

#include "tests/support.h"

#include "pcm/system/error.h"

#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

namespace pcm::host {
namespace {

namespace fs = std::filesystem;

std::size_t entries(const fs::path& folder)
{
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

void fill(const CachedTree& tree, std::size_t bytes)
{
    fs::create_directories(tree.folder());
    std::ofstream(tree.folder() / "chunks-000.bpc") << std::string(bytes, 'x');
}

TEST(TreeCache, RemovesATreeWithItsLayerAndAllOfThemAtTheEnd)
{
    const test::TemporaryFolder folder;
    const fs::path root = folder / "cache";
    {
        TreeCache cache(root);
        auto one = cache.reserve(100);
        const auto two = cache.reserve(100);
        ASSERT_NE(one->folder(), two->folder());
        fill(*one, 10);
        fill(*two, 10);
        const fs::path gone = one->folder();
        one.reset();
        EXPECT_FALSE(fs::exists(gone));
        EXPECT_TRUE(fs::exists(two->folder()));
    }
    EXPECT_EQ(entries(root), 0u);
}

TEST(TreeCache, IsBounded)
{
    const test::TemporaryFolder folder;
    TreeCache cache(folder / "cache", 1000);
    const auto tree = cache.reserve(600);
    fill(*tree, 600);
    EXPECT_NO_THROW(cache.reserve(400));
    try {
        cache.reserve(401);
        FAIL() << "more than the limit";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::no_space);
    }
}

TEST(TreeCache, RemovesWhatACrashedProcessLeftAndNothingOfALivingOne)
{
    const test::TemporaryFolder folder;
    const fs::path root = folder / "cache";
    TreeCache living(root);
    const auto mine = living.reserve(1);
    fill(*mine, 10);
    const pid_t child = fork();
    if (child == 0) {
        auto* crashing = new TreeCache(root);
        fill(**new std::shared_ptr<const CachedTree>(crashing->reserve(1)), 10);
        _exit(0);  // without destructors
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(entries(root), 4u);  // two sessions, and their locks
    std::ofstream(root / "a user's file") << "text";

    TreeCache next(root);
    EXPECT_EQ(next.remove_leftovers(), 1);
    EXPECT_TRUE(fs::exists(mine->folder()));
    EXPECT_EQ(entries(root), 3u);
    EXPECT_EQ(next.remove_leftovers(), 0);
}

}  // namespace
}  // namespace pcm::host
