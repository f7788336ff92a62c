// Several clouds as one, against a merge by hand.

#include "pcm/io/pipe/merged_reader.h"

#include "pcm/system/error.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;

Schema schema_of(const std::vector<Attribute>& attributes)
{
    Schema schema;
    for (const Attribute& attribute : attributes) schema.add(attribute);
    return schema;
}

std::vector<MergedReader::Source> sources_of(const std::vector<MemoryCloud>& clouds, bool seekable = true)
{
    std::vector<MergedReader::Source> sources;
    for (std::size_t i = 0; i < clouds.size(); ++i)
        sources.push_back(
            {"tile" + std::to_string(i) + ".las", [&cloud = clouds[i], seekable]() -> std::unique_ptr<PointReader> {
                 return std::make_unique<MemoryReader>(cloud, seekable);
             }});
    return sources;
}

bool mentions(const std::vector<std::string>& notes, const std::vector<std::string>& words)
{
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
        return std::all_of(words.begin(), words.end(),
                           [&](const std::string& word) { return note.find(word) != std::string::npos; });
    });
}

const Grid millimetres{{0.001, 0.001, 0.001}, {500000, 4800000, 0}};

// Random schemas of a few names and kinds: each point keeps its bytes under the name that its kind was given, and has
// zeros everywhere else.
TEST(MergedReader, EveryPointKeepsItsPositionAndAttributesWhateverTheSchemas)
{
    const std::vector<Attribute> kinds = {
        {"a", ScalarType::u8, 1, 1, 0, ""},      {"a", ScalarType::u16, 1, 1, 0, "other"},
        {"a", ScalarType::u16, 1, 2, 0, ""},     {"a", ScalarType::u16, 1, 2, 5, ""},
        {"a", ScalarType::u8, 3, 1, 0, ""},      {"b", ScalarType::f64, 1, 1, 0, ""},
        {"b", ScalarType::f32, 1, 1, 0, ""},     {"c", ScalarType::i64, 2, 1, 0, ""},
        {"a_u16", ScalarType::f32, 1, 1, 0, ""}, {"a_u16", ScalarType::u16, 1, 1, 0, ""}};
    std::mt19937_64 random(1);
    for (int round = 0; round < 60; ++round) {
        std::vector<MemoryCloud> clouds;
        std::uint64_t points = 0;
        const bool one_grid = round % 3 == 0, mixed = round % 3 == 2;
        for (std::size_t f = 0, files = 1 + random() % 6; f < files; ++f) {
            Schema schema;
            for (const Attribute& kind : kinds)
                if (random() % 3 == 0 && !schema.find(kind.name)) schema.add(kind);
            Grid grid = millimetres;
            if (!one_grid) grid.offset[0] += static_cast<double>(f);
            const std::size_t count = random() % 500;
            clouds.push_back(
                random_cloud(schema, mixed && f % 2 ? std::nullopt : std::optional<Grid>(grid), count, random()));
            points += count;
        }
        MergedReader reader(sources_of(clouds));
        const MemoryCloud merged = read_all(reader, 1 + random() % 300);
        ASSERT_EQ(merged.info.points, points);
        ASSERT_EQ(merged.points.size, points);
        EXPECT_EQ(merged.info.grid.has_value(), one_grid || clouds.size() == 1);
        EXPECT_DOUBLE_EQ(reader.fraction_read(), 1);

        // Which attribute of the merged cloud holds kind k of a file: found by its bytes, and the same for all files.
        std::map<std::string, std::string> name_of_kind;
        std::size_t start = 0;
        for (const MemoryCloud& cloud : clouds) {
            std::vector<bool> used(merged.info.schema.size(), false);
            for (std::size_t k = 0; k < cloud.info.schema.size(); ++k) {
                const Attribute& kind = cloud.info.schema[k];
                const std::string key = kind.name + std::string(name_of(kind.type)) + std::to_string(kind.components) +
                                        "*" + std::to_string(kind.scale) + "+" + std::to_string(kind.offset);
                std::optional<std::size_t> slot;
                for (std::size_t m = 0; m < merged.info.schema.size() && !slot; ++m) {
                    const Attribute& there = merged.info.schema[m];
                    if (used[m] || there.name.rfind(kind.name, 0) != 0 || there.type != kind.type ||
                        there.components != kind.components || there.scale != kind.scale || there.offset != kind.offset)
                        continue;
                    bool same = true;
                    for (std::size_t i = 0; i < cloud.points.size && same; ++i)
                        same =
                            bytes_of(cloud.points.attributes[k], i) == bytes_of(merged.points.attributes[m], start + i);
                    if (same) slot = m;
                }
                ASSERT_TRUE(slot) << "round " << round << ", " << key;
                used[*slot] = true;
                if (cloud.points.size < 8) continue;  // bytes of few points can be equal by chance
                const auto [known, is_new] = name_of_kind.try_emplace(key, merged.info.schema[*slot].name);
                EXPECT_EQ(known->second, merged.info.schema[*slot].name) << key;
            }
            for (std::size_t i = 0; i < cloud.points.size; ++i) {
                EXPECT_EQ(position_of(cloud.points, cloud.info.grid, i),
                          position_of(merged.points, merged.info.grid, start + i));
                for (std::size_t m = 0; m < merged.info.schema.size(); ++m)
                    if (!used[m]) {
                        const std::string bytes = bytes_of(merged.points.attributes[m], start + i);
                        ASSERT_EQ(bytes, std::string(bytes.size(), '\0'));
                    }
            }
            start += cloud.points.size;
        }
    }
}

