#include "pcm/io/ply/ply_reader.h"

#include "tests/io/bytes.h"
#include "tests/io/ply/ascii_ply.h"

#include <array>
#include <cmath>
#include <limits>
#include <sstream>

namespace pcm::test {
namespace {

// Eight scalar types under both of their names, as text, little endian and big endian.
struct Encoding {
    const char* name;
    const char* format;
};
class PlyEncodings : public testing::TestWithParam<std::tuple<Encoding, bool>> {};

TEST_P(PlyEncodings, EveryScalarTypeComesBack)
{
    const auto [encoding, sized_names] = GetParam();
    static constexpr std::array<std::array<const char*, 2>, 8> names{{{"char", "int8"},
                                                                      {"uchar", "uint8"},
                                                                      {"short", "int16"},
                                                                      {"ushort", "uint16"},
                                                                      {"int", "int32"},
                                                                      {"uint", "uint32"},
                                                                      {"float", "float32"},
                                                                      {"double", "float64"}}};
    static constexpr ScalarType types[] = {ScalarType::i8,  ScalarType::u8,  ScalarType::i16, ScalarType::u16,
                                           ScalarType::i32, ScalarType::u32, ScalarType::f32, ScalarType::f64};
    constexpr std::size_t count = 5000;
    Bytes file;
    file.raw(std::string("ply\nformat ") + encoding.format +
             " 1.0\ncomment element face 3\nobj_info property\nelement vertex " + std::to_string(count) + "\n");
    file.raw(std::string("property ") + names[7][sized_names] + " x\n");
    for (std::size_t t = 0; t < 8; ++t)
        file.raw(std::string("property ") + names[t][sized_names] + " value_" + std::to_string(t) + "\n");
    file.raw(std::string("property ") + names[7][sized_names] + " y\nproperty " + names[7][sized_names] +
             " z\nend_header\n");

    std::mt19937_64 random(1);
    std::vector<std::array<double, 11>> expected(count);  // x, the eight, y, z
    const auto put = [&](auto value) {
        if (std::string(encoding.format) == "ascii") {
            std::ostringstream text;
            text.precision(17);
            text << +value << ' ';
            file.raw(text.str());
        } else if (std::string(encoding.format) == "binary_big_endian") {
            file.put_big_endian(value);
        } else {
            file.put(value);
        }
        return static_cast<double>(value);
    };
    const auto real = [&] {
        return std::ldexp(static_cast<double>(random()) - 0x1p63, static_cast<int>(random() % 40) - 80);
    };
    for (auto& e : expected) {
        e[0] = put(real());
        e[1] = put(static_cast<std::int8_t>(random()));
        e[2] = put(static_cast<std::uint8_t>(random()));
        e[3] = put(static_cast<std::int16_t>(random()));
        e[4] = put(static_cast<std::uint16_t>(random()));
        e[5] = put(static_cast<std::int32_t>(random()));
        e[6] = put(static_cast<std::uint32_t>(random()));
        e[7] = put(static_cast<float>(real()));
        e[8] = put(real());
        e[9] = put(real());
        e[10] = put(real());
        if (std::string(encoding.format) == "ascii") file.raw("\n");
    }
    TemporaryFolder folder;
    const auto path = write_file(folder / "a.ply", file.data);
    const Whole whole = read_whole(path, 777);
    EXPECT_EQ(whole.info.position_type, ScalarType::f64);
    EXPECT_FALSE(whole.info.grid);
    ASSERT_EQ(whole.info.schema.size(), 8u);
    for (std::size_t t = 0; t < 8; ++t) {
        EXPECT_EQ(whole.info.schema[t].name, "value_" + std::to_string(t));
        EXPECT_EQ(whole.info.schema[t].type, types[t]);
    }
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(whole.points.xyz[0][i], expected[i][0]);
        ASSERT_EQ(whole.points.xyz[1][i], expected[i][9]);
        ASSERT_EQ(whole.points.xyz[2][i], expected[i][10]);
        for (std::size_t t = 0; t < 8; ++t)
            ASSERT_EQ(whole.points.attributes[t].value(i), expected[i][t + 1]) << i << " " << t;
    }

