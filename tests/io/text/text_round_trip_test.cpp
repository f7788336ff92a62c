// Text files read back as written: every position bit for bit or as the same place of its grid, every value, every
// name.
#include "pcm/io/pipe/grid_choice.h"
#include "tests/io/random_cloud.h"
#include "tests/io/text_lines.h"

namespace pcm::test {
namespace {

double user_value(const Attribute& attribute, const Column& column, std::size_t point, std::uint32_t component)
{
    const double raw = column.value(point, component);
    return attribute.scale == 1 && attribute.offset == 0 ? raw : raw * attribute.scale + attribute.offset;
}

void expect_same_cloud(const RandomCloud& cloud, const Whole& read, const std::vector<std::string>& attributes)
{
    ASSERT_EQ(read.points.size, cloud.points.size);
    const Whole written{cloud.info, cloud.points};
    for (std::size_t i = 0; i < cloud.points.size; ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            const double before = written.position(i)[a], after = read.position(i)[a];
            if (!cloud.info.grid)
                ASSERT_TRUE(same(after, before)) << i;
            else  // the decimal that the integer stands for
                ASSERT_EQ(nearest_on_grid(*cloud.info.grid, a, after), nearest_on_grid(*cloud.info.grid, a, before))
                    << i;
        }
    EXPECT_EQ(read.info.schema.size(), attributes.size());
    for (const std::string& name : attributes) {
        SCOPED_TRACE(name);
        const auto from = cloud.info.schema.find(name), to = read.info.schema.find(name);
        ASSERT_TRUE(from && to);
        const Attribute &a = cloud.info.schema[*from], &b = read.info.schema[*to];
        ASSERT_EQ(a.components, b.components);
        for (std::size_t i = 0; i < cloud.points.size; ++i)
            for (std::uint32_t k = 0; k < a.components; ++k) {
                const double before = user_value(a, cloud.points.attributes[*from], i, k);
                const double after = user_value(b, read.points.attributes[*to], i, k);
                // The shortest text of a float identifies the float, but reads as another double.
                if (a.type == ScalarType::f32 && a.scale == 1 && a.offset == 0)
                    ASSERT_EQ(static_cast<float>(after), static_cast<float>(before)) << i;
                else if (a.scale != 1)  // the decimal that the integer stands for
                    ASSERT_EQ(std::round(after / a.scale), std::round(before / a.scale)) << i;
                else
                    ASSERT_EQ(after, before) << i;
            }
    }
}

TEST(TextRoundTrip, EveryColumnOfEveryKindOfCloud)
{
    const std::vector<Attribute> attributes = {
        {"intensity", ScalarType::u16}, {"rgb", ScalarType::u16, 3},          {"classification", ScalarType::u8},
        {"gps_time", ScalarType::f64},  {"point_source_id", ScalarType::u16}, {"scan_angle", ScalarType::i16, 1, 0.006},
        {"normal", ScalarType::f32, 3}, {"nor:quality", ScalarType::i32},     {"height", ScalarType::f32}};
    std::vector<std::string> names;
    for (const Attribute& attribute : attributes) names.push_back(attribute.name);
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    for (const PositionKind kind :
         {PositionKind::grid, PositionKind::single_precision, PositionKind::double_precision}) {
        const RandomCloud cloud = random_cloud(random, kind, 3000, false, attributes);
        for (const char* name : {"a.xyz", "a.txt", "a.asc", "a.csv"}) {
            SCOPED_TRACE(name);
            EXPECT_TRUE(write_cloud(folder / name, cloud.info, cloud.points).empty());
            expect_same_cloud(cloud, read_whole(folder / name), names);
        }
    }
}

TEST(TextRoundTrip, ColoursOfEightBitsAndFractions)
{
    TemporaryFolder folder;
    std::mt19937_64 random(2);
    for (const ScalarType type : {ScalarType::u8, ScalarType::f32}) {
        RandomCloud cloud = random_cloud(random, PositionKind::double_precision, 1000, false, {{"rgb", type, 3}});
        if (type == ScalarType::f32)
            for (std::size_t i = 0; i < 3000; ++i)
                cloud.points.attributes[0].as<float>()[i] = static_cast<float>(random() % 1000) / 999;
        for (const char* name : {"a.xyz", "a.csv"}) {
            SCOPED_TRACE(name);
            write_cloud(folder / name, cloud.info, cloud.points);
            expect_same_cloud(cloud, read_whole(folder / name), {"rgb"});
        }
    }
}

TEST(TextRoundTrip, Pts)
{
    TemporaryFolder folder;
    std::mt19937_64 random(3);
    const Attribute intensity{"intensity", ScalarType::i16}, rgb{"rgb", ScalarType::u8, 3};
    for (const std::vector<Attribute>& attributes :
         {std::vector<Attribute>{}, {intensity}, {intensity, rgb}, {rgb, intensity}}) {
        RandomCloud cloud = random_cloud(random, PositionKind::double_precision, 1000, false, attributes);
        std::vector<std::string> names;
        for (const Attribute& attribute : attributes) names.push_back(attribute.name);
        write_cloud(folder / "a.pts", cloud.info, cloud.points);
        const Whole whole = read_whole(folder / "a.pts");
        expect_same_cloud(cloud, whole, names);
        ASSERT_EQ(whole.info.notes.size(), 1u) << "the count of the first line holds";
        EXPECT_TRUE(mentions(whole.info.notes[0], "columns x y z")) << whole.info.notes[0];
    }
}

}  // namespace
}  // namespace pcm::test
