// Points as text: any layout that can be detected is detected, and every number is read exactly.
#include "pcm/io/pipe/merged_reader.h"
#include "pcm/io/xyz/xyz_reader.h"

#include "tests/io/text/read_text.h"

#include <charconv>
#include <cmath>
#include <limits>

namespace pcm::test {
namespace {

template <class T>
std::string shortest(T value)
{
    char text[400];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// A layout in which a random cloud is printed.
struct Print {
    const char* name;
    char separator;
    char point;
    const char* line_end;
    bool header, last_line_ends;
    const char* pad;
};

TEST(TextReader, RandomCloudsInRandomLayouts)
{
    static constexpr Print prints[] = {
        {"a.xyz", ' ', '.', "\n", false, true, ""},      {"a.xyz", ' ', '.', "\r\n", true, true, "  "},
        {"a.txt", '\t', '.', "\n", true, false, ""},     {"a.csv", ',', '.', "\r\n", true, true, ""},
        {"a.csv", ',', '.', "\n", false, false, " "},    {"a.txt", ';', ',', "\n", true, true, ""},
        {"a.asc", ' ', '.', "\r", true, true, ""},       {"a.txt", '\t', ',', "\r\n", false, true, ""},
        {"a.unknown", ' ', '.', "\n", true, true, "\t"}, {"a.txt", ' ', ',', "\n", true, false, ""},
        {"a.asc", ' ', '.', "\r", false, false, ""},     {"a.csv", ';', '.', "\n", true, true, " "},
    };
    std::mt19937_64 random(7);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
    };
    for (int round = 0; round < 120; ++round) {
        const Print& print = prints[static_cast<std::size_t>(round) % std::size(prints)];
        SCOPED_TRACE(std::to_string(round) + ": " + print.name + " " + print.separator);
        const std::size_t points = round < 24 ? 1 + random() % 5 : 200 + random() % 3000;
        const bool with_intensity = random() % 2, with_rgb = random() % 2, with_normals = random() % 2;
        std::vector<Vec3d> xyz(points);
        std::vector<std::array<int, 3>> rgb(points);
        std::vector<std::array<float, 3>> normals(points);
        std::vector<int> intensity(points);
        std::string text, separator(1, print.separator);
        if (print.header) {
            text += "X" + separator + "Y" + separator + "Z";
            if (with_intensity) text += separator + "Intensity";
            if (with_rgb) text += separator + "Red" + separator + "Green" + separator + "Blue";
            if (with_normals) text += separator + "Nx" + separator + "Ny" + separator + "Nz";
            text += print.line_end;
        }
        const auto put = [&](std::string number) {
            for (char& c : number)
                if (c == '.') c = print.point;
            if (!text.empty() && text.find_last_of("\r\n") + 1 != text.size())
                text += print.pad + separator + print.pad;
            text += number;
        };
        for (std::size_t i = 0; i < points; ++i) {
            if (i) text += print.line_end;
            for (std::size_t a = 0; a < 3; ++a) {
                xyz[i][a] = random() % 50 ? uniform(-5e6, 5e6)
                                          : std::ldexp(uniform(-1, 1), static_cast<int>(random() % 2000) - 1000);
                put(shortest(xyz[i][a]));
            }
            intensity[i] = static_cast<int>(random() % 4000);
            if (with_intensity) put(std::to_string(intensity[i]));
            for (int& c : rgb[i]) {
                c = static_cast<int>(random() % 256);
                if (with_rgb) put(std::to_string(c));
            }
            const double z = uniform(-1, 1), angle = uniform(0, 6.28), r = std::sqrt(1 - z * z);
            normals[i] = {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)),
                          static_cast<float>(z)};
            for (const float n : normals[i])
                if (with_normals) put(shortest(n));
        }
        if (print.last_line_ends) text += print.line_end;
        const Whole whole = read_text(text, print.name, {}, 1 + random() % 4000);
        ASSERT_EQ(whole.points.size, points);
        for (std::size_t i = 0; i < points; ++i) {
            ASSERT_EQ(whole.position(i), xyz[i]) << i;
            if (with_intensity) {
                ASSERT_EQ(whole.value("intensity", i), intensity[i]) << names_of(whole.info.schema);
            }
            for (std::uint32_t k = 0; k < 3; ++k) {
                if (with_rgb) {
                    ASSERT_EQ(whole.raw<std::uint8_t>("rgb", i, k), rgb[i][k]) << names_of(whole.info.schema);
                }
                if (with_normals) {
                    ASSERT_EQ(whole.raw<float>("normal", i, k), normals[i][k]) << names_of(whole.info.schema);
                }
            }
        }
    }
}

