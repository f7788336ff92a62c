#include "pcm/io/xyz/xyz_writer.h"

#include "pcm/io/pipe/grid_choice.h"
#include "tests/io/text_lines.h"

#include <charconv>
#include <cmath>

namespace pcm::test {
namespace {

FileInfo doubles(std::initializer_list<Attribute> attributes = {})
{
    FileInfo cloud;
    for (const Attribute& attribute : attributes) cloud.schema.add(attribute);
    return cloud;
}

template <class T>
T parsed(const std::string& text)
{
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    EXPECT_TRUE(error == std::errc() && end == text.data() + text.size()) << text;
    return value;
}
// strtod accepts nan, inf and subnormal numbers, and is independent of the code under test.
template <>
double parsed(const std::string& text)
{
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    EXPECT_TRUE(!text.empty() && *end == 0) << text;
    return value;
}
template <>
float parsed(const std::string& text)
{
    char* end = nullptr;
    const float value = std::strtof(text.c_str(), &end);
    EXPECT_TRUE(!text.empty() && *end == 0) << text;
    return value;
}

template <class T>
void fill(Column& column, std::mt19937_64& random)
{
    const std::size_t count = column.bytes() / sizeof(T);
    for (std::size_t i = 0; i < count; ++i) {
        if constexpr (std::is_same_v<T, double>) {
            column.as<T>()[i] = any_double(random);
        } else {
            const std::uint64_t bits = random();
            std::memcpy(column.as<T>() + i, &bits, sizeof(T));
        }
    }
}

template <class T>
void expect_column(const std::vector<std::vector<std::string>>& rows, std::size_t field, const Column& column)
{
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const T value = column.as<T>()[i];
        if constexpr (std::is_floating_point_v<T>)
            ASSERT_TRUE(same(parsed<T>(rows[i][field]), value)) << rows[i][field] << " " << value;
        else
            ASSERT_EQ(parsed<T>(rows[i][field]), value);
    }
}

TEST(XyzWriter, EveryNumberComesBackToTheLastBit)
{
    const FileInfo cloud = doubles({{"i8", ScalarType::i8},
                                    {"u8", ScalarType::u8},
                                    {"i16", ScalarType::i16},
                                    {"u16", ScalarType::u16},
                                    {"i32", ScalarType::i32},
                                    {"u32", ScalarType::u32},
                                    {"i64", ScalarType::i64},
                                    {"u64", ScalarType::u64},
                                    {"f32", ScalarType::f32},
                                    {"f64", ScalarType::f64}});
    std::mt19937_64 random(1);
    PointBatch batch = batch_of(cloud, 20000);
    for (auto& axis : batch.xyz)
        for (double& value : axis) value = any_double(random);
    fill<std::int8_t>(batch.attributes[0], random);
    fill<std::uint8_t>(batch.attributes[1], random);
    fill<std::int16_t>(batch.attributes[2], random);
    fill<std::uint16_t>(batch.attributes[3], random);
    fill<std::int32_t>(batch.attributes[4], random);
    fill<std::uint32_t>(batch.attributes[5], random);
    fill<std::int64_t>(batch.attributes[6], random);
    fill<std::uint64_t>(batch.attributes[7], random);
    fill<float>(batch.attributes[8], random);
    fill<double>(batch.attributes[9], random);

    TemporaryFolder folder;
    for (const auto& [name, separator, header] :
         {std::tuple{"a.xyz", ' ', "# x y z i8 u8 i16 u16 i32 u32 i64 u64 f32 f64"},
          std::tuple{"a.csv", ',', "x,y,z,i8,u8,i16,u16,i32,u32,i64,u64,f32,f64"}}) {
        EXPECT_TRUE(write_cloud(folder / name, cloud, batch).empty());
        const std::vector<std::string> lines = lines_of(folder / name);
        ASSERT_EQ(lines.size(), batch.size + 1);
        EXPECT_EQ(lines[0], header);
        std::vector<std::vector<std::string>> rows;
        for (std::size_t i = 1; i < lines.size(); ++i) {
            rows.push_back(fields_of(lines[i], separator));
            ASSERT_EQ(rows.back().size(), 13u) << lines[i];
        }
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t i = 0; i < batch.size; ++i)
                ASSERT_TRUE(same(parsed<double>(rows[i][a]), batch.xyz[a][i])) << rows[i][a];
        expect_column<std::int8_t>(rows, 3, batch.attributes[0]);
        expect_column<std::uint8_t>(rows, 4, batch.attributes[1]);
        expect_column<std::int16_t>(rows, 5, batch.attributes[2]);
        expect_column<std::uint16_t>(rows, 6, batch.attributes[3]);
        expect_column<std::int32_t>(rows, 7, batch.attributes[4]);
        expect_column<std::uint32_t>(rows, 8, batch.attributes[5]);
        expect_column<std::int64_t>(rows, 9, batch.attributes[6]);
        expect_column<std::uint64_t>(rows, 10, batch.attributes[7]);
        expect_column<float>(rows, 11, batch.attributes[8]);
        expect_column<double>(rows, 12, batch.attributes[9]);
    }
}

