// Conversion between all formats: every loss is reported, and a failure leaves nothing behind.

#include "pcm/convert/convert.h"

#include "pcm/build/builder.h"
#include "pcm/io/formats.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/tree/verify.h"
#include "tests/clouds.h"
#include "tests/convert/refusal.h"
#include "tests/memory_reader.h"
#include "tests/outcome.h"
#include "tests/support.h"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

BuildOptions small_chunks()
{
    BuildOptions options;
    options.chunk_points = 1000;
    options.memory_bytes = 64 << 20;
    options.threads = 2;
    return options;
}

ConvertOptions small()
{
    ConvertOptions options;
    options.chunk_points = 1000;
    options.memory_bytes = 64 << 20;
    options.threads = options.write.threads = options.cloud.read.threads = 2;
    return options;
}

MemoryCloud read_file(const fs::path& path)
{
    const auto reader = open_cloud({path});
    return read_all(*reader);
}

bool is_writable(const std::string& extension)
{
    const auto all = writable_extensions();
    return std::find(all.begin(), all.end(), extension) != all.end();
}

bool is_readable(const std::string& extension)
{
    const auto all = readable_extensions();
    return std::find(all.begin(), all.end(), extension) != all.end();
}

bool mentions(const std::vector<std::string>& notes, const std::string& word)
{
    return std::any_of(notes.begin(), notes.end(),
                       [&](const std::string& note) { return note.find(word) != std::string::npos; });
}

bool extension_has_decimals(const std::string& extension)
{
    const Format* const format = format_of_extension(extension);
    return format && format->has(takes_decimals);
}

double user_value(const MemoryCloud& cloud, std::size_t k, std::size_t i, std::uint32_t component)
{
    const Attribute& attribute = cloud.info.schema[k];
    return cloud.points.attributes[k].value(i, component) * attribute.scale + attribute.offset;
}

// Whether `to` has the attribute of `from`, under its name or as one attribute per component.
bool has_attribute(const MemoryCloud& from, std::size_t k, const MemoryCloud& to)
{
    const Attribute& attribute = from.info.schema[k];
    const auto same = [&](std::uint32_t component, const std::string& name, std::uint32_t there) {
        const auto slot = to.info.schema.find(name);
        if (!slot || to.info.schema[*slot].components <= there) return false;
        for (std::size_t i = 0; i < from.points.size; ++i)
            if (user_value(from, k, i, component) != user_value(to, *slot, i, there)) return false;
        return true;
    };
    for (std::uint32_t c = 0; c < attribute.components; ++c)
        if (!same(c, attribute.name, c) && !same(c, attribute.name + "_" + std::to_string(c), 0)) return false;
    return true;
}

