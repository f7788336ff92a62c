#include "plugin/scene/replaced_trees.h"

#include "pcm/remote/remote_object.h"

#include <gtest/gtest.h>

namespace pcm::host {
namespace {

TEST(ReplacedTrees, OtherPointsOrFilesThatAreGoneTakeThePlace)
{
    TreeInfo before, now;
    before.content_hash = now.content_hash = 7;
    before.generation = now.generation = 2;
    EXPECT_FALSE(takes_the_place(now, before, "chunks-001.bpc: a checksum is wrong"));
    EXPECT_TRUE(takes_the_place(
        now, before,
        "http://host/t.pct/chunks-000.bpc: this file has been replaced on the server since it was opened"));
    now.content_hash = 8;
    EXPECT_TRUE(takes_the_place(now, before, "chunks-001.bpc: a checksum is wrong"));
    now.content_hash = 7;
    now.generation = 3;
    EXPECT_TRUE(takes_the_place(now, before, "chunks-001.bpc: a checksum is wrong"));
}

}  // namespace
}  // namespace pcm::host