// 7 times 0.1 is 0.7: the decimal that the integer stands for, whose double may differ from 7 * 0.1 in the last bit.
TEST(XyzWriter, PositionsOnAGridAreTheirDecimals)
{
    FileInfo cloud;
    cloud.grid = Grid{{0.001, 0.01, 0.1}, {5e6, -3e6, 0.3}};
    std::mt19937_64 random(2);
    PointBatch batch = batch_of(cloud, 5000);
    for (auto& axis : batch.grid_xyz)
        for (std::int32_t& q : axis) q = static_cast<std::int32_t>(random());
    TemporaryFolder folder;
    write_cloud(folder / "a.txt", cloud, batch);
    const auto lines = lines_of(folder / "a.txt");
    ASSERT_EQ(lines.size(), batch.size + 1);
    for (std::size_t i = 0; i < batch.size; ++i) {
        const auto fields = fields_of(lines[i + 1], ' ');
        ASSERT_EQ(fields.size(), 3u);
        for (std::size_t a = 0; a < 3; ++a) {
            const double value = parsed<double>(fields[a]);
            ASSERT_EQ(nearest_on_grid(*cloud.grid, a, value), batch.grid_xyz[a][i]);
            ASSERT_LE(std::fabs(value - cloud.grid->to_source(batch.grid_xyz[a][i], a)),
                      1e-15 * std::fabs(value) + 2e-9);
            const std::size_t point = fields[a].find('.');
            ASSERT_LE(point == std::string::npos ? 0 : fields[a].size() - point - 1, a == 0   ? 3u
                                                                                     : a == 1 ? 2u
                                                                                              : 1u)
                << fields[a];
        }
    }
}

TEST(XyzWriter, LinesAsPeopleWriteThem)
{
    const FileInfo cloud = doubles({{"intensity", ScalarType::u16},
                                    {"rgb", ScalarType::u8, 3},
                                    {"normal", ScalarType::f32, 3},
                                    {"angle", ScalarType::i16, 1, 0.006, 0},
                                    {"pair", ScalarType::i32, 2}});
    PointBatch batch = batch_of(cloud, 2);
    batch.xyz = {{{1000000, 0.1}, {-2.5, 1e-7}, {0, 1e300}}};
    for (std::uint16_t i = 0; i < 2; ++i) batch.attributes[0].as<std::uint16_t>()[i] = 7;
    for (std::uint8_t i = 0; i < 6; ++i) batch.attributes[1].as<std::uint8_t>()[i] = static_cast<std::uint8_t>(250 + i);
    for (int i = 0; i < 6; ++i) batch.attributes[2].as<float>()[i] = static_cast<float>(i) / 10;
    batch.attributes[3].as<std::int16_t>()[0] = 500;
    batch.attributes[3].as<std::int16_t>()[1] = -1;
    for (int i = 0; i < 4; ++i) batch.attributes[4].as<std::int32_t>()[i] = -i;
    TemporaryFolder folder;
    write_cloud(folder / "a.asc", cloud, batch);
    EXPECT_EQ(read_bytes(folder / "a.asc"),
              "# x y z intensity r g b nx ny nz angle pair_0 pair_1\n"
              "1000000 -2.5 0 7 250 251 252 0 0.1 0.2 3 0 -1\n"
              "0.1 1e-07 1e+300 7 253 254 255 0.3 0.4 0.5 -0.006 -2 -3\n");
}