std::vector<fs::path> names_in(const fs::path& folder)
{
    std::vector<fs::path> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

// ------------------------------------------------------------------------------------------ formats

enum class Positions { gridded, doubles, floats };

std::string name_of_format(const testing::TestParamInfo<std::tuple<std::string, Positions>>& test)
{
    static const char* const names[] = {"gridded", "doubles", "floats"};
    return std::get<0>(test.param) + "_" + names[static_cast<int>(std::get<1>(test.param))];
}

class EveryFormat : public testing::TestWithParam<std::tuple<std::string, Positions>> {};
INSTANTIATE_TEST_SUITE_P(Convert, EveryFormat,
                         testing::Combine(testing::ValuesIn(writable_extensions()),
                                          testing::Values(Positions::gridded, Positions::doubles, Positions::floats)),
                         name_of_format);

// From a tree to the format and back: positions bit for bit, attributes equal or named in the notes, in the same
// order.
TEST_P(EveryFormat, KeepsPositionsAndAttributesOrReportsIt)
{
    const auto& [extension, positions] = GetParam();
    if (!is_readable(extension)) GTEST_SKIP() << "nothing here reads ." << extension;
    const TemporaryFolder folder;
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    schema.add({"classification", ScalarType::u8, 1, 1, 0, ""});
    schema.add({"gps_time", ScalarType::f64, 1, 1, 0, ""});
    schema.add({"rgb", ScalarType::u16, 3, 1, 0, ""});
    schema.add({"normal", ScalarType::f32, 3, 1, 0, ""});
    schema.add({"height", ScalarType::i16, 1, 0.25, 100, ""});
    schema.add({"weight", ScalarType::f64, 2, 1, 0, ""});
    const Grid grid{{0.01, 0.01, 0.001}, {500000, 4800000, 0}};
    MemoryCloud cloud =
        random_cloud(schema, positions == Positions::gridded ? std::optional<Grid>(grid) : std::nullopt, 3000, 4, 900);
    if (positions == Positions::doubles)  // as surveys print them
        for (auto& axis : cloud.points.xyz)
            for (double& c : axis) c = std::round(c * 1000 + 4.8e9) / 1000;
    if (positions == Positions::floats) {
        cloud.info.position_type = ScalarType::f32;
        for (auto& axis : cloud.points.xyz)
            for (double& c : axis) c = static_cast<double>(static_cast<float>(c));
    }
    MemoryReader reader(cloud);
    build_tree(reader, {"memory"}, folder / "in.pct", small_chunks());
    const MemoryCloud before = read_file(folder / "in.pct");
    const fs::path file = folder / ("out." + extension);
    const Stopwatch watch;
    const ConvertReport report = convert({folder / "in.pct"}, file, small());
    expect_outcome(report.outcome, 3000, 3000, watch);
    EXPECT_EQ(report.points_skipped, 0u);
    EXPECT_EQ(report.bytes, fs::file_size(file));
    const MemoryCloud after = read_file(file);
    ASSERT_EQ(after.points.size, 3000u);
    double error = 0;
    for (std::size_t i = 0; i < before.points.size; ++i) {
        const Vec3d p = position_of(before.points, before.info.grid, i),
                    q = position_of(after.points, after.info.grid, i);
        for (std::size_t a = 0; a < 3; ++a) {
            error = std::max(error, std::fabs(p[a] - q[a]));
            if (before.points.gridded)
                EXPECT_EQ(std::llround((q[a] - grid.offset[a]) / grid.scale[a]), before.points.grid_xyz[a][i]);
        }
    }
    // Text has the decimals that integers on a grid stand for: in double, they differ in the last bit.
    const bool text = extension_has_decimals(extension) && positions == Positions::gridded;
    EXPECT_LE(error - report.outcome.error, text ? 1e-9 : 0);
    EXPECT_LE(report.outcome.error, error);
    // Floats of any size do not fit a 32-bit grid, but its steps are finer than the precision of most of them.
    const bool las = extension == "las" || extension == "laz";
    if (las && positions == Positions::floats)
        EXPECT_LE(error, 3.1e-5);
    else
        EXPECT_EQ(report.outcome.error, 0);
    EXPECT_FALSE(mentions(report.notes, "positions are rounded"));
    for (std::size_t k = 0; k < schema.size(); ++k)
        EXPECT_TRUE(has_attribute(before, k, after) || mentions(report.notes, schema[k].name) ||
                    (schema[k].name == "rgb" && mentions(report.notes, "points were rounded")))
            << schema[k].name;
}

// Formats that keep all types give a tree with exactly the same content.
TEST(Convert, TreesOfFilesOfTreesHaveTheSameContent)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 30000, 1), {{0.01, 0.01, 0.01}, {5e5, 4.8e6, 0}});
    convert({folder / "in.las"}, folder / "in.pct", small());
    const auto before = Tree::open(folder / "in.pct");
    ASSERT_EQ(before->info().points, 30000u);
    for (const std::string extension : {"pct", "bpc", "las", "laz"}) {
        if (extension != "pct" && !is_writable(extension)) continue;
        SCOPED_TRACE(extension);
        const fs::path there = folder / ("there." + extension), back = folder / ("back-" + extension + ".pct");
        EXPECT_EQ(convert({folder / "in.pct"}, there, small()).outcome.error, 0);
        EXPECT_EQ(convert({there}, back, small()).outcome.error, 0);
        const auto after = Tree::open(back);
        EXPECT_EQ(after->info().grid, before->info().grid);
        EXPECT_EQ(after->info().schema, before->info().schema);
        EXPECT_EQ(after->info().points, before->info().points);
        EXPECT_EQ(after->info().content_hash, before->info().content_hash);
        EXPECT_EQ(after->info().wide, before->info().wide);
        EXPECT_TRUE(verify_tree(back).faults.empty());
    }
}

TEST(Convert, AGridSurvivesAWayThroughDoubles)
{
    if (!is_writable("las")) GTEST_SKIP() << "no LAS writer";
    const TemporaryFolder folder;
    const Grid grid{{0.001, 0.002, 0.25}, {500000.125, -4800000.5, 17}};
    write_las(folder / "in.las", records(Shape::volume, 2000, 1), grid);
    convert({folder / "in.las"}, folder / "on.ply", small());
    ASSERT_FALSE(open_cloud({folder / "on.ply"})->info().grid);
    const ConvertReport report = convert({folder / "on.ply"}, folder / "back.las", small());
    EXPECT_EQ(report.outcome.error, 0);
    EXPECT_EQ(report.grid, grid);
    const MemoryCloud in = read_file(folder / "in.las"), back = read_file(folder / "back.las");
    EXPECT_EQ(in.points.grid_xyz, back.points.grid_xyz);
    // A step that the user requests.
    ConvertOptions coarse = small();
    coarse.scale = Vec3d{0.5, 0.5, 0.5};
    const ConvertReport rounded = convert({folder / "on.ply"}, folder / "coarse.las", coarse);
    EXPECT_EQ(open_cloud({folder / "coarse.las"})->info().grid->scale, *coarse.scale);
    EXPECT_GT(rounded.outcome.error, 0);
    EXPECT_LE(rounded.outcome.error, 0.2500001);
}

