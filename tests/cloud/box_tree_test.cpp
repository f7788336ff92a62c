#include "pcm/cloud/box_tree.h"
#include "pcm/cloud/growing_box_tree.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pcm {
namespace {

std::vector<std::uint32_t> touching_one_by_one(const std::vector<Box3d>& boxes, const Box3d& box)
{
    std::vector<std::uint32_t> found;
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (boxes[i].intersects(box)) found.push_back(static_cast<std::uint32_t>(i));
    return found;
}

Box3d box_at(std::mt19937& random, double room, double size)
{
    std::uniform_real_distribution<double> place(0, room), side(0, size);
    Box3d box;
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] = place(random);
        box.max[a] = box.min[a] + side(random);
    }
    return box;
}

TEST(BoxTree, FindsTheBoxesThatAreFoundOneByOne)
{
    std::mt19937 random(7);
    for (const std::size_t count : {1u, 2u, 8u, 9u, 100u, 3000u})
        for (const double size : {0.0, 0.1, 30.0}) {
            std::vector<Box3d> boxes;
            for (std::size_t i = 0; i < count; ++i) boxes.push_back(box_at(random, 10, size));
            const BoxTree tree(boxes);
            for (int k = 0; k < 40; ++k) {
                const Box3d box = k % 4 == 0 ? boxes[random() % count] : box_at(random, 10, 2);
                EXPECT_EQ(tree.touching(box), touching_one_by_one(boxes, box)) << count << " " << size;
            }
        }
}

TEST(BoxTree, ASubsetIsSearchedAlone)
{
    std::mt19937 random(8);
    for (const std::size_t count : {1u, 9u, 700u}) {
        std::vector<Box3d> boxes;
        for (std::size_t i = 0; i < count; ++i) boxes.push_back(box_at(random, 10, 1));
        const BoxTree tree(boxes);
        BoxTree::Subset subset(tree);
        std::vector<Box3d> in_it(count);  // an empty box touches nothing
        for (int k = 0; k < 60; ++k) {
            const Box3d box = box_at(random, 10, 3);
            EXPECT_EQ(subset.touching(box), touching_one_by_one(in_it, box)) << count << ", " << k << " added";
            const auto more = static_cast<std::uint32_t>(random() % count);
            subset.add(more);
            in_it[more] = boxes[more];
        }
    }
}

TEST(GrowingBoxTree, FindsEachNumberOnceByAnyOfItsBoxes)
{
    std::mt19937 random(9);
    GrowingBoxTree tree;
    EXPECT_TRUE(tree.touching(box_at(random, 10, 10)).empty());
    std::vector<Box3d> boxes;
    std::vector<std::uint32_t> numbers;
    for (int k = 0; k < 500; ++k) {
        boxes.push_back(box_at(random, 10, 1));
        numbers.push_back(static_cast<std::uint32_t>(random() % 200));
        tree.add(boxes.back(), numbers.back());
        const Box3d box = box_at(random, 10, 3);
        std::vector<std::uint32_t> expected;
        for (const std::uint32_t i : touching_one_by_one(boxes, box)) expected.push_back(numbers[i]);
        std::sort(expected.begin(), expected.end());
        expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
        EXPECT_EQ(tree.touching(box), expected) << k;
    }
}

// As units are: shared faces touch, also of boxes at one place.
TEST(BoxTree, FacesAndBoxesAtOnePlaceTouch)
{
    std::vector<Box3d> boxes;
    for (int x = 0; x < 6; ++x)
        for (int y = 0; y < 6; ++y) {
            Box3d box;
            box.min = {double(x), double(y), 0};
            box.max = {x + 1.0, y + 1.0, 0};
            boxes.insert(boxes.end(), 3, box);
        }
    const BoxTree tree(boxes);
    for (const Box3d& box : boxes) EXPECT_EQ(tree.touching(box), touching_one_by_one(boxes, box));
    EXPECT_TRUE(BoxTree().touching(boxes.front()).empty());
    EXPECT_TRUE(tree.touching(Box3d()).empty());
}

// Far fewer boxes are looked at than there are: a lookup of a hundred thousand small ones takes microseconds.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(BoxTree, PCM_NOT_UNDER_THREAD(ALookupVisitsFewNodes))
{
    std::mt19937 random(3);
    std::vector<Box3d> boxes;
    for (int i = 0; i < 100000; ++i) boxes.push_back(box_at(random, 100, 0.5));
    const BoxTree tree(boxes);
    std::size_t found = 0;
    for (const Box3d& box : boxes) found += tree.touching(box).size();  // 10^10 tests one by one: minutes
    EXPECT_GE(found, boxes.size());
}

}  // namespace
}  // namespace pcm
