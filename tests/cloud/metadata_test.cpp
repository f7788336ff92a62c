#include "pcm/cloud/metadata.h"

#include <gtest/gtest.h>

namespace {

using namespace pcm;

TEST(Metadata, EqualByKeyAndEveryByte)
{
    const Metadata block{"las.vlr/LASF_Projection/34735", {std::byte{0}, std::byte{1}, std::byte{0}}};
    Metadata other = block;
    EXPECT_TRUE(other == block);
    other.key = "las.vlr/LASF_Projection/34736";
    EXPECT_FALSE(other == block);
    other = block;
    other.value[2] = std::byte{1};
    EXPECT_FALSE(other == block);
    other = block;
    other.value.pop_back();  // a shorter beginning of it
    EXPECT_FALSE(other == block);
    EXPECT_FALSE((Metadata{"key", {}} == Metadata{"key", {std::byte{0}}}));
}

}  // namespace