    const auto reader = open_reader(path);
    ASSERT_EQ(reader->seekable(), std::string(encoding.format) != "ascii");
    PointBatch batch;
    for (const std::size_t start : {4999, 0, 17, 5000, 2500}) {
        if (!reader->seekable()) break;
        reader->seek(start);
        ASSERT_EQ(reader->read(batch, 10), start < count);
        for (std::size_t i = 0; i < batch.size; ++i) ASSERT_EQ(batch.xyz[0][i], expected[start + i][0]);
    }
}

INSTANTIATE_TEST_SUITE_P(All, PlyEncodings,
                         testing::Combine(testing::Values(Encoding{"ascii", "ascii"},
                                                          Encoding{"little", "binary_little_endian"},
                                                          Encoding{"big", "binary_big_endian"}),
                                          testing::Bool()),
                         [](const auto& p) {
                             return std::string(std::get<0>(p.param).name) +
                                    (std::get<1>(p.param) ? "_sized" : "_classic");
                         });

TEST(PlyReader, FloatPositionsAreWidenedExactly)
{
    TemporaryFolder folder;
    const Whole whole = read_whole(write_file(folder / "a.ply", ascii_ply(xyz, 1, "0.1 -1e-3 16777217\n")));
    EXPECT_EQ(whole.info.position_type, ScalarType::f32);
    EXPECT_EQ(whole.position(0), (Vec3d{static_cast<double>(0.1f), static_cast<double>(-1e-3f), 16777216.0}));
}

TEST(PlyReader, IntegerAndMixedPositionsAreDoubles)
{
    TemporaryFolder folder;
    const Whole whole =
        read_whole(write_file(folder / "a.ply", ascii_ply("property int z\nproperty float y\nproperty uchar x\n", 1,
                                                          "-2147483648 0.5 255\n")));
    EXPECT_EQ(whole.info.position_type, ScalarType::f64);
    EXPECT_EQ(whole.position(0), (Vec3d{255, 0.5, -2147483648.0}));
}

TEST(PlyReader, GroupsBecomeOneAttribute)
{
    struct {
        const char* names[6];
    } const cases[] = {{{"red", "green", "blue", "nx", "ny", "nz"}},
                       {{"diffuse_red", "diffuse_green", "diffuse_blue", "normal_x", "normal_y", "normal_z"}},
                       {{"r", "g", "b", "NX", "NY", "NZ"}}};
    TemporaryFolder folder;
    for (const auto& c : cases) {
        std::string properties = xyz;
        // In an order that is not the attribute's.
        for (const int i : {2, 0, 1}) properties += std::string("property ushort ") + c.names[i] + "\n";
        properties += "property uchar alpha\n";
        for (const int i : {5, 4, 3}) properties += std::string("property double ") + c.names[i] + "\n";
        const Whole whole = read_whole(write_file(
            folder / "a.ply", ascii_ply(properties, 2, "0 0 0 30 10 20 4 .3 .2 .1\n0 0 0 33 11 22 5 .6 .5 .4\n")));
        ASSERT_EQ(whole.info.schema.size(), 3u);
        EXPECT_EQ(whole.info.schema[0], (Attribute{"rgb", ScalarType::u16, 3, 1, 0, {}}));
        EXPECT_EQ(whole.info.schema[1], (Attribute{"alpha", ScalarType::u8, 1, 1, 0, {}}));
        EXPECT_EQ(whole.info.schema[2], (Attribute{"normal", ScalarType::f64, 3, 1, 0, {}}));
        for (std::uint32_t k = 0; k < 3; ++k) {
            EXPECT_EQ(whole.value("rgb", 0, k), 10.0 * (k + 1));
            EXPECT_EQ(whole.value("rgb", 1, k), 11.0 * (k + 1));
        }
        EXPECT_EQ(whole.value("normal", 1, 0), 0.4);
        EXPECT_EQ(whole.value("normal", 1, 2), 0.6);
    }
}

TEST(PlyReader, GroupsOfSeveralTypesStayApart)
{
    TemporaryFolder folder;
    const Whole whole = read_whole(
        write_file(folder / "a.ply",
                   ascii_ply(xyz + "property uchar red\nproperty char green\nproperty uchar blue\nproperty float nx\n",
                             1, "0 0 0 1 -2 3 4\n")));
    for (const char* name : {"red", "green", "blue", "nx"}) EXPECT_TRUE(whole.info.schema.find(name)) << name;
    EXPECT_EQ(whole.value("green", 0), -2);
    EXPECT_FALSE(whole.info.schema.find("rgb"));
}

TEST(PlyReader, NamesThatMeanSomethingElse)
{
    TemporaryFolder folder;
    const Whole whole = read_whole(write_file(
        folder / "a.ply",
        ascii_ply(xyz + "property float rgb\nproperty uchar r\nproperty uchar g\nproperty uchar b\nproperty float "
                        "scalar_intensity\n"
                        "property float radius\nproperty float same\nproperty float same\nproperty float two words\n",
                  1, "0 0 0 9 1 2 3 4 5 6 7 8\n")));
    EXPECT_EQ(whole.info.schema[*whole.info.schema.find("rgb")].components, 3u);
    EXPECT_EQ(whole.value("rgb_scalar", 0), 9);
    EXPECT_EQ(whole.value("rgb", 0, 2), 3);
    EXPECT_EQ(whole.value("intensity", 0), 4);
    EXPECT_EQ(whole.value("radius", 0), 5);
    EXPECT_EQ(whole.value("same", 0), 6);
    EXPECT_EQ(whole.value("same_2", 0), 7);
    EXPECT_EQ(whole.value("two words", 0), 8);

    const Whole both = read_whole(
        write_file(folder / "b.ply",
                   ascii_ply(xyz + "property float scalar_intensity\nproperty float intensity\n", 1, "0 0 0 1 2\n")));
    EXPECT_EQ(both.value("scalar_intensity", 0), 1);
    EXPECT_EQ(both.value("intensity", 0), 2);
}

// Lists before, in and after the vertices, in all encodings.
TEST(PlyReader, SkipsLists)
{
    TemporaryFolder folder;
    for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        std::mt19937_64 random(3);
        Bytes file;
        file.raw("ply\nformat " + format +
                 " 1.0\nelement strip 40\nproperty list ushort double weights\nproperty char c\nproperty list char "
                 "uchar bytes\n"
                 "element fixed 3\nproperty int i\nelement nothing 5\nelement vertex 200\nproperty float x\nproperty "
                 "list int short friends\n"
                 "property float y\nproperty uchar red\nproperty float z\nproperty list uint8 float more\nelement face "
                 "12\nproperty list uchar int vertex_indices\nend_header\n");
        const bool ascii = format == "ascii";
        const auto put = [&](auto value) {
            if (ascii)
                file.raw(std::to_string(value) + " ");
            else if (format == "binary_big_endian")
                file.put_big_endian(value);
            else
                file.put(value);
        };
        const auto end_of_line = [&] {
            if (ascii) file.raw("\r\n");
        };
        for (int i = 0; i < 40; ++i) {
            const auto weights = static_cast<std::uint16_t>(random() % 300);
            put(weights);
            for (int k = 0; k < weights; ++k) put(0.5);
            put(std::int8_t{-1});
            const auto bytes = static_cast<std::int8_t>(random() % 100);
            put(bytes);
            for (int k = 0; k < bytes; ++k) put(std::uint8_t{9});
            end_of_line();
        }
        for (int i = 0; i < 3; ++i) put(i), end_of_line();
        for (int i = 0; i < 200; ++i) {
            put(static_cast<float>(i));
            const auto friends = static_cast<std::int32_t>(random() % 5);
            put(friends);
            for (int k = 0; k < friends; ++k) put(std::int16_t{-3});
            put(static_cast<float>(2 * i));
            put(static_cast<std::uint8_t>(i));
            put(static_cast<float>(3 * i));
            put(std::uint8_t{2});
            put(1.5f);
            put(2.5f);
            end_of_line();
        }
        const std::size_t vertices_end = file.data.size();
        for (int i = 0; i < 12; ++i) {
            put(std::uint8_t{3});
            for (int k = 0; k < 3; ++k) put(k);
            end_of_line();
        }
        const Whole whole = read_whole(write_file(folder / "a.ply", file.data), 33);
        ASSERT_EQ(whole.points.size, 200u);
        for (std::size_t i = 0; i < 200; ++i) {
            const auto n = static_cast<double>(i);
            ASSERT_EQ(whole.position(i), (Vec3d{n, 2 * n, 3 * n}));
            ASSERT_EQ(whole.raw<std::uint8_t>("red", i), static_cast<std::uint8_t>(i));
        }
        EXPECT_TRUE(any_mentions(whole.info.notes, "12 faces ignored: only the points are read"));
        EXPECT_TRUE(any_mentions(whole.info.notes, "list 'friends'"));
        EXPECT_TRUE(any_mentions(whole.info.notes, "40 of element 'strip' ignored"));
        EXPECT_FALSE(open_reader(folder / "a.ply")->seekable());

        // Cut anywhere, it is refused at open or while it is read; the faces may be missing.
        // Text can be cut within its last number, "2.500000 \r\n", without a trace.
        const std::size_t noticed = ascii ? vertices_end - 11 : vertices_end - 1;
        for (std::size_t length = 0; length <= noticed; length += 1 + random() % 60) {
            const auto path = write_file(folder / "cut.ply", file.data.substr(0, length));
            const Error error = error_of([&] { read_whole(*open_reader(path)); });
            if (!ascii && length > 800) {
                ASSERT_EQ(error.code(), ErrorCode::truncated) << length << ": " << error.what();
            }
            ASSERT_TRUE(mentions(error.what(), path.string()));
        }
        EXPECT_EQ(read_whole(write_file(folder / "a.ply", file.data.substr(0, vertices_end))).points.size, 200u);
    }
}