TEST(MergedReader, KindsOfOneNameAreKeptApartHoweverMany)
{
    std::vector<MemoryCloud> clouds;
    for (const Attribute& kind :
         {Attribute{"time", ScalarType::f64, 1, 1, 0, ""}, Attribute{"time", ScalarType::f32, 1, 1, 0, ""},
          Attribute{"time", ScalarType::f32, 1, 2, 0, ""}, Attribute{"time", ScalarType::f32, 2, 1, 0, ""}})
        clouds.push_back(random_cloud(schema_of({kind}), millimetres, 10, 7));
    const MergedReader reader(sources_of(clouds));
    std::vector<std::string> names;
    for (const Attribute& attribute : reader.info().schema) names.push_back(attribute.name);
    EXPECT_EQ(names, (std::vector<std::string>{"time", "time_f32", "time_f32_2", "time_f32_3"}));
    EXPECT_TRUE(mentions(reader.info().notes, {"'time'", "'time_f32_3'", "tile3.las"}));
}

TEST(MergedReader, NotesOfAThousandTilesAreFew)
{
    std::vector<MemoryCloud> clouds;
    const Schema with =
        schema_of({{"intensity", ScalarType::u16, 1, 1, 0, ""}, {"gps_time", ScalarType::f64, 1, 1, 0, ""}});
    const Schema without = schema_of({{"intensity", ScalarType::u16, 1, 1, 0, ""}});
    for (int i = 0; i < 1000; ++i) {
        clouds.push_back(random_cloud(i % 2 ? with : without, millimetres, 1, 1));
        clouds.back().info.notes = {"the header is odd", "a note of its own: " + std::to_string(i)};
        clouds.back().info.metadata = {{"same", {std::byte{1}}}, {"two", {static_cast<std::byte>(i % 2)}}};
    }
    const MergedReader reader(sources_of(clouds));
    EXPECT_LT(reader.info().notes.size(), 60u);
    EXPECT_TRUE(mentions(reader.info().notes, {"gps_time", "500 of 1,000", "tile0.las", "497 more"}));
    EXPECT_TRUE(mentions(reader.info().notes, {"the header is odd", "tile0.las, tile1.las, tile2.las and 997 more"}));
    EXPECT_TRUE(mentions(reader.info().notes, {"more notes about files"}));
    EXPECT_EQ(reader.info().metadata.size(), 3u);
}

