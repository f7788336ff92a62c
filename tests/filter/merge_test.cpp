#include "pcm/filter/merge.h"

#include "pcm/filter/common_grid.h"
#include "pcm/filter/common_schema.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"

#include "tests/columns.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

Metadata crs(const std::string& text)
{
    Metadata block{crs_comment, {}};
    block.value.resize(text.size());
    std::memcpy(block.value.data(), text.data(), text.size());
    return block;
}

class Merge : public testing::Test {
protected:
    fs::path tree_of(const std::string& name, const MemoryCloud& cloud)
    {
        BuildOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = 1000;
        MemoryReader reader(cloud);
        build_tree(reader, {name}, folder_ / name, options);
        return folder_ / name;
    }
    MergeReport merge(const std::vector<MergeInput>& inputs, const MergeOptions& options = {})
    {
        ResultOptions result;
        result.target.copy = folder_ / "merged.pct";
        result.target.overwrite = true;
        result.memory_bytes = 64 << 20;
        return merge_trees(inputs, options, result);
    }
    MemoryCloud merged() { return points_of(folder_ / "merged.pct"); }
    static MemoryCloud points_of(const fs::path& path)
    {
        TreeReader reader(Tree::open(path), std::nullopt, {});
        return read_all(reader);
    }
    std::string message_of(const std::vector<MergeInput>& inputs)
    {
        try {
            merge(inputs);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            return error.what();
        }
        return "accepted";
    }
    TemporaryFolder folder_;
};

Schema schema_of(std::vector<Attribute> attributes)
{
    Schema schema;
    for (const Attribute& attribute : attributes) schema.add(attribute);
    return schema;
}

std::string all_notes(const MergeReport& report)
{
    std::string text;
    for (const std::string& note : report.build.notes) text += note + "\n";
    return text;
}

