// A random selection of a random cloud against a loop over its points.
#include "pcm/io/pipe/selected_reader.h"

#include "tests/memory_reader.h"
#include "tests/support.h"

namespace {

using namespace pcm;
using namespace pcm::test;

const Grid grid{{0.01, 0.01, 0.01}, {1000, 2000, 0}};

Selection where(const std::vector<std::string>& conditions)
{
    Selection selection;
    for (const std::string& text : conditions) selection.where.push_back(parse_condition(text));
    return selection;
}

Schema mixed_schema()
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    schema.add({"rgb", ScalarType::u8, 3, 1, 0, ""});
    schema.add({"time", ScalarType::f64, 1, 1, 0, ""});
    schema.add({"odd", ScalarType::i32, 5, 1, 0, ""});
    return schema;
}

class SelectedReaderTest : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(GriddedOrNot, SelectedReaderTest, testing::Bool());

TEST_P(SelectedReaderTest, SelectsWhatALoopSelects)
{
    std::mt19937_64 random(4);
    for (int round = 0; round < 40; ++round) {
        const MemoryCloud cloud =
            random_cloud(mixed_schema(), GetParam() ? std::optional<Grid>(grid) : std::nullopt, 3000, random(), 100);
        Selection selection = where({"intensity>=20000", "rgb[1]!=0..50,255", "time<5e5"});
        selection.where.resize(random() % 4);
        if (random() % 2) {
            selection.box.emplace();
            selection.box->extend(
                position_of(cloud.points, cloud.info.grid, random() % 3000));  // closed: its corners are points
            selection.box->extend(position_of(cloud.points, cloud.info.grid, random() % 3000));
        }
        const double x = position_of(cloud.points, cloud.info.grid, 7)[0];
        if (random() % 2) selection.where.push_back(parse_condition("x<=" + std::to_string(x)));
        if (round % 3 == 1) selection.keep = {"odd", "intensity"};
        if (round % 3 == 2) selection.drop = {"rgb"};

        const auto column = [&](std::size_t k) -> const Column& { return cloud.points.attributes[k]; };
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < cloud.points.size; ++i) {
            const Vec3d p = position_of(cloud.points, cloud.info.grid, i);
            bool wanted = !selection.box || selection.box->contains(p);
            for (const Condition& condition : selection.where) {
                if (condition.name == "intensity") wanted = wanted && column(0).value(i) >= 20000;
                if (condition.name == "rgb[1]")
                    wanted = wanted && column(1).value(i, 1) > 50 && column(1).value(i, 1) != 255;
                if (condition.name == "time") wanted = wanted && column(2).value(i) < 5e5;
                if (condition.name == "x") wanted = wanted && p[0] <= std::stod(std::to_string(x));
            }
            if (wanted) expected.push_back(i);
        }
        SelectedReader reader(std::make_unique<MemoryReader>(cloud), selection);
        EXPECT_EQ(reader.info().points_known, !selection.chooses_points());
        EXPECT_EQ(reader.seekable(), !selection.chooses_points());
        const MemoryCloud result = read_all(reader, 1 + random() % 500);
        EXPECT_EQ(reader.points_seen(), cloud.points.size);
        std::vector<std::string> names;
        for (const Attribute& attribute : result.info.schema) names.push_back(attribute.name);
        EXPECT_EQ(names, round % 3 == 1   ? (std::vector<std::string>{"intensity", "odd"})
                         : round % 3 == 2 ? (std::vector<std::string>{"intensity", "time", "odd"})
                                          : (std::vector<std::string>{"intensity", "rgb", "time", "odd"}));
        ASSERT_EQ(result.points.size, expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            ASSERT_EQ(position_of(result.points, result.info.grid, i),
                      position_of(cloud.points, cloud.info.grid, expected[i]));
            for (std::size_t k = 0; k < names.size(); ++k)
                ASSERT_EQ(bytes_of(result.points.attributes[k], i),
                          bytes_of(column(*cloud.info.schema.find(names[k])), expected[i]));
        }
    }
}

TEST(SelectedReader, AnAttributeCalledXIsMeantInQuotesAlone)
{
    Schema schema;
    schema.add({"x", ScalarType::u8, 1, 1, 0, ""});
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 10, 1);
    cloud.points.attributes[0].as<std::uint8_t>()[3] = 77;
    for (std::size_t i = 0; i < 10; ++i)
        if (i != 3) cloud.points.attributes[0].as<std::uint8_t>()[i] = 0;
    SelectedReader reader(std::make_unique<MemoryReader>(cloud), where({"'x'=77"}));
    EXPECT_EQ(read_all(reader).points.size, 1u);
    EXPECT_THROW(SelectedReader(std::make_unique<MemoryReader>(cloud), where({"x=77"})), Error);
}

}  // namespace