TEST(TextReader, EveryNumberIsTheNearest)
{
    const char* numbers[] = {"0.1",
                             "1e23",
                             "9007199254740993",
                             "2.2250738585072011e-308",
                             "4.9e-324",
                             "1.7976931348623157e308",
                             "123456789012345678901234567890",
                             "0.000000000000000000000000000001",
                             "-0",
                             "+5",
                             ".5",
                             "5.",
                             "1E5",
                             "289814.15",
                             "100000000000000016777215",
                             "1e-400",
                             "1e400",
                             "6.25e+2",
                             "00012.50"};
    for (const char* number : numbers) {
        const double expected = std::strtod(number, nullptr);
        const Whole whole = read_text("1 2 " + std::string(number) + "\n" + number + " 3 4\n");
        ASSERT_EQ(whole.points.size, 2u);
        EXPECT_EQ(whole.position(0)[2], expected) << number;
        EXPECT_EQ(std::signbit(whole.position(1)[0]), std::signbit(expected)) << number;
    }
    const Whole odd = read_text("nan -inf 1.#INF\n1.#IND -1.#INF Infinity\n");
    EXPECT_TRUE(std::isnan(odd.position(0)[0]) && std::isnan(odd.position(1)[0]));
    EXPECT_EQ(odd.position(0)[1], -std::numeric_limits<double>::infinity());
    EXPECT_EQ(odd.position(1)[1], -std::numeric_limits<double>::infinity());
    EXPECT_EQ(odd.position(0)[2], odd.position(1)[2]);
    // Beyond 2^53 identifiers are integers.
    const Whole wide = read_text("# x y z id\n1 2 3 9007199254740993\n1 2 3 18446744073709551615\n");
    EXPECT_EQ(wide.raw<std::uint64_t>("id", 0), 9007199254740993u);
    EXPECT_EQ(wide.raw<std::uint64_t>("id", 1), std::numeric_limits<std::uint64_t>::max());
}

TEST(TextReader, ColumnsWithoutNames)
{
    struct {
        std::string text;
        const char* schema;
        const char* says;
    } const cases[] = {
        {"1 2 3\n4 5 6\n", "", "columns x y z"},
        {"1 2 3 7\n4 5 6 8\n", "intensity:u16", "x y z intensity"},
        {"1 2 3 0.5\n4 5 6 0.25\n", "intensity:f32", "x y z intensity"},
        {"1 2 3 10 20 30\n4 5 6 255 0 9\n", "rgb:u8x3", "colours 0-255"},
        {"1 2 3 300 20 30\n4 5 6 255 0 65535\n", "rgb:u16x3", "colours 0-65535"},
        {"1 2 3 0.5 0.5 0.1\n4 5 6 1 0 0\n", "rgb:f32x3", "colours 0-1"},
        {"1 2 3 0 0 1\n4 5 6 0.6 0 0.8\n", "normal:f32x3", "nx ny nz"},
        {"1,2,3,0,0,1\n4,5,6,,,\n", "normal:f32x3", "nx ny nz"},  // a point without a normal
        {"1 2 3 0 0 1\n4 5 6 NA NA NA\n", "normal:f32x3", "nx ny nz"},
        {"1 2 3 99 10 20 30\n4 5 6 100 1 2 3\n", "intensity:u16 rgb:u8x3", "x y z intensity r g b"},
        {"1 2 3 10 20 30 0.25\n4 5 6 1 2 3 0.5\n", "rgb:u8x3 intensity:f32", "x y z r g b intensity"},
        {"1 2 3 10 20 30 0 1 0\n4 5 6 1 2 3 1 0 0\n", "rgb:u8x3 normal:f32x3", "r g b nx ny nz"},
        {"1 2 3 0 1 0 10 20 30\n4 5 6 0 0 -1 1 2 3\n", "normal:f32x3 rgb:u8x3", "nx ny nz r g b"},
        {"1 2 3 -7.5 400.25\n4 5 6 8 9\n", "column_4:f64 column_5:f64", "column_4"},
    };
    for (const auto& c : cases) {
        const Whole whole = read_text(c.text);
        EXPECT_EQ(names_of(whole.info.schema), c.schema) << c.text;
        EXPECT_TRUE(any_mentions(whole.info.notes, c.says)) << c.text << whole.info.notes[0];
        EXPECT_TRUE(any_mentions(whole.info.notes, "columns option")) << whole.info.notes[0];
        EXPECT_EQ(whole.points.size, 2u);
    }
}

