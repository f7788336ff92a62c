// The lines before the first row of a text file, missing values, columns of words, and lines that are skipped: no row
// is lost without a count and an example.
#include "pcm/io/text/text_fields.h"
#include "pcm/io/text/text_reader.h"

#include "tests/io/text/read_text.h"

#include <cmath>

namespace pcm::test {
namespace {

Whole read_skipping(const std::string& text, const char* name = "a.xyz",
                    std::size_t batch_points = default_batch_points)
{
    TemporaryFolder folder;
    ReadOptions options;
    options.skip_bad_lines = true;
    const auto reader = open_reader(write_file(folder / name, text), options);
    Whole whole = read_whole(*reader, batch_points);
    whole.info = reader->info();
    return whole;
}

TEST(TextHead, ARowWithABadValueIsNoHeader)
{
    const std::string rows = "4 5 6\n7 8 9\n";
    for (const char* word : {"NA", "-", "null", "*", "***", "N/A", "?", "none", "12x", "1.2.3"}) {
        for (const std::size_t bad_rows : {1, 3, 70}) {
            std::string head;
            for (std::size_t i = 0; i < bad_rows; ++i) head += std::string("1 2 ") + word + "\n";
            const Error error = refusal(head + rows);
            EXPECT_TRUE(mentions(error.what(), "line 1: found '" + std::string(word) + "' in column 3 (z)"))
                << error.what();
            EXPECT_TRUE(mentions(error.what(), "--skip-bad-lines")) << error.what();
            const Whole whole = read_skipping(head + rows);
            EXPECT_EQ(whole.points.size, 2u) << word;
            EXPECT_EQ(whole.position(0), (Vec3d{4, 5, 6}));
            EXPECT_EQ(whole.info.skipped.lines, bad_rows);
        }
    }
    // NaN is a number, as anywhere in the file.
    for (const char* word : {"nan", "1.#QNAN", "NaN"})
        EXPECT_EQ(read_text(std::string("1 2 ") + word + "\n" + rows).points.size, 3u) << word;
    // With other separators, too few fields, and behind a header.
    EXPECT_TRUE(mentions(refusal("1;2;NA\n4;5;6\n").what(), "line 1"));
    EXPECT_TRUE(mentions(refusal("1,2\n4,5,6\n").what(), "line 1: found 2 fields, expected 3"));
    EXPECT_TRUE(mentions(refusal("x,y,z\n1,2,oops\n4,5,6\n").what(), "line 2: found 'oops'"));
    EXPECT_EQ(read_text("1 2 NA\n4 5 6\n", "a.xyz", {{}, 1, {}, {}}).points.size, 1u);
    // An error value of a spreadsheet is not a comment.
    EXPECT_TRUE(mentions(refusal("#N/A,2,3\n4,5,6\n4,5,6\n").what(), "line 1: found '#N/A' in column 1"));
    EXPECT_TRUE(mentions(refusal(";2;3\n4;5;6\n4;5;6\n").what(), "line 1: found '' in column 1"));
}

TEST(TextHead, MissingValuesOfAttributesAreNaN)
{
    const Whole whole = read_text("1 2 3 NA 5\n4 5 6 7 8\n7 8 9 - 1\n");
    EXPECT_EQ(names_of(whole.info.schema), "column_4:f64 column_5:f64");
    EXPECT_TRUE(std::isnan(whole.value("column_4", 0)));
    EXPECT_EQ(whole.value("column_4", 1), 7);
    EXPECT_EQ(notes_after("1 2 3 NA 5\n4 5 6 7 8\n7 8 9 - 1\n", "a.xyz").back(),
              "2 missing values are NaN, the first is 'NA' in line 1, column 4 (column_4)");
    // In a column of whole numbers they are faults.
    std::string many;
    for (int i = 0; i < 300000; ++i) many += "1 2 3 10 20 30\n";
    EXPECT_TRUE(mentions(refusal(many + "1 2 3 NA 20 30\n").what(), "line 300001: found 'NA' in column 4 (r)"));
    // A last column without any value is not a separator at the end of the line.
    EXPECT_TRUE(std::isnan(read_text("x,y,z,a\n1,2,3,NA\n1,2,3,NA\n", "a.csv").value("a", 1)));
}

// Also with few rows, and by the content alone.
TEST(TextHead, SeparatorsAtTheEndsOfLinesAreNoColumn)
{
    for (const char* name : {"a.csv", "a.unknown"})
        for (const std::string separator : {",", ";", "\t"}) {
            std::string text;
            for (const char* row : {"1.5,2,3,7,", "4,5,6,8,", "7,8,9,9,"})
                for (const char c : row + std::string("\n")) text += c == ',' ? separator : std::string(1, c);
            const auto cloud = read_text(text, name);
            EXPECT_EQ(cloud.points.size, 3u) << name << separator;
            EXPECT_EQ(cloud.info.schema.size(), 1u) << name << separator;
        }
}

TEST(TextHead, TitlesAndCommentsAreLeftOut)
{
    EXPECT_EQ(read_text("; made by hand\n1 2 3\n; and more\n# x\n// y\n4 5 6\n").points.size, 2u);
    const auto notes = notes_after("Survey of the old mill\nof 2021\n\n1 2 3\n4 5 6\n", "a.xyz");
    EXPECT_TRUE(
        any_mentions(notes, "2 lines before the first point are not read, the first is line 1: 'Survey of the"));
    EXPECT_FALSE(any_mentions(notes_after("# c\nx y z\n1 2 3\n", "a.xyz"), "before the first point"));
    EXPECT_FALSE(any_mentions(notes_after("2\n1 2 3\n4 5 6\n", "a.pts"), "before the first point"));
    // A comment in words of the field is no header of another number of columns.
    EXPECT_EQ(read_text("# east and north and height\n1 2 3\n").points.size, 1u);
}

TEST(TextHead, NamesThatAreNotUnderstoodAreRefused)
{
    for (const char* text : {"foo,bar,baz\n1,2,3\n", "A;B;C\n1;2;3\n4;5;6\n", "x,north,z\n1,2,3\n", "x,y,q\n1,2,3\n",
                             "R,H,Z\n1,2,3\n", "Point,A,B,C,Code\n1,2,3,4,5\n", "p q r\n1 2 3\n"}) {
        const Error error = refusal(text, "a.csv");
        EXPECT_TRUE(mentions(error.what(), "line 1") && mentions(error.what(), "--columns")) << error.what();
        TextLayout layout;
        layout.columns = std::string(text)[0] == 'P' ? parse_columns("- x y z -") : parse_columns("x y z");
        EXPECT_GE(read_text(text, "a.csv", layout).points.size, 1u) << text;
    }
}

// In a folder of inputs. Most fields of a row may be words, if names say which columns are coordinates.
TEST(TextHead, PointsAreKnownFromOtherTables)
{
    const TemporaryFolder folder;
    const auto looks = [&](const std::string& text) { return looks_like_points(write_file(folder / "a.csv", text)); };
    EXPECT_TRUE(looks("1,2,3\n4,5,6\n"));
    EXPECT_TRUE(looks("x,y,z,a,b,c,d\n1,2,3,oak,old,tall,wet\n4,5,6,elm,new,low,dry\n"));
    EXPECT_FALSE(looks("1,2,3,oak,old,tall,wet\n4,5,6,elm,new,low,dry\n"));
    EXPECT_FALSE(looks("1,oak\n2,elm\n"));
}

TEST(TextHead, ColumnsOfWordsAreCounted)
{
    const std::string pnezd = "P,N,E,Z,D\nA1,100,200,5,TREE\n2,101,201,6,\n3,102,202,7,KERB\n";
    const Whole whole = read_text(pnezd, "a.csv");
    ASSERT_EQ(whole.points.size, 3u);
    EXPECT_EQ(whole.position(0), (Vec3d{200, 100, 5}));
    EXPECT_EQ(whole.info.schema.size(), 0u);
    const auto notes = notes_after(pnezd, "a.csv");
    EXPECT_TRUE(any_mentions(notes, "names of columns understood: N→y, E→x"));
    EXPECT_TRUE(any_mentions(notes, "column 1 (P) holds text, which is not read: 3 fields, the first is 'A1'"));
    EXPECT_TRUE(any_mentions(notes, "column 5 (D) holds text, which is not read: 2 fields, the first is 'TREE'"));
    EXPECT_EQ(describe(*whole.info.text_layout), "- y x z -, separated by commas, 1 line skipped");
    // The layout that is reported reads the same, and says nothing more.
    EXPECT_EQ(read_text(pnezd, "a.csv", *whole.info.text_layout).position(2), (Vec3d{202, 102, 7}));
    // Numbers of points stay an attribute.
    EXPECT_EQ(names_of(read_text("P,N,E,Z,D\n1,100,200,5,TREE\n2,1,2,3,\n", "a.csv").info.schema), "P:f64");
    // Without names, or with one bad word, nothing is guessed.
    EXPECT_TRUE(mentions(refusal("1,100,200,5,TREE\n2,101,201,6,KERB\n", "a.csv").what(), "column 5"));
    std::string many = "x y z intensity\n";
    for (int i = 0; i < 20; ++i) many += "1 2 3 4\n";
    EXPECT_TRUE(mentions(refusal(many + "1 2 3 oops\n").what(), "line 22: found 'oops' in column 4 (intensity)"));
    TextLayout layout;
    layout.columns = parse_columns("- y x z code");
    EXPECT_EQ(read_text("1,100,200,5,TREE\n2,101,201,6,KERB\n", "a.csv", layout).position(1), (Vec3d{201, 101, 6}));
}

TEST(TextHead, BadLinesAreSkippedAndCounted)
{
    std::string text = "x y z r\n";
    std::size_t good = 0;
    for (int i = 0; i < 5000; ++i) {
        const bool bad = i % 7 == 3;
        text += bad ? (i % 2 ? "1 2\n" : "1 oops 3 4\n") : std::to_string(i) + " 2 3 4\n";
        good += !bad;
    }
    for (const std::size_t batch : {1, 7, 1000, 100000}) {
        const Whole whole = read_skipping(text, "a.xyz", batch);
        EXPECT_EQ(whole.points.size, good);
        EXPECT_EQ(whole.info.skipped.lines, 5000 - good);
        EXPECT_EQ(whole.position(3)[0], 4);
    }
    EXPECT_TRUE(any_mentions(read_skipping(text).info.notes,
                             "bad lines were skipped, the first is line 5: found 2 fields, expected 4"));
    // Lines at the end, and a list whose promise counts them.
    EXPECT_EQ(read_skipping("1 2 3\nx\ny\n").points.size, 1u);
    EXPECT_EQ(read_skipping("3\n1 2 3\n1 oops 3\n4 5 6\n1\n7 8 9\n", "a.pts").points.size, 3u);
    TemporaryFolder folder;
    ReadOptions options;
    options.skip_bad_lines = true;
    const auto path = write_file(folder / "short.pts", "4\n1 2 3\n1 oops 3\n4 5 6\n");
    EXPECT_EQ(error_of([&] { read_whole(*open_reader(path, options)); }).code(), ErrorCode::truncated);
    // A number that does not fit the type found for its column is data: it is not skipped.
    std::string colours;
    for (int i = 0; i < 300000; ++i) colours += "1 2 3 10 20 30\n";
    const auto wide = write_file(folder / "wide.xyz", colours + "1 2 3 256 20 30\n");
    EXPECT_TRUE(
        mentions(error_of([&] { read_whole(*open_reader(wide, options)); }).what(), "line 300001: found '256'"));
}

TEST(TextHead, FieldsAreNumbersMissingOrWords)
{
    for (const char* mark :
         {"NA", "na", "N/A", "#N/A", "Null", "NONE", "nil", "NoData", "missing", "-", "--", "*", "**", "?", "\\N"})
        EXPECT_TRUE(is_no_data(mark)) << mark;
    for (const char* other : {"", "nan", "0", "-1", "-9999", "n", "word", "-*", "nothing"})
        EXPECT_FALSE(is_no_data(other)) << other;
    const FieldCounts counts = count_fields({"1", "", "NA", "x", "nan"}, '.');
    EXPECT_EQ(counts.fields, 5u);
    EXPECT_EQ(counts.numbers, 2u);
    EXPECT_EQ(counts.missing, 2u);
    EXPECT_EQ(counts.words, 1u);
    EXPECT_TRUE(counts.value_first);
    EXPECT_TRUE(count_fields({"x", "1", "2"}, '.').like_a_row(3));
    EXPECT_FALSE(count_fields({"x", "1", "2"}, '.').like_a_row(4));  // "offset 1 2"
    EXPECT_FALSE(count_fields({"x", "y", "1", "2"}, '.').like_a_row(4));
    EXPECT_FALSE(count_fields({"5"}, '.').like_a_row(3));
    EXPECT_FALSE(count_fields({"-", "-", "-"}, '.').like_a_row(3));
}

}  // namespace
}  // namespace pcm::test