TEST(MergedReader, ASingleFileIsUnchanged)
{
    const std::vector<MemoryCloud> clouds = {
        random_cloud(schema_of({{"a", ScalarType::u8, 1, 1, 0, ""}}), millimetres, 10, 1)};
    MemoryCloud noted = clouds[0];
    noted.info.notes = {"something"};
    noted.info.promised_box = Box3d{{0, 0, 0}, {1, 1, 1}};
    const std::vector<MemoryCloud> one = {noted};
    const MergedReader reader(sources_of(one));
    EXPECT_EQ(reader.info().notes, noted.info.notes);
    EXPECT_EQ(reader.info().format, noted.info.format);
    EXPECT_TRUE(reader.info().grid == noted.info.grid);
    EXPECT_TRUE(reader.info().promised_box == noted.info.promised_box);
}

TEST(MergedReader, SaysWhichGridDoublesAreNear)
{
    const auto near_grid_of = [](Grid second) {
        const std::vector<MemoryCloud> clouds = {random_cloud({}, millimetres, 3, 1), random_cloud({}, second, 3, 1)};
        return MergedReader(sources_of(clouds)).info().near_grid;
    };
    Grid whole = millimetres, half = millimetres, coarse = millimetres, far = millimetres;
    whole.offset = {501000.001, 4799000, 12.345};
    half.offset[2] = 0.0005;
    coarse.scale[1] = 0.01;
    far.offset[0] = 1e14;
    EXPECT_TRUE(near_grid_of(whole) == millimetres);
    EXPECT_FALSE(near_grid_of(half));
    EXPECT_FALSE(near_grid_of(coarse));
    EXPECT_FALSE(near_grid_of(far));
    // Along any axis, to either side: whole steps up to rounding, and positions of 32 bits that stay below 2^50 steps.
    const auto are_near = [](std::size_t axis, double from, double to) {
        Grid first{{1, 1, 1}, {0, 0, 0}}, second = first;
        first.offset[axis] = from;
        second.offset[axis] = to;
        const std::vector<MemoryCloud> clouds = {random_cloud({}, first, 3, 1), random_cloud({}, second, 3, 1)};
        return MergedReader(sources_of(clouds)).info().near_grid.has_value();
    };
    const double most = 0x1p50 - 0x1p32;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const double side : {1.0, -1.0}) {
            EXPECT_TRUE(are_near(axis, 0, side * 0.9e-6));
            EXPECT_FALSE(are_near(axis, 0, side * 1.1e-6));
            EXPECT_FALSE(are_near(axis, 1, side * 0.5));
            EXPECT_TRUE(are_near(axis, 0, side * (most - 1)));
            EXPECT_FALSE(are_near(axis, 0, side * most));
            EXPECT_FALSE(are_near(axis, side * most, 0));
        }
}

// Tiles of grids that differ by whole steps, each with the box that its header promises.
std::vector<MemoryCloud> tiles_of_several_grids()
{
    std::vector<MemoryCloud> clouds;
    for (int i = 0; i < 4; ++i) {
        Grid grid = millimetres;
        grid.offset = {500000 + 250.0 * i, 4800000 - 0.001 * i, i == 2 ? -12.345 : 0};
        clouds.push_back(random_cloud({}, grid, i == 3 ? 0 : 300, static_cast<std::uint64_t>(i)));
        for (auto& column : clouds.back().points.grid_xyz)
            for (std::int32_t& q : column) q /= 2;
        Box3d box;
        for (std::size_t k = 0; k < clouds.back().points.size; ++k)
            box.extend(grid.to_source(Vec3i{clouds.back().points.grid_xyz[0][k], clouds.back().points.grid_xyz[1][k],
                                            clouds.back().points.grid_xyz[2][k]}));
        if (i < 3) clouds.back().info.promised_box = box;
    }
    return clouds;
}