TEST(TextReader, HeadersOfOtherPrograms)
{
    struct {
        std::string text;
        const char* schema;
    } const cases[] = {
        {"//X Y Z R G B scalar_Intensity\n2\n1 2 3 4 5 6 7\n1 2 3 4 5 6 8\n", "rgb:u8x3 intensity:u16"},
        {"//X;Y;Z;Rf;Gf;Bf;Nx;Ny;Nz\n1;2;3;0;1;0;0;0;1\n", "rgb:f32x3 normal:f32x3"},
        {"\"Easting\",\"Northing\",\"Elevation\",\"Gps Time [s]\"\n1,2,3,4\n", "gps_time:f64"},
        {"id,X,Y,Z,Classification,ReturnNumber\n5,1,2,3,4,1\n", "id:f64 classification:u8 return_number:u8"},
        {"\xEF\xBB\xBFx y z\n1 2 3\n", ""},
        {"# made by hand\n#\n# x y z a_0 a_1 b_1 intensity\n\n1 2 3 4 5 6 7\n", "a:f64x2 b_1:f64 intensity:u16"},
        {"Height,Y,X\n3,2,1\n", ""},
        {"x,y,z,height,X (m)\n1,2,3,4,5\n", "height:f64 X (m):f64"},
        {"x y z nx ny\n1 2 3 0 1\n", "nx:f64 ny:f64"},
        {"1\n1 2 3 4 5 6\n", "rgb:u8x3"},
        {"x;y;z;\n1;2;3;\n", ""},
    };
    for (const auto& c : cases) {
        const Whole whole = read_text(c.text, "a.txt");
        EXPECT_EQ(names_of(whole.info.schema), c.schema) << c.text;
        ASSERT_GE(whole.points.size, 1u) << c.text;
        EXPECT_EQ(whole.position(0), (Vec3d{1, 2, 3})) << c.text;
    }
    const Whole empty = read_text("# x y z intensity r g b\n");
    EXPECT_EQ(empty.points.size, 0u);
    EXPECT_EQ(empty.info.schema.size(), 2u);
}

TEST(TextReader, TheUsersLayoutWins)
{
    TextLayout layout;
    layout.columns = {"-", "y", "x", "z", "r:u16", "g", "b", "id:u64"};
    const Whole whole = read_text("1 2 3 4 5 6 7 8\n", "a.xyz", layout);
    EXPECT_EQ(whole.position(0), (Vec3d{3, 2, 4}));
    EXPECT_EQ(names_of(whole.info.schema), "rgb:u16x3 id:u64");
    layout.columns = {"x", "y", "z"};
    layout.skip_lines = 1;
    EXPECT_EQ(read_text("7 8 9\n1 2 3\n", "a.xyz", layout).points.size, 1u);
    layout.separator = ';';
    EXPECT_EQ(read_text("7 8 9\n1,5;2;3\n", "a.xyz", layout).position(0)[0], 1.5);
    TextLayout range;
    range.colour_range = 65535;
    EXPECT_EQ(names_of(read_text("1 2 3 4 5 6\n", "a.xyz", range).info.schema), "rgb:u16x3");
    EXPECT_EQ(read_text("X,Y,X\n1,2,3\n", "a.csv", {{}, {}, {"x", "y", "z"}, {}}).position(0), (Vec3d{1, 2, 3}));
    range.colour_range = 17;
    EXPECT_EQ(error_of([&] { check_layout(range); }).code(), ErrorCode::invalid_argument);
    for (const char* bad : {"x y", "x y z x", "x y z a:q8", "x y z a a"})
        EXPECT_EQ(error_of([&] { parse_columns(bad); }).code(), ErrorCode::invalid_argument) << bad;
}

