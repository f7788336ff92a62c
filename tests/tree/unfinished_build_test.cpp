#include "pcm/tree/unfinished_build.h"

#include "pcm/system/error.h"
#include "tests/tree/small_tree.h"

#include <string>
#include <tuple>
#include <utility>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

using UnfinishedBuildTest = SmallTree;

TEST_F(UnfinishedBuildTest, ATreeThatWasBeingReplacedIsNamedSo)
{
    build(2000);
    const fs::path part = build_folder_of(tree());
    EXPECT_EQ(part, folder_ / "out.pct.part");
    fs::create_directory(part);
    EXPECT_FALSE(was_being_replaced(tree()));  // the tree is in its place
    fs::create_directory(part / replaced_tree_name);
    EXPECT_FALSE(was_being_replaced(tree()));  // still: the new tree has replaced the old one
    fs::remove(part / replaced_tree_name);
    const auto opening = [&](const fs::path& path) {
        try {
            Tree::open(path);
        } catch (const Error& error) {
            return std::pair(error.code(), std::string(error.what()));
        }
        return std::pair(ErrorCode::cancelled, std::string("opened"));
    };
    fs::rename(tree(), part / replaced_tree_name);
    EXPECT_TRUE(was_being_replaced(tree()));
    auto [code, message] = opening(tree());
    EXPECT_EQ(code, ErrorCode::interrupted_build);
    EXPECT_NE(message.find("pcmlab repair"), std::string::npos) << message;

    // A build of a new tree: its folder is mentioned, and there is no tree to put back.
    fs::remove_all(part / replaced_tree_name);
    EXPECT_FALSE(was_being_replaced(tree()));
    std::tie(code, message) = opening(tree());
    EXPECT_EQ(code, ErrorCode::not_found);
    EXPECT_NE(message.find("interrupted"), std::string::npos) << message;
    fs::remove_all(part);
    std::tie(code, message) = opening(tree());
    EXPECT_EQ(code, ErrorCode::not_found);
    EXPECT_EQ(message.find("interrupted"), std::string::npos) << message;

    // The folder of a build, opened itself.
    fs::create_directory(part);
    write_file(part / build_marker_name, {});
    EXPECT_EQ(opening(part).first, ErrorCode::interrupted_build);
}

}  // namespace