TEST(PlyReader, FixedElementsBeforeTheVerticesLeaveItSeekable)
{
    TemporaryFolder folder;
    Bytes file;
    file.raw("ply\nformat binary_little_endian 1.0\nelement camera 2\nproperty double f\nelement vertex 3\n" + xyz +
             "end_header\n");
    file.put(1.0).put(2.0);
    for (int i = 0; i < 9; ++i) file.put(static_cast<float>(i));
    const auto reader = open_reader(write_file(folder / "a.ply", file.data));
    ASSERT_TRUE(reader->seekable());
    reader->seek(2);
    PointBatch batch;
    ASSERT_TRUE(reader->read(batch, 9));
    EXPECT_EQ(batch.xyz[0], std::vector<double>{6});
    EXPECT_EQ(error_of([&] { reader->seek(4); }).code(), ErrorCode::invalid_argument);
}

TEST(PlyReader, LineEndsOfAllKinds)
{
    const std::string unix_file =
        "ply\nformat ascii 1.0\ncomment\n\nelement vertex 2\n" + xyz + "end_header\n1 2 3\n\n  4\t5 6  \n";
    TemporaryFolder folder;
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string file;
        for (const char c : unix_file) file += c == '\n' ? end : std::string(1, c);
        for (const std::string& variant : {file, file.substr(0, file.size() - end.size())}) {
            const Whole whole = read_whole(write_file(folder / "a.ply", variant));
            ASSERT_EQ(whole.points.size, 2u);
            EXPECT_EQ(whole.position(0), (Vec3d{1, 2, 3}));
            EXPECT_EQ(whole.position(1), (Vec3d{4, 5, 6}));
        }
    }
    // In binary files a byte after the header's last line end may look like another line end.
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        Bytes file;
        file.raw("ply" + end + "format binary_little_endian 1.0" + end + "element vertex 1" + end + "property uchar x" +
                 end + "property uchar y" + end + "property uchar z" + end + "end_header" + end + "\n\r\n");
        const Whole whole = read_whole(write_file(folder / "a.ply", file.data));
        EXPECT_EQ(whole.position(0), (Vec3d{10, 13, 10})) << end.size();
    }
}