TEST(Convert, PointsWithoutAFinitePositionAreCountedWhereTheyAreLeftOut)
{
    const TemporaryFolder folder;
    write_ply<double>(folder / "in.ply", {{0, 0, 0}, {NAN, 1, 2}, {1, 2, 3}, {4, INFINITY, 5}});
    for (const std::string extension : {"las", "laz", "pct"}) {
        if (extension != "pct" && !is_writable(extension)) continue;
        const ConvertReport report = convert({folder / "in.ply"}, folder / ("out." + extension), small());
        EXPECT_EQ(report.outcome.points_in, 4u);
        EXPECT_EQ(report.outcome.points_out, 2u);
        EXPECT_EQ(report.points_skipped, 2u);
        EXPECT_TRUE(mentions(report.notes, "2 points without a finite position"));
        EXPECT_EQ(read_file(folder / ("out." + extension)).points.size, 2u);
    }
    const ConvertReport report = convert({folder / "in.ply"}, folder / "all.bpc", small());
    EXPECT_EQ(report.outcome.points_out, 4u);
    EXPECT_EQ(read_file(folder / "all.bpc").points.size, 4u);
}

// Notes that a reader adds while reading are reported, whatever readers are in between.
TEST(Convert, NotesOfTheEndOfAFileAreReported)
{
    const TemporaryFolder folder;
    std::ofstream(folder / "in.csv") << "x,y,z,weight\n1,2,3,4\n5,6,7,\n8,9,10,11\n";
    ConvertOptions part = small();
    part.cloud.selection.where = {parse_condition("x>0")};
    part.cloud.selection.keep = {"weight"};
    for (const ConvertOptions& options : {small(), part})
        for (const char* output : {"out.bpc", "out.pct"}) {
            ConvertOptions again = options;
            again.overwrite = true;
            const ConvertReport report = convert({folder / "in.csv"}, folder / output, again);
            EXPECT_EQ(report.outcome.points_out, 3u);
            EXPECT_TRUE(mentions(report.notes, "1 empty field is NaN"));
        }
}

// ------------------------------------------------------------------------------------------ selection

class FromATree : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 20000, 2), grid_);
        build_tree({folder_ / "in.las"}, folder_ / "in.pct", small_chunks());
    }
    // Compares a file and a tree of the selected points with the points of the source.
    void expect_selected(const ConvertOptions& options, const std::function<bool(const LasRecord&)>& wanted)
    {
        std::vector<std::array<std::int32_t, 3>> expected;
        for (const LasRecord& p : records(Shape::surface, 20000, 2))
            if (wanted(p)) expected.push_back({p.x, p.y, p.z});
        std::sort(expected.begin(), expected.end());
        ASSERT_GT(expected.size(), 0u);
        for (const char* input : {"in.pct", "in.las"})
            for (const char* output : {"out.bpc", "out.pct"}) {
                ConvertOptions again = options;
                again.overwrite = true;
                const ConvertReport report = convert({folder_ / input}, folder_ / output, again);
                EXPECT_EQ(report.outcome.points_out, expected.size());
                const MemoryCloud part = read_file(folder_ / output);
                ASSERT_TRUE(part.info.grid == grid_);
                std::vector<std::array<std::int32_t, 3>> found;
                for (std::size_t i = 0; i < part.points.size; ++i)
                    found.push_back(
                        {part.points.grid_xyz[0][i], part.points.grid_xyz[1][i], part.points.grid_xyz[2][i]});
                std::sort(found.begin(), found.end());
                EXPECT_TRUE(found == expected) << input << " to " << output;
            }
    }
    const Grid grid_{{0.01, 0.01, 0.01}, {5e5, 4.8e6, 0}};
    TemporaryFolder folder_;
};

TEST_F(FromATree, ABox)
{
    ConvertOptions options = small();
    options.cloud.selection.box = Box3d{{5e5 + 100, 4.8e6 + 50, -1e9}, {5e5 + 400, 4.8e6 + 300, 1e9}};
    expect_selected(options, [&](const LasRecord& p) {
        return options.cloud.selection.box->contains(grid_.to_source(Vec3i{p.x, p.y, p.z}));
    });
}

