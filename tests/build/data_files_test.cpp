// Which chunks are in a tree's first data file, and in which order.

#include "pcm/build/nodes/data_files.h"

#include "pcm/system/file.h"
#include "pcm/tree/tree_index.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace pcm;
using namespace pcm::test;

NodePath path_of(const std::string& sides)
{
    NodePath path;
    for (const char side : sides) path = path.child(side == '1');
    return path;
}

TEST(DataFiles, TheFirstFileHasTheCoarseLevelsInOrderOfLevelAndPlace)
{
    const TemporaryFolder folder;
    DataFiles files(folder.path(), folder.path(), 0);
    files.choose_front({1'000'000, 6'900'000, 100'000, 1});  // the last level makes them more than 8 million
    DraftStore drafts;
    struct Case {
        std::string sides;
        std::uint16_t level;
    };
    // In the order in which nodes are built: children before their parents.
    const std::vector<Case> built = {{"000", 3}, {"001", 2}, {"00", 1}, {"0100", 2}, {"01", 1},
                                     {"0", 1},   {"10", 2},  {"11", 3}, {"1", 1},    {"", 0}};
    std::vector<Draft*> made;
    for (std::size_t i = 0; i < built.size(); ++i) {
        Draft* const draft = drafts.add(path_of(built[i].sides));
        draft->first_level = built[i].level;
        const std::vector<std::byte> bytes(10 + i, static_cast<std::byte>(i));
        draft->extent.bytes = bytes.size();
        files.append(*draft, bytes.data(), bytes.size());
        made.push_back(draft);
    }
    files.finish();

    std::vector<std::pair<std::uint64_t, std::string>> front;
    for (std::size_t i = 0; i < built.size(); ++i) {
        EXPECT_EQ(made[i]->extent.file, built[i].level <= 2 ? 0u : 1u) << built[i].sides;
        if (made[i]->extent.file == 0) front.emplace_back(made[i]->extent.offset, built[i].sides);
        std::byte first{};
        File(folder.path() / data_file_name(made[i]->extent.file), File::Mode::read)
            .read_at(&first, 1, made[i]->extent.offset);
        EXPECT_EQ(first, static_cast<std::byte>(i));
    }
    std::sort(front.begin(), front.end());
    std::vector<std::string> order;
    for (const auto& [offset, sides] : front) order.push_back(sides);
    EXPECT_EQ(order, std::vector<std::string>({"", "0", "00", "01", "1", "001", "0100", "10"}));
    EXPECT_EQ(front.front().first, 0u);
}

// Every cloud has a picture of its coarsest level in front, however many points that has.
TEST(DataFiles, TheCoarsestLevelIsAlwaysInFront)
{
    const TemporaryFolder folder;
    DataFiles files(folder.path(), folder.path(), 5);
    files.choose_front({100'000'000, 5});
    DraftStore drafts;
    const std::byte byte{1};
    for (const std::uint16_t level : {std::uint16_t{1}, std::uint16_t{0}}) {
        Draft* const draft = drafts.add(path_of(level ? "1" : ""));
        draft->first_level = level;
        draft->extent.bytes = 1;
        files.append(*draft, &byte, 1);
        EXPECT_EQ(draft->extent.file, level ? 6u : 5u);
    }
}

}  // namespace