TEST(MergedReader, KeepsTheIntegersOfTilesWithOffsetsOfTheirOwn)
{
    const std::vector<MemoryCloud> clouds = tiles_of_several_grids();
    for (const bool seekable : {true, false}) {
        MergedReader reader(sources_of(clouds, seekable));
        ASSERT_TRUE(reader.can_keep_integers());
        EXPECT_FALSE(reader.info().grid);
        const MemoryCloud doubles = read_all(reader, 70);
        reader.keep_integers(true);
        ASSERT_TRUE(reader.info().grid == millimetres);
        EXPECT_EQ(reader.info().position_type, ScalarType::i32);
        const MemoryCloud integers = read_all(reader, 64);
        ASSERT_EQ(integers.points.size, 900u);
        ASSERT_EQ(doubles.points.size, 900u);
        double error = 0;
        for (std::size_t i = 0; i < 900; ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                const double place = millimetres.to_source(integers.points.grid_xyz[a][i], a);
                error = std::max(error, std::fabs(place - doubles.points.xyz[a][i]));
            }
        EXPECT_EQ(reader.info().move_error, error);
        EXPECT_LT(error, 2e-9);
        if (seekable) {
            reader.seek(301);
            EXPECT_EQ(read_all(reader).points.grid_xyz[2][0], integers.points.grid_xyz[2][301]);
        }
        reader.keep_integers(false);
        EXPECT_EQ(read_all(reader).points.xyz[1], doubles.points.xyz[1]);
        EXPECT_EQ(reader.info().move_error, 0);
    }
}

TEST(MergedReader, KeepsIntegersOnlyWhereHeadersPromiseThatTheyFit)
{
    const std::vector<MemoryCloud> all = tiles_of_several_grids();
    const auto keeps = [&](const std::function<void(std::vector<MemoryCloud>&)>& change) {
        std::vector<MemoryCloud> clouds = all;
        change(clouds);
        return MergedReader(sources_of(clouds)).can_keep_integers();
    };
    EXPECT_TRUE(keeps([](auto&) {}));
    EXPECT_FALSE(keeps([](auto& clouds) { clouds.resize(1); }));  // has a grid anyway
    EXPECT_FALSE(keeps([](auto& clouds) { clouds[1].info.promised_box.reset(); }));
    EXPECT_FALSE(keeps([](auto& clouds) { clouds[1].info.promised_box->max[0] = 3e6; }));
    EXPECT_FALSE(keeps([](auto& clouds) { clouds[1].info.grid->offset[0] += 0.0005; }));
    // The header is wrong: a point is farther away than it promises.
    std::vector<MemoryCloud> clouds = all;
    clouds[2].points.grid_xyz[0][7] = std::numeric_limits<std::int32_t>::max();
    MergedReader reader(sources_of(clouds, false));
    reader.keep_integers(true);
    EXPECT_THROW(read_all(reader, 64), IntegersLost);
    reader.keep_integers(false);
    const MemoryCloud doubles = read_all(reader);
    ASSERT_EQ(doubles.points.size, 900u);
    EXPECT_EQ(doubles.points.xyz[0][607], clouds[2].info.grid->to_source(std::numeric_limits<std::int32_t>::max(), 0));
}