TEST_F(FromATree, Conditions)
{
    ConvertOptions options = small();
    options.cloud.selection.where = {parse_condition("classification=0..9,20"), parse_condition("rgb[0]>=32768")};
    expect_selected(options, [](const LasRecord& p) {
        const int c = p.classification & 31;
        return (c <= 9 || c == 20) && p.red >= 32768;
    });
}

TEST_F(FromATree, ALevelAndANumberOfPoints)
{
    const auto tree = Tree::open(folder_ / "in.pct");
    ConvertOptions options = small();
    options.cloud.level = std::uint16_t(1);
    EXPECT_EQ(convert({folder_ / "in.pct"}, folder_ / "l.bpc", options).outcome.points_out, tree->points_to_level(1));
    options.cloud.level.reset();
    options.cloud.max_points = 5000;
    const std::uint64_t points = convert({folder_ / "in.pct"}, folder_ / "m.bpc", options).outcome.points_out;
    EXPECT_EQ(points, tree->points_to_level(tree->level_with_at_most(5000)));
    EXPECT_LE(points, 5000u);
    options.cloud.max_points.reset();
    options.cloud.level = std::uint16_t(99);
    EXPECT_NE(refusal(ErrorCode::invalid_argument, [&] { convert({folder_ / "in.pct"}, folder_ / "n.bpc", options); })
                  .find("levels 0 to"),
              std::string::npos);
    EXPECT_NE(refusal(ErrorCode::invalid_argument, [&] { convert({folder_ / "in.las"}, folder_ / "n.bpc", options); })
                  .find("in.las"),
              std::string::npos);
}

TEST_F(FromATree, SomeAttributes)
{
    ConvertOptions options = small();
    options.cloud.selection.keep = {"rgb", "intensity"};
    for (const char* output : {"a.bpc", "a.pct"}) {
        convert({folder_ / "in.pct"}, folder_ / output, options);
        const auto reader = open_cloud({folder_ / output});
        ASSERT_EQ(reader->info().schema.size(), 2u);
        EXPECT_EQ(reader->info().schema[0].name, "intensity");
        EXPECT_EQ(reader->info().schema[1].name, "rgb");
    }
}

TEST_F(FromATree, TreesAndFilesTogetherAreOneCloud)
{
    write_las(folder_ / "more.las", records(Shape::volume, 1000, 3), grid_);
    fs::create_directory(folder_ / "tiles");
    write_las(folder_ / "tiles" / "a.las", records(Shape::volume, 500, 4), grid_);
    write_las(folder_ / "tiles" / "b.las", records(Shape::volume, 300, 5), grid_);
    const ConvertReport report =
        convert({folder_ / "in.pct", folder_ / "more.las", folder_ / "tiles"}, folder_ / "all.pct", small());
    EXPECT_EQ(report.outcome.points_out, 21800u);
    const auto tree = Tree::open(folder_ / "all.pct");
    EXPECT_EQ(tree->info().sources, (std::vector<std::string>{"in.pct", "more.las", "a.las", "b.las"}));
    EXPECT_EQ(tree->info().grid, grid_);
    ConvertOptions options = small();
    options.cloud.selection.where = {parse_condition("intensity<30000")};
    options.cloud.selection.box = Box3d{{5e5, 4.8e6, -1e9}, {5e5 + 500, 4.8e6 + 500, 1e9}};
    const auto in_parts = open_cloud({folder_ / "in.pct", folder_ / "more.las", folder_ / "tiles"}, options.cloud);
    const auto in_whole = open_cloud({folder_ / "all.pct"}, options.cloud);
    const std::size_t points = read_all(*in_parts).points.size;
    EXPECT_GT(points, 1000u);
    EXPECT_EQ(points, read_all(*in_whole).points.size);
}

// ------------------------------------------------------------------------------------------ refusals

TEST_F(FromATree, NeverOverwritesWhatItReads)
{
    fs::create_hard_link(folder_ / "in.las", folder_ / "other.bpc");
    fs::create_directory_symlink(folder_ / "in.pct", folder_ / "link.pct");
    ConvertOptions options = small();
    options.overwrite = true;
    for (const auto& [input, output] : std::vector<std::pair<std::string, std::string>>{{"in.las", "other.bpc"},
                                                                                        {"in.pct", "in.pct"},
                                                                                        {"in.pct", "link.pct"},
                                                                                        {"in.pct/index.pct", "in.pct"},
                                                                                        {"in.pct", "in.pct/"}})
        EXPECT_NE(refusal(ErrorCode::invalid_argument,
                          [&, i = input, o = output] { convert({folder_ / i}, folder_ / o, options); })
                      .find("the input"),
                  std::string::npos);
    EXPECT_EQ(Tree::open(folder_ / "in.pct")->info().points, 20000u);
}

