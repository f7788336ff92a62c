// The measure that is being made: clicks and late answers.
#include "plugin/tools/measure/draft.h"

#include <gtest/gtest.h>

using namespace pcm;
using namespace pcm::host;

namespace {

MeasuredPoint at(double x)
{
    MeasuredPoint point;
    point.position = {x, 2 * x, 0};
    return point;
}

std::vector<double> xs(const Draft& draft)
{
    std::vector<double> found;
    for (const MeasuredPoint& point : draft.points()) found.push_back(point.position[0]);
    return found;
}

TEST(MeasureDraft, PointsStandInTheOrderOfTheClicksWhateverTheAnswersDo)
{
    Draft draft(MeasureKind::distance);
    const int a = *draft.click(), b = *draft.click(), c = *draft.click();
    draft.answer(c, at(3), true);
    draft.answer(a, at(9), false);
    draft.answer(a, at(1), true);
    EXPECT_EQ(xs(draft), (std::vector<double>{1, 3}));
    EXPECT_EQ(draft.end(), "");
    EXPECT_FALSE(draft.complete());
    draft.answer(b, at(2), false);
    EXPECT_FALSE(draft.complete()) << "it may still change";
    draft.answer(b, at(2), true);
    EXPECT_TRUE(draft.complete());
    EXPECT_EQ(xs(draft), (std::vector<double>{1, 2, 3}));
}

TEST(MeasureDraft, AMeasureOfSoManyPointsTakesNoMore)
{
    Draft draft(MeasureKind::angle);
    for (int i = 0; i < 3; ++i) {
        EXPECT_FALSE(draft.is_full());
        draft.answer(*draft.click(), at(i), true);
        EXPECT_EQ(draft.complete(), i == 2);
    }
    EXPECT_TRUE(draft.is_full());
    EXPECT_FALSE(draft.click().has_value());
    draft.reopen();
    EXPECT_FALSE(draft.complete());
    EXPECT_EQ(xs(draft), (std::vector<double>{0, 1}));
}

TEST(MeasureDraft, TooFewPointsCannotBeEnded)
{
    Draft draft(MeasureKind::area);
    draft.answer(*draft.click(), at(1), true);
    draft.answer(*draft.click(), at(2), true);
    EXPECT_TRUE(draft.end().contains("2 of at least 3")) << draft.end().toStdString();
    EXPECT_TRUE(draft.click().has_value());
}

TEST(MeasureDraft, AClickBesideTheCloudTakesNoPlace)
{
    Draft draft(MeasureKind::distance);
    const int a = *draft.click(), b = *draft.click();
    draft.answer(a, at(1), true);
    EXPECT_EQ(draft.end(), "");
    draft.miss(b);
    EXPECT_FALSE(draft.complete()) << "ended with one point";
    draft.answer(*draft.click(), at(2), true);
    EXPECT_EQ(draft.end(), "");
    EXPECT_TRUE(draft.complete());
    draft.miss(77);
    EXPECT_TRUE(draft.complete());
}

TEST(MeasureDraft, WhatIsTakenBackIsNotAnsweredAnyMore)
{
    Draft draft(MeasureKind::distance);
    const int a = *draft.click(), b = *draft.click();
    EXPECT_TRUE(draft.take_back());
    draft.answer(b, at(2), true);
    draft.answer(a, at(1), true);
    EXPECT_EQ(xs(draft), (std::vector<double>{1}));
    EXPECT_TRUE(draft.take_back());
    EXPECT_FALSE(draft.take_back());
    EXPECT_TRUE(draft.empty());
    const int c = *draft.click();
    EXPECT_NE(c, a);
    EXPECT_NE(c, b);
    draft.clear();
    draft.answer(c, at(3), true);
    EXPECT_TRUE(draft.empty());
}

}  // namespace
