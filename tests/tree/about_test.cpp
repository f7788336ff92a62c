#include "pcm/tree/about.h"

#include "pcm/system/error.h"
#include "tests/tree/small_tree.h"

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

using AboutTest = SmallTree;

TEST_F(AboutTest, AboutSaysWhatTheIndexSays)
{
    build(3000, 1000);
    const TreeInfo info = index().info;
    EXPECT_TRUE(same_info(read_about(tree()), info));
    const auto good = read_file(tree() / about_file_name);
    for (std::size_t at = 0; at < good.size(); ++at) {
        auto bad = good;
        bad[at] ^= std::byte(0x20);
        write_file(tree() / about_file_name, bad);
        EXPECT_THROW(read_about(tree()), Error) << at;
    }
    for (std::size_t length = 0; length < good.size(); length += 5) {
        write_file(tree() / about_file_name, {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)});
        EXPECT_THROW(read_about(tree()), Error) << length;
    }
}

}  // namespace
