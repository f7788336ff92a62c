#include "pcm/update/fitted_reader.h"

#include "pcm/system/error.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

const Grid grid{{0.01, 0.01, 0.01}, {1000, 2000, -50}};

Schema schema_of(const std::vector<Attribute>& attributes)
{
    Schema schema;
    for (const Attribute& attribute : attributes) schema.add(attribute);
    return schema;
}

const Attribute intensity{"intensity", ScalarType::u16, 1, 1, 0, ""}, angle{"angle", ScalarType::i16, 1, 0.006, 0, ""},
    rgb{"rgb", ScalarType::u8, 3, 1, 0, ""};

TreeInfo tree_of(const Schema& schema)
{
    TreeInfo tree;
    tree.grid = grid;
    tree.position_type = ScalarType::i32;
    tree.schema = schema;
    return tree;
}

MemoryCloud read_fitted(const MemoryCloud& cloud, const TreeInfo& tree)
{
    MemoryReader reader(cloud);
    FittedReader fitted(reader, tree, "tree.pct");
    return read_all(fitted);
}

std::string refusal(const MemoryCloud& cloud, const TreeInfo& tree)
{
    try {
        read_fitted(cloud, tree);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "";
}

TEST(FittedReader, WhatFitsPassesThrough)
{
    const Schema schema = schema_of({intensity, rgb});
    const MemoryCloud cloud = random_cloud(schema, grid, 5000, 1);
    const MemoryCloud fitted = read_fitted(cloud, tree_of(schema));
    EXPECT_EQ(fitted.points.grid_xyz, cloud.points.grid_xyz);
    for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t i = 0; i < 5000; ++i)
            ASSERT_EQ(bytes_of(fitted.points.attributes[k], i), bytes_of(cloud.points.attributes[k], i));
}

TEST(FittedReader, AttributesComeInTheTreesOrderAndMissingOnesAreZero)
{
    const MemoryCloud cloud = random_cloud(schema_of({rgb, intensity}), grid, 3000, 2);
    const MemoryCloud fitted = read_fitted(cloud, tree_of(schema_of({angle, intensity, rgb})));
    ASSERT_EQ(fitted.points.attributes.size(), 3u);
    for (std::size_t i = 0; i < 3000; ++i) {
        ASSERT_EQ(fitted.points.attributes[0].value(i), 0.0);
        ASSERT_EQ(bytes_of(fitted.points.attributes[1], i), bytes_of(cloud.points.attributes[1], i));
        ASSERT_EQ(bytes_of(fitted.points.attributes[2], i), bytes_of(cloud.points.attributes[0], i));
    }
    ASSERT_EQ(fitted.info.notes.size(), 1u);
    EXPECT_NE(fitted.info.notes[0].find("angle"), std::string::npos);
}

TEST(FittedReader, RefusesOtherAttributes)
{
    const MemoryCloud cloud = random_cloud(schema_of({intensity, angle}), grid, 10, 3);
    EXPECT_NE(refusal(cloud, tree_of(schema_of({intensity}))).find("'angle'"), std::string::npos);
    Attribute other = angle;
    other.scale = 0.01;
    EXPECT_NE(
        refusal(cloud, tree_of(schema_of({intensity, other}))).find("i16 times 0.006, the tree's is i16 times 0.01"),
        std::string::npos);
}

// Tiles of one survey: the same step, offsets whole steps apart. The rounding of q * scale + offset differs in the last
// bits.
TEST(FittedReader, AnotherOffsetWholeStepsAway)
{
    const Grid other{grid.scale, {1500, 1000, 0}};
    const MemoryCloud cloud = random_cloud({}, other, 4000, 4);
    MemoryReader reader(cloud);
    const TreeInfo tree = tree_of({});
    FittedReader fitted(reader, tree, "tree.pct");
    const MemoryCloud out = read_all(fitted);
    ASSERT_EQ(out.points.size, cloud.points.size);
    for (std::size_t i = 0; i < out.points.size; ++i) {
        EXPECT_EQ(out.points.grid_xyz[0][i], cloud.points.grid_xyz[0][i] + 50000);
        EXPECT_EQ(out.points.grid_xyz[1][i], cloud.points.grid_xyz[1][i] - 100000);
        EXPECT_EQ(out.points.grid_xyz[2][i], cloud.points.grid_xyz[2][i] + 5000);
    }
    EXPECT_LT(fitted.position_error(), 1e-12);
}