TEST(PlyReader, NumbersInEveryNotation)
{
    const double infinity = std::numeric_limits<double>::infinity();
    struct {
        const char* text;
        double value;
    } const cases[] = {{"1e3", 1000},
                       {"+2.5", 2.5},
                       {"-.5", -0.5},
                       {"5.", 5},
                       {"1E-2", 0.01},
                       {"inf", infinity},
                       {"-Infinity", -infinity},
                       {"1.#INF", infinity},
                       {"-1.#INF00", -infinity},
                       {"1e999", infinity},
                       {"-1e999", -infinity},
                       {"1e-999", 0},
                       {"0000000000000000000012", 12},
                       {"4.9406564584124654e-324", 4.9406564584124654e-324},
                       {"1.7976931348623157e308", 1.7976931348623157e308}};
    TemporaryFolder folder;
    for (const auto& c : cases) {
        const Whole whole =
            read_whole(write_file(folder / "a.ply", ascii_ply("property double x\nproperty float y\nproperty float z\n",
                                                              1, std::string(c.text) + " 0 0")));
        EXPECT_EQ(whole.points.xyz[0][0], c.value) << c.text;
    }
    for (const char* text : {"nan", "NaN", "-nan", "1.#QNAN", "-1.#IND", "nan(ind)"}) {
        const Whole whole =
            read_whole(write_file(folder / "a.ply", ascii_ply(xyz, 1, std::string("0 ") + text + " 0")));
        EXPECT_TRUE(std::isnan(whole.points.xyz[1][0])) << text;
    }
    // A float property with numbers beyond float precision.
    const Whole whole = read_whole(write_file(folder / "a.ply", ascii_ply(xyz, 1, "1e200 -1e200 1e-200")));
    EXPECT_EQ(whole.position(0), (Vec3d{infinity, -infinity, 0}));
    // Whole numbers written as reals.
    const Whole real = read_whole(write_file(
        folder / "a.ply", ascii_ply(xyz + "property uchar red\nproperty int label\n", 1, "0 0 0 255.0 -2e3")));
    EXPECT_EQ(real.value("red", 0), 255);
    EXPECT_EQ(real.value("label", 0), -2000);
}

}  // namespace
}  // namespace pcm::test
