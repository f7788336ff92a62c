#include "pcm/io/ptx/ptx_reader.h"

#include "tests/io/text/read_text.h"

#include <algorithm>

namespace pcm::test {
namespace {

std::string ptx_header(int columns, int rows, const std::string& matrix = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
{
    return std::to_string(columns) + "\n" + std::to_string(rows) + "\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + matrix;
}

TEST(Ptx, EveryScanIsTransformed)
{
    const std::string text =
        ptx_header(2, 2) + "1 2 3 0.5 7 8 9\n0 0 0 0.5 0 0 0\n4 5 6 0.25 1 2 3\n-0 0.0 0e5 0 0 0 0\n" +
        ptx_header(1, 2, "0 1 0 0\n-1 0 0 0\n0 0 2 0\n600000.5 800000 400 1\n") +
        "1 2 3 1 0 0 0\n1e-9 0 0 0 255 255 255\n" + ptx_header(0, 5) + ptx_header(1, 1) + "0 0 1 0.125\n";
    for (const std::size_t batch : {1, 2, 100}) {
        const Whole whole = read_text(text, "a.ptx", {}, batch);
        EXPECT_EQ(names_of(whole.info.schema), "intensity:f32 rgb:u8x3 scan:u32");
        ASSERT_EQ(whole.points.size, 5u);
        EXPECT_EQ(whole.position(1), (Vec3d{4, 5, 6}));
        EXPECT_EQ(whole.position(2), (Vec3d{1.0 * 0 + 2 * -1.0 + 600000.5, 1.0 + 800000, 6.0 + 400}));
        EXPECT_EQ(whole.position(3)[1], 1e-9 + 800000);
        EXPECT_EQ(whole.value("intensity", 1), 0.25);
        EXPECT_EQ(whole.value("rgb", 0, 2), 9);
        EXPECT_EQ(whole.value("rgb", 4, 2), 0);
        EXPECT_EQ(whole.value("scan", 1), 1);
        EXPECT_EQ(whole.value("scan", 2), 2);
        EXPECT_EQ(whole.value("scan", 4), 4);
        EXPECT_EQ(whole.info.metadata.size(), 4u);
        EXPECT_EQ(whole.info.metadata[1].key, "ptx.scan/2");
    }
    EXPECT_TRUE(any_mentions(notes_after(text, "a.ptx"), "2 missing returns"));
    // Recognised by its structure, whatever its name.
    EXPECT_EQ(read_text(ptx_header(1, 1) + "1 2 3 4\n", "a.txt").info.format, "PTX");
    EXPECT_EQ(names_of(read_text(ptx_header(1, 1) + "1 2 3 4\n", "a").info.schema), "intensity:f32");
}

TEST(Ptx, PromisesAreChecked)
{
    struct {
        std::string text;
        ErrorCode code;
        const char* says;
    } const cases[] = {
        {ptx_header(4444, 10014) + "1 2 3 4\n", ErrorCode::truncated,
         "after 1 of the 44,502,216 points that scan 1 promises"},
        {ptx_header(2, 1) + "1 2 3 4\n" + ptx_header(1, 1) + "1 2 3 4\n", ErrorCode::truncated, "line 12: found '1'"},
        {ptx_header(1, 1) + "1 2 3 4\n1 2 3 4\n", ErrorCode::bad_format, "line 12"},
        {ptx_header(1, 1) + "1 2 3 4\n5\n", ErrorCode::truncated, "ends before the number of rows"},
        {ptx_header(1, 2) + "1 2 3 4\n1 2 3\n", ErrorCode::bad_format, "line 12: found 3 fields, expected 4"},
        {ptx_header(1, 1) + "1 2\n", ErrorCode::bad_format, "line 11"},
        {ptx_header(1, 1, "1 0 0 0\n0 1 0 0\n0 0 inf 0\n0 0 0 1\n") + "1 2 3 4\n", ErrorCode::bad_format, "line 9"},
        {"18446744073709551615\n18446744073709551615\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n",
         ErrorCode::bad_format, "holds no points"},
        {"3\n", ErrorCode::truncated, "the number of rows"},
        {"hello\n", ErrorCode::bad_format, "line 1"},
        {"\n", ErrorCode::truncated, "no scan"},
    };
    for (const auto& c : cases) {
        const Error error = refusal(c.text, "a.ptx");
        EXPECT_EQ(error.code(), c.code) << error.what();
        EXPECT_TRUE(mentions(error.what(), c.says)) << error.what();
    }
}

// x y z 1 times a matrix whose last column is not 0 0 0 1 does not end with 1.
TEST(Ptx, ProjectiveTransformsAreRefused)
{
    struct {
        const char* matrix;
        const char* says;
    } const cases[] = {
        {"1 0 0 0.1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "line 7: found '1 0 0 0.1', whose last number is not 0"},
        {"1 0 0 0\n0 1 0 0\n0 0 1 1e-9\n0 0 0 1\n", "line 9"},
        {"1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n", "line 10: found '0 0 0 2', whose last number is not 1"},
        {"1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 0\n", "line 10"},
        {"1 0 0 500000\n0 1 0 4800000\n0 0 1 100\n0 0 0 1\n", "or stands in columns"},
    };
    for (const auto& c : cases) {
        const Error error = refusal(ptx_header(1, 1, c.matrix) + "1 2 3 4\n", "a.ptx");
        EXPECT_EQ(error.code(), ErrorCode::bad_format);
        EXPECT_TRUE(mentions(error.what(), c.says)) << error.what();
    }
    // In any scan.
    EXPECT_TRUE(mentions(
        refusal(ptx_header(1, 1) + "1 2 3 4\n" + ptx_header(1, 1, cases[0].matrix) + "1 2 3 4\n", "a.ptx").what(),
        "line 18"));
    EXPECT_EQ(
        read_text(ptx_header(1, 1, "1 0 0 1e-17\n0 1 0 -0\n0 0 1 0\n5 6 7 1.0000000000000002\n") + "1 2 3 4\n", "a.ptx")
            .position(0),
        (Vec3d{6, 8, 10}));
}

TEST(Ptx, BadLinesAreSkippedAndCounted)
{
    const std::string text = ptx_header(1, 3) + "1 2 3 0.5\n1 oops 3 0.5\n4 5 6 0.5\n" + ptx_header(2, 2) +
                             "7 8 9 0.5\n1 2 3\nnothing\n0 0 1 NA\n";
    EXPECT_TRUE(mentions(refusal(text, "a.ptx").what(), "line 12: found 'oops'"));
    TemporaryFolder folder;
    ReadOptions options;
    options.skip_bad_lines = true;
    const auto path = write_file(folder / "a.ptx", text);
    for (const std::size_t batch : {1, 2, 100}) {
        const auto reader = open_reader(path, options);
        const Whole whole = read_whole(*reader, batch);
        ASSERT_EQ(whole.points.size, 4u);
        EXPECT_EQ(whole.position(1), (Vec3d{4, 5, 6}));
        EXPECT_EQ(whole.value("scan", 2), 2);
        EXPECT_EQ(reader->info().skipped.lines, 3u);
        EXPECT_TRUE(any_mentions(reader->info().notes, "3 bad lines were skipped, the first is line 12: found 'oops'"));
        EXPECT_TRUE(any_mentions(reader->info().notes, "1 missing value is NaN"));
    }
    // Never those of a header, nor points that are not there.
    for (const std::string& damaged :
         {ptx_header(1, 1) + "1 2 3 4\n1\n1\noops\n", ptx_header(1, 3) + "1 oops 3 4\n1 2 3 4\n",
          ptx_header(1, 2) + "1 2 3 4\n" + ptx_header(1, 1) + "1 2 3 4\n", ptx_header(1, 1) + "1 2 3 4\n5 6 7 8\n"})
        EXPECT_THROW(read_whole(*open_reader(write_file(folder / "b.ptx", damaged), options)), Error) << damaged;
}

// The lines of a text with other ends, which may come after blanks or before empty lines.
std::string with_ends(const std::string& text, const std::string& end)
{
    std::string result;
    for (const char c : text) c == '\n' ? result += end : result += c;
    return result;
}

// Lines end in every way, a mark of the encoding may stand first, and empty lines anywhere.
TEST(Ptx, IsRecognisedByItsLines)
{
    const std::string header = ptx_header(1, 2), text = header + "1 2 3 0.5\n4 5 6 0.25";
    std::vector<std::string> spellings;
    for (const std::string mark : {"", "\xEF\xBB\xBF"})
        for (const std::string end : {"\n", "\r\n", "\r", " \n", "\n\n", "\n \t\n"})
            for (const std::string last : {"", "\n", "\n\n"}) {
                spellings.push_back(mark + with_ends(text + last, end));
                spellings.push_back(mark + end + with_ends(text + last, end));
            }
    TemporaryFolder folder;
    for (const std::string& spelling : spellings) {
        EXPECT_TRUE(looks_like_ptx(write_file(folder / "a", spelling))) << spelling;
        for (const char* name : {"a.ptx", "a.txt"}) {
            const Whole whole = read_text(spelling, name);
            EXPECT_EQ(whole.info.format, "PTX");
            ASSERT_EQ(whole.points.size, 2u) << spelling;
            EXPECT_EQ(whole.position(1), (Vec3d{4, 5, 6}));
            EXPECT_EQ(whole.value("intensity", 0), 0.5);
        }
    }
    EXPECT_TRUE(looks_like_ptx(write_file(folder / "a", header)));
    EXPECT_TRUE(looks_like_ptx(write_file(folder / "a", header.substr(0, header.size() - 1))));  // no end of line
    const std::string many = "1 2 3 4\n";
    std::string long_text = header;
    while (long_text.size() < 10000) long_text += many;
    EXPECT_TRUE(looks_like_ptx(write_file(folder / "a", long_text)));
}

TEST(Ptx, OtherTextIsNoPtx)
{
    const std::string header = ptx_header(1, 2), points = "1 2 3 0.5\n4 5 6 0.25\n";
    const std::vector<std::string> others{
        "",
        "\n",
        "\xEF\xBB\xBF",
        "\xEF",
        "hello\n",
        "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n",  // nine lines
        "1 2\n" + header.substr(2) + points,
        "1\n2\n3\n" + header.substr(4) + points,  // two numbers, or three lines
        "-1" + header.substr(1) + points,
        "1.5" + header.substr(1) + points,
        "1\n2.5" + header.substr(3) + points,
        "x y z\n" + points + points + points + points + points + points,
        ptx_header(1, 2, "1 0 0 0\n0 1 0 0\n0 0 1\n0 0 0 1\n") + points,
        ptx_header(1, 2, "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1 0\n") + points,
        ptx_header(1, 2, "1 0 0 0\n0 1 0 0\n0 0 a 0\n0 0 0 1\n") + points,
        std::string(5000, ' ') + header + points,
        header.substr(0, 20) + std::string(5000, ' ') + header.substr(20)};
    TemporaryFolder folder;
    for (const std::string& other : others)
        EXPECT_FALSE(looks_like_ptx(write_file(folder / "a", other))) << other.substr(0, 200);
}

// The cloud has the columns of all scans, whichever comes first; those that a scan lacks are 0 in it.
TEST(Ptx, ScansMayHaveOtherColumns)
{
    struct Kind {
        const char* line;
        double intensity;
        Vec3d rgb;
    };
    const std::vector<Kind> kinds{{"1 1 1\n", 0, {0, 0, 0}},
                                  {"2 2 2 0.1\n", 0.1, {0, 0, 0}},
                                  {"3 3 3 7 8 9\n", 0, {7, 8, 9}},
                                  {"4 4 4 0.3 40000 500 6\n", 0.3, {40000, 500, 6}}};
    std::vector<std::size_t> order{0, 1, 2, 3};
    do {
        std::string text;
        for (const std::size_t k : order) text += ptx_header(1, 1) + kinds[k].line;
        for (const std::size_t batch : {1, 100}) {
            const Whole whole = read_text(text, "a.ptx", {}, batch);
            EXPECT_EQ(names_of(whole.info.schema), "intensity:f32 rgb:u16x3 scan:u32");
            ASSERT_EQ(whole.points.size, 4u);
            for (std::size_t i = 0; i < 4; ++i) {
                const Kind& kind = kinds[order[i]];
                EXPECT_EQ(whole.position(i)[2], static_cast<double>(order[i] + 1));
                EXPECT_EQ(whole.value("intensity", i), static_cast<float>(kind.intensity)) << text;
                for (std::uint32_t c = 0; c < 3; ++c) EXPECT_EQ(whole.value("rgb", i, c), kind.rgb[c]) << text;
                EXPECT_EQ(whole.value("scan", i), static_cast<double>(i + 1));
            }
        }
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_EQ(names_of(read_text(ptx_header(1, 1) + kinds[0].line, "a.ptx").info.schema), "");
    EXPECT_EQ(names_of(read_text(ptx_header(1, 1) + kinds[2].line, "a.ptx").info.schema), "rgb:u8x3");
    EXPECT_EQ(names_of(read_text(ptx_header(1, 1) + "1 2 3 0.25\n", "a.ptx").info.schema), "intensity:f32");
}

}  // namespace
}  // namespace pcm::test