TEST(MergedReader, SeeksAcrossFiles)
{
    std::vector<MemoryCloud> clouds;
    for (const std::size_t count : {100u, 0u, 50u, 1u})
        clouds.push_back(random_cloud(schema_of({{"a" + std::to_string(count), ScalarType::u32, 1, 1, 0, ""}}),
                                      millimetres, count, count));
    MergedReader reader(sources_of(clouds));
    const MemoryCloud all = read_all(reader, 64);
    ASSERT_EQ(all.points.size, 151u);
    std::mt19937_64 random(3);
    for (int i = 0; i < 100; ++i) {
        const std::uint64_t at = random() % 152;
        reader.seek(at);
        const MemoryCloud rest = read_all(reader, 1 + random() % 70);
        ASSERT_EQ(rest.points.size, 151 - at);
        for (std::size_t k = 0; k < rest.points.size; ++k) {
            ASSERT_EQ(rest.points.grid_xyz[0][k], all.points.grid_xyz[0][at + k]);
            for (std::size_t c = 0; c < rest.points.attributes.size(); ++c)
                ASSERT_EQ(bytes_of(rest.points.attributes[c], k), bytes_of(all.points.attributes[c], at + k));
        }
    }
    EXPECT_THROW(reader.seek(152), Error);
    MergedReader streams(sources_of(clouds, false));
    EXPECT_FALSE(streams.seekable());
    EXPECT_THROW(streams.seek(0), Error);
}

// Readers that can seek, and others; all sources are read again after a seek.
TEST(MergedReader, ReadsSomeSourcesAlone)
{
    std::vector<MemoryCloud> clouds;
    for (const std::size_t count : {100u, 0u, 50u, 1u}) clouds.push_back(random_cloud({}, millimetres, count, count));
    const std::array<std::size_t, 5> begins{0, 100, 100, 150, 151};
    for (const bool seekable : {false, true}) {
        MergedReader whole(sources_of(clouds, seekable)), reader(sources_of(clouds, seekable));
        const MemoryCloud all = read_all(whole, 64);
        for (const auto& [first, end] :
             std::vector<std::array<std::size_t, 2>>{{2, 3}, {0, 2}, {1, 2}, {1, 4}, {3, 4}}) {
            reader.keep_sources(first, end);
            const MemoryCloud part = read_all(reader, 30);
            ASSERT_EQ(part.points.size, begins[end] - begins[first]);
            for (std::size_t k = 0; k < part.points.size; ++k)
                ASSERT_EQ(part.points.grid_xyz[1][k], all.points.grid_xyz[1][begins[first] + k]);
        }
        if (seekable) {
            reader.seek(0);
            EXPECT_EQ(read_all(reader).points.size, 151u);
        }
    }
}

TEST(MergedReader, NoticesAFileThatChanges)
{
    std::vector<MemoryCloud> clouds = {random_cloud({}, millimetres, 10, 1), random_cloud({}, millimetres, 10, 2)};
    MergedReader reader(sources_of(clouds));
    clouds[1].info.points = 11;
    try {
        read_all(reader);
        FAIL() << "read a file that is another one";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("tile1.las"), std::string::npos);
    }
}

TEST(MergedReader, RefusesNothingAndTooMuch)
{
    EXPECT_THROW(MergedReader(std::vector<MergedReader::Source>{}), Error);
    std::vector<MemoryCloud> clouds;
    for (int f = 0; f < 2; ++f) {
        Schema schema;
        for (int i = 0; i < 200; ++i)
            schema.add({std::to_string(f) + "_" + std::to_string(i), ScalarType::u8, 1, 1, 0, ""});
        clouds.push_back(random_cloud(schema, millimetres, 1, 1));
    }
    EXPECT_THROW(MergedReader(sources_of(clouds)), Error);
}

// A reader that fails after some points.
class FailingReader final : public PointReader {
public:
    FailingReader(const MemoryCloud& cloud, std::size_t good, ErrorCode code)
        : reader_(cloud, true), good_(good), code_(code)
    {
    }
    const FileInfo& info() const override { return reader_.info(); }
    bool seekable() const override { return true; }
    void seek(std::uint64_t index) override { reader_.seek(next_ = index); }
    double fraction_read() const override { return reader_.fraction_read(); }
    bool read(PointBatch& batch, std::size_t max_points) override
    {
        if (next_ >= good_) throw Error(code_, "bad.las", "the bytes are damaged");
        const bool more = reader_.read(batch, std::min<std::size_t>(max_points, good_ - next_));
        next_ += batch.size;
        return more;
    }

private:
    MemoryReader reader_;
    std::uint64_t next_ = 0, good_;
    ErrorCode code_;
};

