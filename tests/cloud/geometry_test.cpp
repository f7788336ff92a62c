#include "pcm/cloud/geometry.h"

#include <gtest/gtest.h>

namespace {

using namespace pcm;

TEST(Box, EmptyExtendContains)
{
    Box3d box;
    EXPECT_TRUE(box.empty());
    EXPECT_EQ(box.diagonal(), 0);
    box.extend(Vec3d{1, 2, 3});
    EXPECT_FALSE(box.empty());
    EXPECT_TRUE(box.contains(Vec3d{1, 2, 3}));
    box.extend(Vec3d{5e6, 2, 3});
    EXPECT_TRUE(box.contains(Vec3d{5e6, 2, 3}));
    EXPECT_FALSE(box.contains(Vec3d{5e6, 2.5, 3}));
    EXPECT_FALSE(Box3d().intersects(box));
    EXPECT_FALSE(box.contains(Box3d()));
}

}  // namespace
