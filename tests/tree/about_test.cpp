#include "pcm/tree/about.h"

#include "pcm/system/error.h"
#include "tests/tree/small_tree.h"

#include <algorithm>
#include <cstring>
#include <string>

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

// The checksum of a file says nothing of its writer.
TEST(TreeInfoBytes, OneAttributeTwiceIsCorrupt)
{
    TreeInfo info;
    info.schema.add({"first", ScalarType::u8, 1, 1, 0, ""});
    info.schema.add({"other", ScalarType::u8, 1, 1, 0, ""});
    ByteWriter out;
    put_tree_info(out, info);
    std::vector<std::byte> bytes = out.bytes();
    const std::string name = "other";
    const auto at = std::search(bytes.begin(), bytes.end(), name.begin(), name.end(),
                                [](std::byte a, char b) { return a == static_cast<std::byte>(b); });
    ASSERT_NE(at, bytes.end());
    std::memcpy(&*at, "first", 5);
    ByteReader in(bytes.data(), bytes.size(), "about.pct");
    try {
        get_tree_info(in, "about.pct");
        ADD_FAILURE() << "not refused";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::corrupt);
        EXPECT_NE(std::string(error.what()).find("about.pct"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("first"), std::string::npos) << error.what();
    }
}

}  // namespace
