// Where labels stand.
#include "plugin/overlay/label_places.h"

#include <gtest/gtest.h>

using namespace pcm::host;

namespace {

const QSize view(400, 300);
const std::map<QString, QSize> sizes{{"a", {60, 20}}, {"b", {60, 20}}, {"c", {500, 20}}};

TEST(Labels, StandBesideTheirAnchorsInTheView)
{
    for (const QPointF& anchor :
         {QPointF(200, 150), QPointF(0, 0), QPointF(399, 299), QPointF(3, 299), QPointF(399, 2)}) {
        const auto placed = place_labels({{"a", anchor}}, sizes, view);
        ASSERT_EQ(placed.size(), 1u);
        EXPECT_TRUE(QRect(QPoint(0, 0), view).contains(placed[0].place));
        EXPECT_EQ(placed[0].place.size(), QSize(60, 20));
    }
    EXPECT_EQ(place_labels({{"a", QPointF(200, 150)}}, sizes, view)[0].place.topLeft(), QPoint(208, 158));
    EXPECT_EQ(place_labels({{"c", QPointF(200, 150)}}, sizes, view)[0].place.x(), 0) << "wider than the view";
}

TEST(Labels, DoNotCoverEachOtherWhereThatIsCheap)
{
    const auto placed = place_labels({{"a", QPointF(200, 150)}, {"b", QPointF(202, 151)}}, sizes, view);
    ASSERT_EQ(placed.size(), 2u);
    EXPECT_FALSE(placed[0].place.intersects(placed[1].place));
}

TEST(Labels, OfOnePlaceStandInRows)
{
    const std::vector<std::pair<QString, QPointF>> anchors(12, {"a", QPointF(200, 150)});
    const auto placed = place_labels(anchors, sizes, view);
    for (std::size_t i = 0; i < placed.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(placed[i].place.intersects(placed[k].place)) << i << " " << k;
}

TEST(Labels, OfAnchorsOutOfViewAreNotThere)
{
    EXPECT_TRUE(place_labels({{"a", QPointF(-1, 10)}, {"b", QPointF(10, 301)}}, sizes, view).empty());
}

}  // namespace