// The detected layout as data; the notes are for people.
TEST(TextReader, TheLayoutIsReported)
{
    TextLayout layout =
        read_text("# made by hand\nX;Y;Z;Red;Green;Blue\n1,5;2;3;4;5;6\n1;2;3;255;0;9\n").info.text_layout.value();
    EXPECT_EQ(layout.separator, ';');
    EXPECT_EQ(layout.skip_lines, 2u);
    EXPECT_EQ(layout.columns, (std::vector<std::string>{"x", "y", "z", "r", "g", "b"}));
    EXPECT_EQ(layout.colour_range, 255);
    EXPECT_EQ(describe(layout), "x y z r g b (colours 0-255), separated by semicolons, 2 lines skipped");
    // Stated explicitly, it reads the same.
    EXPECT_EQ(
        read_text("# made by hand\nX;Y;Z;Red;Green;Blue\n1,5;2;3;4;5;6\n1;2;3;255;0;9\n", "a.xyz", layout).position(0),
        (Vec3d{1.5, 2, 3}));

    layout.columns = {"x", "y", "z", "id:u64"};
    layout.separator = ' ';
    layout.skip_lines.reset();
    layout.colour_range.reset();
    const FileInfo stated = read_text("1 2 3 4\n5 6 7 8\n", "a.txt", layout).info;
    EXPECT_EQ(stated.text_layout.value().columns, layout.columns);
    EXPECT_EQ(stated.text_layout->colour_range, std::nullopt);
    EXPECT_EQ(describe(*stated.text_layout), "x y z id:u64, separated by blanks");
}

// Notes report all that was understood and guessed, and nothing else.
TEST(TextReader, TheNotesOfAFileAreThese)
{
    const std::string overrides = "; the columns option overrides this";
    const std::string no_colours =
        "the columns r g b hold neither whole numbers up to 65535 nor fractions up to 1, and are kept as three "
        "attributes without colour";
    struct {
        const char* text;
        std::vector<std::string> notes;
    } const cases[] = {
        {"1 2 3 4\n5 6 7 8\n", {"columns x y z intensity, separated by blanks" + overrides}},
        {"x y z r g b\n1 2 3 300000 5 6\n4 5 6 1 2 3\n",
         {"columns x y z r g b, separated by blanks, 1 line skipped, named in line 1" + overrides, no_colours}},
        {"# made by hand\nX;Y;Z;Red;Green;Blue\n1,5;2;3;4;5;6\n1;2;3;255;0;9\n",
         {"columns x y z r g b (colours 0-255), separated by semicolons, 2 lines skipped, with decimal commas, named "
          "in "
          "line 2" +
              overrides,
          "names of columns understood: Red\u2192r, Green\u2192g, Blue\u2192b"}},
        {"lon lat z i\n1 2 3 4\n5 6 7 8\n",
         {"columns x y z intensity, separated by blanks, 1 line skipped, named in line 1" + overrides,
          "names of columns understood: lon\u2192x, lat\u2192y, i\u2192intensity",
          "x and y are longitude and latitude, in degrees as they are in the file"}}};
    for (const auto& c : cases) EXPECT_EQ(notes_after(c.text, "a.xyz"), c.notes) << c.text;
    // What the user stated is not reported as a guess.
    TextLayout layout;
    layout.columns = {"x", "y", "z", "r", "g", "b"};
    EXPECT_EQ(read_text("1 2 3 300000 5 6\n", "a.xyz", layout).info.notes,
              (std::vector<std::string>{"columns x y z r g b, separated by blanks", no_colours}));
    EXPECT_EQ(notes_after("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5 -7 1 2\n",
                          "a.ptx"),
              std::vector<std::string>{no_colours});
}