TEST(XyzWriter, NamesThatColumnsCannotHave)
{
    const FileInfo cloud = doubles({{"gps time", ScalarType::u8},
                                    {"a,b", ScalarType::u8},
                                    {"X", ScalarType::u8},
                                    {"say \"so\"", ScalarType::u8},
                                    {"r", ScalarType::u8},
                                    {"rgb", ScalarType::u8, 3},
                                    {"-", ScalarType::u8},
                                    {"rgb_0", ScalarType::u8}});
    const PointBatch batch = batch_of(cloud, 0);
    TemporaryFolder folder;
    write_cloud(folder / "a.xyz", cloud, batch);
    EXPECT_EQ(read_bytes(folder / "a.xyz"), "# x y z gps_time a_b X_2 say__so_ r r_2 g b _ rgb_0\n");
    write_cloud(folder / "a.csv", cloud, batch);
    EXPECT_EQ(read_bytes(folder / "a.csv"), "x,y,z,\"gps time\",\"a,b\",X_2,\"say \"\"so\"\"\",r,r_2,g,b,_,rgb_0\n");
}

TEST(XyzWriter, DecimalsAreUsedAndTheErrorIsReported)
{
    FileInfo cloud;
    PointBatch batch = batch_of(cloud, 3);
    batch.xyz = {{{1.25, 2, std::numeric_limits<double>::infinity()},
                  {0.001, 5000000.126, std::numeric_limits<double>::quiet_NaN()},
                  {-1.5, 0.5, 3.999}}};
    TemporaryFolder folder;
    WriteOptions options;
    options.decimals = 2;
    const auto writer = create_writer(folder / "a.xyz", cloud, options);
    writer->write(batch);
    writer->finish();
    EXPECT_EQ(read_bytes(folder / "a.xyz"), "# x y z\n1.25 0.00 -1.50\n2.00 5000000.13 0.50\ninf nan 4.00\n");
    EXPECT_EQ(writer->position_error(), 5000000.13 - 5000000.126);

    options.decimals = 31;
    EXPECT_EQ(error_of([&] { create_writer(folder / "b.xyz", cloud, options); }).code(), ErrorCode::invalid_argument);
    options.decimals = 30;
    batch.xyz[0][0] = -std::numeric_limits<double>::max();
    write_cloud(folder / "b.xyz", cloud, batch, options);
    EXPECT_TRUE(same(std::stod(fields_of(lines_of(folder / "b.xyz")[1], ' ')[0]), batch.xyz[0][0]));
}

TEST(XyzWriter, ExactWithoutDecimals)
{
    FileInfo cloud;
    PointBatch batch = batch_of(cloud, 1);
    batch.xyz = {{{1.0 / 3}, {2.0 / 3}, {1e-9}}};
    TemporaryFolder folder;
    const auto writer = create_writer(folder / "a.xyz", cloud);
    writer->write(batch);
    writer->finish();
    EXPECT_EQ(writer->position_error(), 0);
}

TEST(XyzWriter, ManyBatchesMakeOneFile)
{
    const FileInfo cloud = doubles({{"index", ScalarType::u32}});
    TemporaryFolder folder;
    const auto writer = create_writer(folder / "a.xyz", cloud);
    std::uint32_t next = 0;
    for (std::size_t size : {1, 0, 20000, 7, 65536}) {
        PointBatch batch = batch_of(cloud, size);
        for (std::size_t i = 0; i < size; ++i, ++next) {
            for (auto& axis : batch.xyz) axis[i] = next;
            batch.attributes[0].as<std::uint32_t>()[i] = next;
        }
        writer->write(batch);
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "a.xyz")) << "not before finish()";
    writer->finish();
    const auto lines = lines_of(folder / "a.xyz");
    ASSERT_EQ(lines.size(), next + 1);
    for (std::uint32_t i = 0; i < next; ++i) {
        const std::string n = std::to_string(i);
        ASSERT_EQ(lines[i + 1], n + " " + n + " " + n + " " + n);
    }
}

TEST(XyzWriter, RefusesBatchesOfAnotherShape)
{
    const FileInfo cloud = doubles({{"a", ScalarType::u8}});
    TemporaryFolder folder;
    const auto writer = create_writer(folder / "a.xyz", cloud);
    FileInfo other = doubles({{"a", ScalarType::u16}});
    EXPECT_EQ(error_of([&] { writer->write(batch_of(other, 1)); }).code(), ErrorCode::invalid_argument);
    other = doubles();
    EXPECT_EQ(error_of([&] { writer->write(batch_of(other, 1)); }).code(), ErrorCode::invalid_argument);
    other = cloud;
    other.grid = Grid{};
    EXPECT_EQ(error_of([&] { writer->write(batch_of(other, 1)); }).code(), ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace pcm::test