// Positions and the named attribute, sorted.
std::vector<std::array<double, 4>> values_of(const MemoryCloud& cloud, const std::string& attribute)
{
    const auto k = cloud.info.schema.find(attribute);
    std::vector<std::array<double, 4>> rows;
    for (std::size_t i = 0; i < cloud.points.size; ++i) {
        const Vec3d p = position_of(cloud.points, cloud.info.grid, i);
        rows.push_back({p[0], p[1], p[2], k ? cloud.points.attributes[*k].value(i) : 0});
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

template <class T>
std::vector<T> together(std::vector<T> a, const std::vector<T>& b)
{
    a.insert(a.end(), b.begin(), b.end());
    std::sort(a.begin(), a.end());
    return a;
}

void expect_near(const std::vector<std::array<double, 4>>& found, const std::vector<std::array<double, 4>>& expected,
                 double tolerance)
{
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(found[i][k], expected[i][k], tolerance) << i;
}

const Attribute intensity{"intensity", ScalarType::u16, 1, 1, 0, {}};

TEST_F(Merge, TreesOnOneGridStayAsTheyAre)
{
    const Grid grid{{0.001, 0.001, 0.002}, {5e5, 4.8e6, 0}};
    const MemoryCloud one = random_cloud(schema_of({intensity}), grid, 5000, 1, 10);
    const MemoryCloud two = random_cloud(schema_of({intensity}), grid, 3000, 2, 10);
    const MergeReport report = merge({{tree_of("a.pct", one), {}}, {tree_of("b.pct", two), {}}});
    EXPECT_EQ(report.grid, grid);
    EXPECT_EQ(report.rounding, 0);
    EXPECT_EQ(report.build.outcome.points_in, 8000u);
    EXPECT_EQ(report.build.outcome.points_out, 8000u);
    EXPECT_TRUE(report.build.notes.empty()) << all_notes(report);
    const auto tree = Tree::open(folder_ / "merged.pct");
    EXPECT_EQ(tree->info().grid, grid);
    EXPECT_EQ(tree->info().sources, (std::vector<std::string>{"a.pct", "b.pct"}));
    EXPECT_EQ(values_of(merged(), "intensity"), together(values_of(one, "intensity"), values_of(two, "intensity")));
}

// A centimetre grid and a millimetre grid, at offsets whole millimetres apart.
TEST_F(Merge, GridsThatFitTogetherBecomeTheFinest)
{
    const Grid coarse{{0.01, 0.01, 0.01}, {500000.3, 4800000, 7}}, fine{{0.001, 0.001, 0.001}, {499000.005, 4.8e6, 0}};
    const MemoryCloud one = random_cloud(schema_of({intensity}), coarse, 5000, 1, 10);
    const MemoryCloud two = random_cloud(schema_of({intensity}), fine, 3000, 2, 10);
    const MergeReport report = merge({{tree_of("a.pct", one), {}}, {tree_of("b.pct", two), {}}});
    EXPECT_EQ(report.grid, fine);
    EXPECT_GT(report.rounding, 0);
    EXPECT_LT(report.rounding, 2e-9);  // a bit or two of millions
    EXPECT_NE(all_notes(report).find("all are put on that of b.pct"), std::string::npos) << all_notes(report);
    EXPECT_EQ(Tree::open(folder_ / "merged.pct")->info().position_type, ScalarType::i32);
    const auto found = values_of(merged(), "intensity");
    const auto expected = together(values_of(one, "intensity"), values_of(two, "intensity"));
    ASSERT_EQ(found.size(), expected.size());
    double most = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) most = std::max(most, std::fabs(found[i][a] - expected[i][a]));
    EXPECT_EQ(most, report.rounding);
}

TEST_F(Merge, GridsThatDoNotFitBecomeDoubles)
{
    const Grid one_grid{{0.01, 0.01, 0.01}, {5e5, 4.8e6, 7}};
    const MemoryCloud one = random_cloud(schema_of({intensity}), one_grid, 2000, 1, 10);
    for (const Grid& grid :
         {Grid{{0.007, 0.007, 0.007}, {5e5, 4.8e6, 0}}, Grid{{0.01, 0.01, 0.01}, {5e5, 4.8e6, 7.004}},
          Grid{{0.01, 0.01, 0.01}, {5e9, 4.8e6, 7}}}) {
        fs::remove_all(folder_ / "a.pct");
        fs::remove_all(folder_ / "b.pct");
        const MemoryCloud two = random_cloud(schema_of({intensity}), grid, 3000, 2, 10);
        const MergeReport report = merge({{tree_of("a.pct", one), {}}, {tree_of("b.pct", two), {}}});
        EXPECT_FALSE(report.grid);
        const double tolerance = grid.offset[0] > 1e9 ? 1e-6 : 1e-14;
        EXPECT_LE(report.rounding, tolerance);
        EXPECT_NE(all_notes(report).find("become doubles"), std::string::npos) << all_notes(report);
        expect_near(values_of(merged(), "intensity"),
                    together(values_of(one, "intensity"), values_of(two, "intensity")), tolerance);
    }
}

TEST(CommonGrid, HoldsAllPositionsOrIsRefused)
{
    const Box3i box{{-1000, -1000, -1000}, {1000, 1000, 1000}}, wide{{0, 0, 0}, {2147483647, 10, 10}};
    const Grid one{{0.1, 0.1, 0.1}, {0, 0, 0}}, tenth{{0.01, 0.1, 0.1}, {3, 0, 0}};
    auto common = common_grid({{one, box}, {tenth, box}});
    ASSERT_TRUE(common);
    EXPECT_EQ(common->like, 1u);
    EXPECT_EQ(common->maps[0]({5, 6, 7}), (Vec3i{50 - 300, 6, 7}));
    EXPECT_EQ(common->maps[1]({5, 6, 7}), (Vec3i{5, 6, 7}));
    EXPECT_FALSE(common_grid({{one, wide}, {tenth, box}}));  // ten times as many steps
    EXPECT_TRUE(common_grid({{one, wide}, {one, box}}));
    EXPECT_FALSE(common_grid({{{{0.1, 1, 1}, {0, 0, 0}}, box}, {{{1, 0.1, 1}, {0, 0, 0}}, box}}));  // neither is finest
    EXPECT_FALSE(common_grid({{one, box}, {{{0.1000001, 0.1, 0.1}, {0, 0, 0}}, box}}));
    EXPECT_TRUE(common_grid({{one, Box3i()}, {one, Box3i()}}));
}

TEST_F(Merge, AttributesOfOneNameGetOneType)
{
    const Schema first =
        schema_of({intensity, {"rgb", ScalarType::u8, 3, 1, 0, {}}, {"class", ScalarType::u8, 1, 1, 0, {}}});
    const Schema second = schema_of({{"class", ScalarType::i16, 1, 1, 0, {}},
                                     {"rgb", ScalarType::u16, 3, 1, 0, {}},
                                     {"heat", ScalarType::f32, 1, 1, 0, {}}});
    const MemoryCloud one = random_cloud(first, std::nullopt, 500, 1, 10);
    const MemoryCloud two = random_cloud(second, std::nullopt, 300, 2, 10);
    MergeOptions options;
    options.source_id = true;
    const MergeReport report = merge({{tree_of("a.pct", one), {}}, {tree_of("b.pct", two), {}}}, options);
    const MemoryCloud all = merged();
    const std::string notes = all_notes(report);
    EXPECT_NE(notes.find("'class' has different types or scales (u8, i16); it is i16"), std::string::npos) << notes;
    EXPECT_NE(notes.find("'rgb' has different types or scales (u8, u16); it is u16"), std::string::npos) << notes;
    EXPECT_NE(notes.find("'heat' is not in 1 of 2"), std::string::npos) << notes;
    EXPECT_NE(notes.find("source_id 2: b.pct"), std::string::npos) << notes;
    const Schema& schema = all.info.schema;
    ASSERT_EQ(schema.size(), 5u);
    EXPECT_EQ(schema[*schema.find("source_id")].type, ScalarType::u16);
    EXPECT_EQ(schema[*schema.find("class")].type, ScalarType::i16);
    for (const bool is_second : {false, true}) {
        const MemoryCloud& from = is_second ? two : one;
        for (std::size_t i = 0; i < from.points.size; ++i) {
            // Positions are all different.
            const auto& x = all.points.xyz[0];
            const auto at = static_cast<std::size_t>(std::find(x.begin(), x.end(), from.points.xyz[0][i]) - x.begin());
            ASSERT_LT(at, x.size());
            const auto value = [&](const char* name, std::uint32_t c = 0) {
                return all.points.attributes[*schema.find(name)].value(at, c);
            };
            const auto expected = [&](const char* name, std::uint32_t c = 0) {
                const auto k = from.info.schema.find(name);
                return k ? from.points.attributes[*k].value(i, c) : 0;
            };
            for (const char* name : {"intensity", "class", "heat"}) ASSERT_EQ(value(name), expected(name)) << name;
            for (std::uint32_t c = 0; c < 3; ++c)
                ASSERT_EQ(value("rgb", c), expected("rgb", c) * (is_second ? 1 : 257));
            ASSERT_EQ(value("source_id"), is_second ? 2 : 1);
        }
    }
}

TEST(CommonSchemas, TheSmallestTypeThatHoldsAll)
{
    const auto type_of = [](ScalarType a, ScalarType b) {
        const auto common = common_schemas({schema_of({{"x", a, 2, 1, 0, {}}}), schema_of({{"x", b, 2, 1, 0, {}}})});
        EXPECT_EQ(common.schemas[0], common.schemas[1]);
        EXPECT_EQ(common.notes.size(), a == b ? 0u : 1u);
        return common.schemas[0][0].type;
    };
    using S = ScalarType;
    EXPECT_EQ(type_of(S::u8, S::u8), S::u8);
    EXPECT_EQ(type_of(S::u8, S::i8), S::i16);
    EXPECT_EQ(type_of(S::u16, S::u8), S::u16);
    EXPECT_EQ(type_of(S::u16, S::i32), S::i32);
    EXPECT_EQ(type_of(S::u32, S::i8), S::i64);
    EXPECT_EQ(type_of(S::u64, S::i8), S::f64);
    EXPECT_EQ(type_of(S::u16, S::f32), S::f32);
    EXPECT_EQ(type_of(S::i32, S::f32), S::f64);
    EXPECT_EQ(type_of(S::f64, S::f32), S::f64);
    // Scales and offsets: the values count.
    const Attribute angle{"angle", S::i16, 1, 0.006, 2, {}}, rank{"angle", S::i8, 1, 1, 0, {}};
    const auto common = common_schemas({schema_of({angle}), schema_of({rank})});
    EXPECT_EQ(common.schemas[0][0].type, S::f64);
    EXPECT_EQ(common.schemas[0][0].scale, 1);
    Column converted;
    convert_column(angle, column_of<std::int16_t>(S::i16, 1, {1000, -500}), common.schemas[0][0], converted);
    EXPECT_EQ(converted.as<double>()[0], 1000 * 0.006 + 2);
    EXPECT_EQ(converted.as<double>()[1], -500 * 0.006 + 2);
    // Others are kept apart, by their number of components.
    EXPECT_TRUE(common_schemas({schema_of({{"x", S::u8, 2, 1, 0, {}}}), schema_of({{"x", S::u16, 3, 1, 0, {}}})})
                    .notes.empty());
    const Attribute colours{"rgb", S::f32, 3, 1, 0, {}}, bits{"rgb", S::u16, 3, 1, 0, {}};
    convert_column(colours, column_of<float>(S::f32, 3, {0, 0.5f, 1, 2, -1, std::numeric_limits<float>::quiet_NaN()}),
                   bits, converted);
    const std::uint16_t expected[] = {0, 32768, 65535, 65535, 0, 0};
    EXPECT_TRUE(std::equal(expected, expected + 6, converted.as<std::uint16_t>()));
}

TEST_F(Merge, SystemsThatDifferAreRefusedByName)
{
    MemoryCloud one = random_cloud({}, std::nullopt, 100, 1, 10), two = one, none = one;
    one.info.metadata = {crs("EPSG:26915")};
    two.info.metadata = {crs("EPSG:32633")};
    const fs::path a = tree_of("a.pct", one), b = tree_of("b.pct", two), c = tree_of("c.pct", none);
    const std::string refused = message_of({{a, {}}, {b, {}}});
    for (const char* word : {"a.pct", "b.pct", "26915", "32633"})
        EXPECT_NE(refused.find(word), std::string::npos) << refused;
    EXPECT_FALSE(fs::exists(folder_ / "merged.pct"));
    MergeOptions options;
    options.ignore_crs = true;
    EXPECT_NE(merge({{a, {}}, {b, {}}}, options).system.find("26915"), std::string::npos);
    const MergeReport report = merge({{c, {}}, {b, {}}});
    EXPECT_NE(report.system.find("32633"), std::string::npos);
    EXPECT_NE(all_notes(report).find("no coordinate system is stated"), std::string::npos) << all_notes(report);
    EXPECT_EQ(merge({{c, {}}}).system, "");
}

TEST_F(Merge, TreesAtOtherPlaces)
{
    const Grid grid{{0.001, 0.001, 0.001}, {5e5, 4.8e6, 0}};
    const MemoryCloud one = random_cloud(schema_of({intensity}), grid, 500, 1, 10);
    const MemoryCloud two = random_cloud(schema_of({intensity}), grid, 300, 2, 10);
    const fs::path a = tree_of("a.pct", one), b = tree_of("b.pct", two);
    // A shift by whole steps keeps the grid.
    const Affine shift = Affine::translation({3, 0, -0.5});
    const MergeReport shifted = merge({{a, {}}, {b, shift}});
    EXPECT_EQ(shifted.grid, grid);
    const Affine turn = Affine::rotation({0, 0, 1}, 0.3, {5e5, 4.8e6, 0});
    for (const Affine& map : {shift, turn}) {
        const MergeReport report = merge({{a, {}}, {b, map}});
        TransformedReader moved(std::make_unique<TreeReader>(Tree::open(b), std::nullopt, Selection()), map);
        const auto expected = together(values_of(one, "intensity"), values_of(read_all(moved), "intensity"));
        expect_near(values_of(merged(), "intensity"), expected, 1e-9);
    }
    // The same tree twice: at the same place once, at another place again.
    EXPECT_EQ(merge({{a, {}}, {a / "index.pct", {}}}).build.outcome.points_out, 500u);
    EXPECT_EQ(merge({{a, {}}, {a, shift}, {a, shift}}).build.outcome.points_out, 1000u);
    EXPECT_NE(all_notes(merge({{a, {}}, {a, {}}})).find("named more than once"), std::string::npos);
}

// A merge of merges: what says where points came from before keeps its name, and the new numbers have another.
TEST_F(Merge, TheNumberOfTheTreeHasANameThatNoTreeHas)
{
    const Grid grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
    const Attribute before{"source_id", ScalarType::u16, 1, 1, 0, {}};
    const MemoryCloud one = random_cloud(schema_of({intensity, before}), grid, 500, 1, 10);
    const MemoryCloud two = random_cloud(schema_of({intensity}), grid, 300, 2, 10);
    const fs::path a = tree_of("a.pct", one), b = tree_of("b.pct", two);
    MergeOptions options;
    options.source_id = true;
    for (const bool first : {true, false}) {
        merge(first ? std::vector<MergeInput>{{a, {}}, {b, {}}} : std::vector<MergeInput>{{b, {}}, {a, {}}}, options);
        const MemoryCloud all = merged();
        const Schema& schema = all.info.schema;
        ASSERT_EQ(schema.size(), 3u);
        const std::size_t old = *schema.find("source_id");
        std::size_t number = 0;
        while (schema[number].description != "number of the merged tree, from 1") ASSERT_LT(++number, schema.size());
        EXPECT_NE(schema[number].name, "source_id");
        const auto numbers = values_of(all, schema[number].name);
        EXPECT_EQ(std::count_if(numbers.begin(), numbers.end(), [](const auto& row) { return row[3] == 1; }),
                  first ? 500 : 300);
        EXPECT_EQ(std::count_if(numbers.begin(), numbers.end(), [](const auto& row) { return row[3] == 2; }),
                  first ? 300 : 500);
        // Every old number is still there; trees without one have 0.
        std::vector<std::array<double, 4>> expected = values_of(one, "source_id");
        for (std::array<double, 4> row : values_of(two, "")) {
            row[3] = 0;
            expected.push_back(row);
        }
        std::sort(expected.begin(), expected.end());
        EXPECT_EQ(values_of(all, schema[old].name), expected);
    }
}

TEST_F(Merge, RefusesWhatMakesNoSense)
{
    const fs::path a = tree_of("a.pct", random_cloud({}, std::nullopt, 100, 1, 10));
    EXPECT_NE(message_of({}).find("no trees"), std::string::npos);
    ResultOptions result;
    result.target.copy = a;
    result.target.overwrite = true;
    EXPECT_THROW(merge_trees({{a, {}}}, {}, result), Error);
    EXPECT_EQ(Tree::open(a)->info().points, 100u);
    result.target = {"", true};
    EXPECT_THROW(merge_trees({{a, {}}}, {}, result), Error);
    Affine flat;
    flat.linear[2] = {0, 0, 0};
    EXPECT_NE(message_of({{a, flat}}).find("flattens"), std::string::npos);
    EXPECT_THROW(merge({{folder_ / "none.pct", {}}}), Error);
    EXPECT_FALSE(fs::exists(folder_ / "merged.pct"));
    // Empty trees are trees.
    const fs::path empty = tree_of("empty.pct", random_cloud({}, std::nullopt, 0, 1, 10));
    EXPECT_EQ(merge({{empty, {}}}).build.outcome.points_out, 0u);
    EXPECT_EQ(merge({{empty, {}}, {a, {}}}).build.outcome.points_out, 100u);
}

}  // namespace