TEST_F(FromATree, NeverOverwritesUnasked)
{
    std::ofstream(folder_ / "out.bpc") << "precious";
    refusal(ErrorCode::exists, [&] { convert({folder_ / "in.las"}, folder_ / "out.bpc", small()); });
    EXPECT_EQ(fs::file_size(folder_ / "out.bpc"), 8u);
    fs::create_directory(folder_ / "folder.bpc");
    ConvertOptions options = small();
    options.overwrite = true;
    refusal(ErrorCode::exists, [&] { convert({folder_ / "in.las"}, folder_ / "folder.bpc", options); });
    convert({folder_ / "in.las"}, folder_ / "out.bpc", options);
    EXPECT_EQ(read_file(folder_ / "out.bpc").points.size, 20000u);
    refusal(ErrorCode::exists, [&] { convert({folder_ / "in.las"}, folder_ / "in.pct", small()); });
}

TEST_F(FromATree, OptionsThatWouldDoNothingAreRefused)
{
    ConvertOptions grid = small(), decimals = small(), ascii = small(), box = small();
    grid.write.grid = grid_;
    decimals.write.decimals = 3;
    ascii.write.ascii = true;
    box.cloud.selection.box = Box3d{{0, 9, 0}, {1, 8, 1}};
    const auto what = [&](const ConvertOptions& options) {
        return refusal(ErrorCode::invalid_argument,
                       [&] { convert({folder_ / "in.las"}, folder_ / "out.bpc", options); });
    };
    EXPECT_NE(what(grid).find("grid"), std::string::npos);
    EXPECT_NE(what(decimals).find("decimals"), std::string::npos);
    EXPECT_NE(what(ascii).find("ascii"), std::string::npos);
    EXPECT_NE(what(box).find("along y"), std::string::npos);
    EXPECT_NE(refusal(ErrorCode::unsupported, [&] { convert({folder_ / "in.las"}, folder_ / "out.stl", small()); })
                  .find("writable are"),
              std::string::npos);
    EXPECT_NE(refusal(ErrorCode::unsupported, [&] { convert({folder_ / "in.las"}, folder_ / "out", small()); })
                  .find("no extension"),
              std::string::npos);
}

TEST_F(FromATree, CancelledOrBrokenOffLeavesNothing)
{
    const std::vector<fs::path> before = names_in(folder_.path());
    for (const char* output : {"out.bpc", "out.pct", "out.ply"}) {
        ConvertOptions options = small();
        int calls = 0;
        // The first calls come at most a tenth of a second apart: wait for the second.
        options.progress = [&](const ProgressUpdate& update) { return ++calls < 1 || update.fraction == 0; };
        options.cloud.selection.where = {parse_condition("intensity>=0")};
        try {
            convert({folder_ / "in.las"}, folder_ / output, options);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::cancelled);
        }
        EXPECT_GT(calls, 0);
        if (!fs::exists(folder_ / output)) EXPECT_EQ(names_in(folder_.path()), before);
        fs::remove_all(folder_ / output);
    }
    // A chunk that cannot be read, in the middle of the output.
    const Node node = Tree::open(folder_ / "in.pct")->nodes().back();
    {
        std::fstream file(folder_ / "in.pct" / ("chunks-00" + std::to_string(node.extent.file) + ".bpc"),
                          std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(node.extent.offset));
        file.write("damaged", 7);
    }
    for (const std::string& extension : writable_extensions()) {
        refusal(ErrorCode::corrupt, [&] { convert({folder_ / "in.pct"}, folder_ / ("out." + extension), small()); });
        EXPECT_EQ(names_in(folder_.path()), before);
    }
    refusal(ErrorCode::corrupt, [&] { convert({folder_ / "in.pct"}, folder_ / "out.pct", small()); });
    EXPECT_EQ(names_in(folder_.path()), before);
}

TEST_F(FromATree, ProgressOnlyGrows)
{
    double last = -1;
    ConvertOptions options = small();
    options.progress = [&](const ProgressUpdate& update) {
        EXPECT_GE(update.fraction, last);
        EXPECT_LE(update.fraction, 1);
        last = update.fraction;
        return true;
    };
    convert({folder_ / "in.pct"}, folder_ / "out.bpc", options);
    EXPECT_EQ(last, 1);
}

}  // namespace