TEST(TextReader, LinesThatDoNotFitAreNamed)
{
    const std::string many = [] {
        std::string text;
        for (int i = 0; i < 200000; ++i) text += "1.25 2.5 3.75 10 20 30\n";
        return text;
    }();
    struct {
        std::string text;
        const char *name, *says;
    } const cases[] = {
        {"1 2 3\n1 2\n", "a.xyz", "line 2: found 2 fields, expected 3"},
        {"1 2 3\n1 2 3\n\n# c\n1 2 3 4\n", "a.xyz", "line 5: found 4 fields, expected 3"},
        {"1 2 3\n1 x 3\n", "a.xyz", "line 2: found 'x' in column 2 (y)"},
        {"1,2,3\n1,,3\n", "a.csv", "line 2: found '' in column 2 (y)"},
        {many + "1 2 3 256 2 3\n", "a.xyz",
         "line 200001: found '256' in column 4 (r), expected a whole number from 0 to 255"},
        {many + "1 2 3 0.5 2 3\n", "a.xyz", "found '0.5'"},
        {"X,Y,X\n1,2,3\n", "a.csv", "line 1 is 'X,Y,X'"},
        {"x y z id\n1 2 3\n", "a.txt", "line 1 names 4 columns"},
        {"5\n1 2 3\n", "a.pts", "line 1 promises 5 points, the file ends after 1"},
        {"2\n1 2 3\n1\n1 2 3\n", "a.pts", "line 1 promises 2 points, line 3 begins another list after 1"},
        {"Once upon a time\nthere was a cloud.\n", "a.txt", "expected lines of three numbers"},
        {"ncols 3\nnrows 2\n1 2 3\n4 5 6\n", "a.asc", "grid of heights"},
        {std::string("1 2 3\n\0\x01\x02", 9), "a.xyz", "byte 6"},
        {"\xFF\xFE"
         "1 ",
         "a.txt", "UTF-16"},
        {std::string(3000000, '1'), "a.xyz", "line"},
        {"1 2 3\n" + std::string(3000000, '1') + " 2 3\n", "a.xyz", "line 2 is longer than"},
        {"#\n", "a.xyz", "no line of three numbers"},
        {"2\n1 2 3\n4 5 6\n", "a.pwn", "expected x y z nx ny nz"},
    };
    for (const auto& c : cases) {
        const Error error = refusal(c.text, c.name);
        EXPECT_TRUE(mentions(error.what(), c.says)) << error.what();
    }
    EXPECT_EQ(refusal("5\n1 2 3\n", "a.pts").code(), ErrorCode::truncated);
}

TEST(TextReader, SkippedFieldsAreCounted)
{
    EXPECT_TRUE(any_mentions(notes_after("x,y,z\n1,2,3\n1,2,3,4\n1,2,3\n", "a.csv"), "1 line has more fields"));
    EXPECT_TRUE(any_mentions(notes_after("x,y,z,a\n1,2,3,4\n1,2,3,\n1,2,3,,\n", "a.csv"), "2 empty fields are NaN"));
    EXPECT_TRUE(any_mentions(notes_after("1\n1 2 3\n1 2 3\n", "a.pts"), "line 1 promises 1 point, 2 follow"));
    std::string text = "# x y z intensity\n";
    for (int i = 0; i < 300000; ++i) text += "1 2 3 0.5\n";
    EXPECT_TRUE(any_mentions(notes_after(text + "1 2 3 0.50000000001\n", "a.xyz"), "1 value has more digits"));
}

TEST(TextReader, NotesAddedWhileReadingReachTheMergedCloud)
{
    TemporaryFolder folder;
    const auto one = write_file(folder / "a.csv", "x,y,z\n1,2,3\n1,2,3,4\n"),
               two = write_file(folder / "b.pts", "1\n1 2 3\n1 2 3\n");
    MergedReader cloud({one, two}, {});
    EXPECT_EQ(read_whole(cloud).points.size, 4u);
    EXPECT_TRUE(any_mentions(cloud.info().notes, "a.csv: 1 line has more fields"));
    EXPECT_TRUE(any_mentions(cloud.info().notes, "b.pts: line 1 promises 1 point, 2 follow"));
}

TEST(TextReader, FoldersHoldOnlyTextOfPoints)
{
    TemporaryFolder folder;
    write_file(folder / "readme.txt", "About these clouds\n");
    write_file(folder / "a.txt", "1 2 3\n");
    write_file(folder / "b.csv", "a,b\n1,2\n");
    EXPECT_EQ(expand_inputs({folder.path()}), (std::vector<std::filesystem::path>{folder / "a.txt"}));
    EXPECT_EQ(open_reader(write_file(folder / "plain", "1 2 3\n"))->info().format, "text separated by blanks");
    // A few bad lines are the reader's to name; many show that it is something else.
    std::string rows;
    for (int i = 0; i < 10; ++i) rows += "1 2 3\n";
    write_file(folder / "c.txt", rows + "oops\n");
    write_file(folder / "d.txt", rows + "oops\noops\n");
    write_file(folder / "e.csv", "P,N,E,Z,D\n1,2,3,4,TREE\n");
    write_file(folder / "f.csv", "1,2,3,4,TREE\n");
    EXPECT_EQ(expand_inputs({folder.path()}),
              (std::vector<std::filesystem::path>{folder / "a.txt", folder / "c.txt", folder / "e.csv"}));
}

}  // namespace
}  // namespace pcm::test