// Offsets that are much larger than the coordinates: what cancels in q * scale + offset leaves rounding of its own.
TEST(FittedReader, OffsetsFarFromTheCoordinates)
{
    std::mt19937_64 random(4);
    const double offsets[] = {0, 1000, 123456.78, -7654321.12, 9e6, 1.2e7}, steps[] = {0.01, 0.001, 0.00025};
    for (const double step : steps)
        for (const double of_tree : offsets)
            for (const double of_file : offsets) {
                if (std::fabs(of_file - of_tree) / step > 2e9) continue;
                TreeInfo tree = tree_of(schema_of({intensity}));
                tree.grid = {{step, step, step}, {of_tree, of_tree, of_tree}};
                const Grid from{tree.grid.scale, {of_file, of_file, of_file}};
                MemoryCloud cloud = random_cloud(schema_of({intensity}), from, 2000, 6);
                const auto apart = static_cast<std::int64_t>(std::llround((of_file - of_tree) / step));
                std::vector<std::int64_t> expected;
                for (auto& q : cloud.points.grid_xyz[0]) {
                    const auto near = static_cast<std::int64_t>(random() % 6000);  // relative to the tree's offset
                    q = static_cast<std::int32_t>(near - apart);
                    expected.push_back(near);
                }
                for (std::size_t axis : {1, 2}) cloud.points.grid_xyz[axis] = cloud.points.grid_xyz[0];
                MemoryCloud fitted;
                ASSERT_NO_THROW(fitted = read_fitted(cloud, tree)) << step << " " << of_tree << " " << of_file;
                for (std::size_t i = 0; i < expected.size(); ++i)
                    ASSERT_EQ(fitted.points.grid_xyz[0][i], expected[i]) << step << " " << of_tree << " " << of_file;
            }
}

TEST(FittedReader, RefusesPositionsBetweenTheSteps)
{
    MemoryCloud cloud = random_cloud({}, std::nullopt, 100, 5);
    for (std::size_t i = 0; i < 100; ++i)
        for (std::size_t a = 0; a < 3; ++a)
            cloud.points.xyz[a][i] = grid.to_source(static_cast<std::int64_t>(100 * i), a);
    EXPECT_EQ(refusal(cloud, tree_of({})), "");
    cloud.points.xyz[1][50] += 0.002;
    cloud.points.xyz[2][70] += 0.004;
    const std::string text = refusal(cloud, tree_of({}));
    EXPECT_NE(text.find("2 of the 100 new points"), std::string::npos) << text;
    EXPECT_NE(text.find("up to 0.004 away"), std::string::npos) << text;
    EXPECT_NE(text.find("--scale 0.01 0.01 0.01 --offset 1000 2000 -50"), std::string::npos) << text;
    cloud.points.xyz[1][50] = 1e9;
    EXPECT_NE(refusal(cloud, tree_of({})).find("beyond its range"), std::string::npos);
}

TEST(FittedReader, LeavesOutWhatIsNotFinite)
{
    MemoryCloud cloud = random_cloud(schema_of({intensity}), std::nullopt, 10, 6);
    for (std::size_t i = 0; i < 10; ++i)
        for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][i] = grid.to_source(static_cast<std::int64_t>(i), a);
    cloud.points.xyz[0][3] = std::numeric_limits<double>::quiet_NaN();
    cloud.points.xyz[2][9] = std::numeric_limits<double>::infinity();
    const TreeInfo tree = tree_of(schema_of({intensity}));
    MemoryReader reader(cloud);
    FittedReader fitted(reader, tree, "tree.pct");
    const MemoryCloud out = read_all(fitted);
    ASSERT_EQ(out.points.size, 8u);
    EXPECT_EQ(out.points.grid_xyz[1][3], 4);
    EXPECT_EQ(bytes_of(out.points.attributes[0], 3), bytes_of(cloud.points.attributes[0], 4));
    EXPECT_EQ(fitted.points_skipped(), 2u);
}

// On the grid of a build from floats a position is moved by half a step at most, which is much less than a float's
// resolution.
TEST(FittedReader, FloatsOnAFineGrid)
{
    TreeInfo tree;
    for (double& s : tree.grid.scale) s = std::ldexp(1.0, 10 - 61);
    tree.wide = true;
    tree.position_type = ScalarType::f64;
    const MemoryCloud cloud = random_cloud({}, std::nullopt, 1000, 7);
    MemoryReader reader(cloud);
    FittedReader fitted(reader, tree, "tree.pct");
    const MemoryCloud out = read_all(fitted);
    EXPECT_EQ(out.points.xyz, cloud.points.xyz);
    EXPECT_LE(fitted.position_error(), tree.grid.scale[0] / 2);
    MemoryCloud far = random_cloud({}, std::nullopt, 3, 8);
    far.points.xyz[0][1] = 3000;
    EXPECT_NE(refusal(far, tree).find("beyond its range"), std::string::npos);
}

}  // namespace