MergedReader::Inputs skipping(std::vector<MergedReader::Source> sources)
{
    MergedReader::Inputs inputs;
    inputs.sources = std::move(sources);
    inputs.skip_bad_files = true;
    return inputs;
}

MergedReader::Source unreadable(const std::string& name, ErrorCode code)
{
    return {name, [name, code]() -> std::unique_ptr<PointReader> { throw Error(code, name, "it is damaged"); }};
}

TEST(MergedReader, BadFilesAreLeftOutAndCounted)
{
    const std::vector<MemoryCloud> clouds = {random_cloud({}, millimetres, 10, 1),
                                             random_cloud({}, millimetres, 20, 2)};
    for (const ErrorCode code : {ErrorCode::bad_format, ErrorCode::not_found, ErrorCode::permission,
                                 ErrorCode::truncated, ErrorCode::unsupported, ErrorCode::io, ErrorCode::corrupt}) {
        auto sources = sources_of(clouds);
        sources.insert(sources.begin() + 1, unreadable("broken.las", code));
        sources.push_back(unreadable("worse.las", code));
        EXPECT_THROW(MergedReader{sources}, Error);  // unless it is asked for
        MergedReader reader(skipping(sources));
        EXPECT_EQ(reader.sources().size(), 2u);
        EXPECT_EQ(read_all(reader).points.size, 30u);
        EXPECT_EQ(reader.info().skipped.files, 2u);
        EXPECT_EQ(reader.info().skipped.incomplete_files, 0u);
        EXPECT_TRUE(mentions(reader.info().notes, {"2 inputs cannot be read and are left out: broken.las, worse.las",
                                                   "broken.las: it is damaged"}));
    }
    // Nothing is left, or the user has cancelled.
    EXPECT_THROW(MergedReader(skipping({unreadable("a.las", ErrorCode::io)})), Error);
    auto cancelled = sources_of(clouds);
    cancelled.push_back(unreadable("a.las", ErrorCode::cancelled));
    EXPECT_THROW(MergedReader(skipping(cancelled)), Error);
}

TEST(MergedReader, AFileThatFailsWhileItIsReadIsCountedWithItsPoints)
{
    const std::vector<MemoryCloud> clouds = {random_cloud({}, millimetres, 10, 1),
                                             random_cloud({}, millimetres, 20, 2)};
    for (const std::size_t good : {0, 1, 7}) {
        std::vector<MergedReader::Source> sources = sources_of(clouds);
        sources[0].open = [&cloud = clouds[0], good] {
            return std::make_unique<FailingReader>(cloud, good, ErrorCode::corrupt);
        };
        MergedReader strict(sources);
        EXPECT_THROW(read_all(strict), Error);
        MergedReader reader(skipping(sources));
        for (int pass = 0; pass < 2; ++pass) {
            const MemoryCloud all = read_all(reader, 5);
            ASSERT_EQ(all.points.size, good + 20);
            EXPECT_EQ(position_of(all.points, millimetres, good), position_of(clouds[1].points, millimetres, 0));
            EXPECT_EQ(reader.info().skipped.incomplete_files, 1u);
            EXPECT_EQ(reader.info().skipped.files, 0u);
            const std::string taken = std::to_string(good) + " of its 10 points were taken";
            EXPECT_EQ(std::count_if(reader.info().notes.begin(), reader.info().notes.end(),
                                    [&](const std::string& note) { return note.find(taken) != std::string::npos; }),
                      1);
            EXPECT_TRUE(mentions(reader.info().notes, {"tile0.las could be read in part", "the bytes are damaged"}));
            reader.seek(0);
        }
    }
}

}  // namespace
