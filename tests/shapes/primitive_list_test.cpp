#include "pcm/shapes/primitive_list.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

Primitive made(ShapeKind kind, const std::string& name = {})
{
    Primitive primitive;
    primitive.fit.shape.kind = kind;
    primitive.name = name;
    return primitive;
}

std::vector<std::string> names(const PrimitiveList& list)
{
    std::vector<std::string> result;
    for (std::size_t i = 0; i < list.size(); ++i) result.push_back(list[i].name);
    return result;
}
using Names = std::vector<std::string>;

TEST(PrimitiveLists, NamesAreTheFirstFreeOnes)
{
    PrimitiveList list;
    EXPECT_EQ(list.add(made(ShapeKind::cylinder)), 0u);
    list.add(made(ShapeKind::plane));
    list.add_all({made(ShapeKind::cylinder, "Cylinder 3"), made(ShapeKind::cylinder), made(ShapeKind::cylinder)});
    EXPECT_EQ(names(list), (Names{"Cylinder 1", "Plane 1", "Cylinder 3", "Cylinder 2", "Cylinder 4"}));
    list.remove(3);
    EXPECT_EQ(list.add(made(ShapeKind::cylinder)), 4u);
    EXPECT_EQ(list[4].name, "Cylinder 2");
}

TEST(PrimitiveLists, EveryChangeIsOneStep)
{
    PrimitiveList list;
    EXPECT_FALSE(list.can_undo());
    list.add_all({made(ShapeKind::plane), made(ShapeKind::sphere), made(ShapeKind::torus)});
    list.rename(0, "floor");
    list.hide(1, true);
    list.replace(2, made(ShapeKind::cone, "roof"));
    list.remove(1);
    list.clear();
    list.clear();  // nothing to do: no step
    list.add_all({});
    const std::vector<Names> before{{"floor", "roof"},
                                    {"floor", "Sphere 1", "roof"},
                                    {"floor", "Sphere 1", "Torus 1"},
                                    {"floor", "Sphere 1", "Torus 1"},
                                    {"Plane 1", "Sphere 1", "Torus 1"},
                                    {}};
    for (const Names& expected : before) {
        ASSERT_TRUE(list.can_undo());
        list.undo();
        EXPECT_EQ(names(list), expected);
    }
    EXPECT_FALSE(list.can_undo());
    list.undo();
    for (std::size_t i = 5; i-- > 0;) {
        list.redo();
        EXPECT_EQ(names(list), before[i]);
    }
    EXPECT_TRUE(list.can_redo());
    list.undo();
    list.add(made(ShapeKind::plane));
    EXPECT_FALSE(list.can_redo());
}

TEST(PrimitiveLists, HidingIsUndone)
{
    PrimitiveList list;
    list.add(made(ShapeKind::plane));
    list.hide(0, true);
    EXPECT_TRUE(list.all()[0].hidden);
    list.undo();
    EXPECT_FALSE(list.at(0).hidden);
}

TEST(PrimitiveLists, WhatIsRefusedChangesNothing)
{
    PrimitiveList list;
    list.add(made(ShapeKind::plane));
    EXPECT_THROW(list.rename(1, "a"), Error);
    EXPECT_THROW(list.rename(0, ""), Error);
    EXPECT_THROW(list.rename(0, "a\nb"), Error);
    EXPECT_THROW(list.rename(0, std::string(1001, 'a')), Error);
    EXPECT_THROW(list.hide(1, true), Error);
    EXPECT_THROW(list.remove(1), Error);
    EXPECT_THROW(list.replace(1, made(ShapeKind::plane, "a")), Error);
    EXPECT_THROW(list.add_all({made(ShapeKind::plane), made(ShapeKind::plane, "a\tb")}), Error);
    try {
        list.at(4);
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "there is no primitive number 5; the list has 1");
    }
    EXPECT_EQ(names(list), Names{"Plane 1"});
    list.undo();
    EXPECT_FALSE(list.can_undo());
}

TEST(PrimitiveLists, TheLastThousandStepsAreKept)
{
    PrimitiveList list;
    list.add(made(ShapeKind::plane));
    for (int i = 0; i < 1500; ++i) list.rename(0, std::to_string(i));
    std::size_t steps = 0;
    for (; list.can_undo(); ++steps) list.undo();
    EXPECT_EQ(steps, 1000u);
    EXPECT_EQ(list[0].name, "499");
}

TEST(PrimitiveLists, ColoursDifferWhileThereAreAny)
{
    PrimitiveList list;
    std::set<std::array<std::uint8_t, 3>> colours;
    const auto add = [&] {
        Primitive primitive = made(ShapeKind::plane);
        primitive.colour = next_colour(list);
        list.add(primitive);
        return primitive.colour;
    };
    for (int i = 0; i < 8; ++i) colours.insert(add());
    EXPECT_EQ(colours.size(), 8u);
    const auto ninth = add();
    EXPECT_EQ(ninth, list[0].colour);
    const auto third = list[2].colour;
    list.remove(2);
    EXPECT_EQ(add(), third) << "the one that is free";
}

}  // namespace
}  // namespace pcm
