// Clouds of random shape for tests of writers: any schema, positions of any kind, values of any bits.
#pragma once

#include "pcm/io/formats.h"
#include "pcm/io/writer.h"
#include "tests/io/bytes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm::test {

enum class PositionKind { grid, single_precision, double_precision };

struct RandomCloud {
    FileInfo info;
    PointBatch points;
};

inline void fill_random(std::byte* to, std::size_t bytes, std::mt19937_64& random)
{
    for (std::size_t i = 0; i < bytes; ++i) to[i] = static_cast<std::byte>(random());
}

// Only finite reals unless `any_bits`: text does not keep the bits of a NaN.
inline void fill_column(Column& column, std::mt19937_64& random, bool any_bits)
{
    fill_random(column.data(), column.bytes(), random);
    if (any_bits) return;
    const std::size_t values = column.size() * column.components();
    for (std::size_t i = 0; i < values; ++i) {
        if (column.type() == ScalarType::f32)
            while (!std::isfinite(column.as<float>()[i])) column.as<float>()[i] = static_cast<float>(random());
        if (column.type() == ScalarType::f64)
            while (!std::isfinite(column.as<double>()[i])) column.as<double>()[i] = static_cast<double>(random());
    }
}

inline RandomCloud random_cloud(std::mt19937_64& random, PositionKind kind, std::size_t points, bool any_bits,
                                const std::vector<Attribute>& attributes)
{
    RandomCloud cloud;
    FileInfo& info = cloud.info;
    info.points = points;
    for (const Attribute& attribute : attributes) info.schema.add(attribute);
    if (kind == PositionKind::grid) info.grid = Grid{{0.001, 0.01, 1e-7}, {500000.25, -4.1e6, 0.1}};
    info.position_type = kind == PositionKind::grid               ? ScalarType::i32
                         : kind == PositionKind::single_precision ? ScalarType::f32
                                                                  : ScalarType::f64;
    cloud.points.reset(info.schema, info.grid.has_value(), points);
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t i = 0; i < points; ++i) {
            const auto bits = random();
            const double real = std::ldexp(static_cast<double>(bits) - 0x1p63, static_cast<int>(random() % 60) - 90);
            if (info.grid)
                cloud.points.grid_xyz[a][i] = static_cast<std::int32_t>(bits);
            else
                cloud.points.xyz[a][i] =
                    kind == PositionKind::single_precision ? static_cast<double>(static_cast<float>(real)) : real;
        }
    for (Column& column : cloud.points.attributes) fill_column(column, random, any_bits);
    return cloud;
}

// Attributes of all types, with names that are awkward in a header.
inline std::vector<Attribute> random_attributes(std::mt19937_64& random)
{
    static const char* const names[] = {
        "intensity", "rgb",       "normal", "gps_time", "two words", "x",     "Red",       "green",
        "blue",      "alpha",     "radius", "r",        "g",         "b",     "a\xC3\xA9", "nx",
        "100 %",     "a_0",       "a",      "_",        "normal_x",  "label", "rgba",      "scalar_intensity",
        "A",         "curvature", "-",      "#",        "END"};
    std::vector<Attribute> attributes;
    for (const char* name : names) {
        if (random() % 2) continue;
        Attribute attribute;
        attribute.name = name;
        attribute.type = static_cast<ScalarType>(1 + random() % 10);
        attribute.components = random() % 3 ? 1u : static_cast<std::uint32_t>(1 + random() % 5);
        if (attribute.name == "rgb" || attribute.name == "normal") attribute.components = 3;
        if (random() % 4 == 0) {
            attribute.scale = 0.1 * static_cast<double>(1 + random() % 9);
            attribute.offset = static_cast<double>(random()) * 1e-7;
            attribute.description = "counts of #5, in %";
        }
        attributes.push_back(attribute);
    }
    std::shuffle(attributes.begin(), attributes.end(), random);
    return attributes;
}

// Some points of a batch, with the same shape.
inline PointBatch slice(const PointBatch& all, std::size_t first, std::size_t count)
{
    PointBatch part;
    part.size = count;
    part.gridded = all.gridded;
    for (std::size_t a = 0; a < 3; ++a)
        if (all.gridded)
            part.grid_xyz[a].assign(all.grid_xyz[a].data() + first, all.grid_xyz[a].data() + first + count);
        else
            part.xyz[a].assign(all.xyz[a].data() + first, all.xyz[a].data() + first + count);
    for (const Column& column : all.attributes) {
        Column& copy = part.attributes.emplace_back(column.type(), column.components());
        copy.resize(count);
        if (copy.bytes()) std::memcpy(copy.data(), column.data() + first * column.point_bytes(), copy.bytes());
    }
    return part;
}

// The answers to what the format asks of a cloud's values.
inline std::shared_ptr<const Survey> survey_of(const FileInfo& info, const PointBatch& points,
                                               const std::string& extension, const WriteOptions& options = {})
{
    Surveyor surveyor(info, format_of_extension(extension)->questions(info, options));
    surveyor.watch(points);
    return std::make_shared<const Survey>(surveyor.answers());
}

// Writes in batches of random size; returns the writer's notes.
inline std::vector<std::string> write_cloud(const std::filesystem::path& path, const RandomCloud& cloud,
                                            std::mt19937_64& random, const WriteOptions& options = {})
{
    const auto writer = create_writer(path, cloud.info, options);
    for (std::size_t done = 0; done < cloud.points.size;) {
        const std::size_t now = std::min<std::size_t>(cloud.points.size - done, random() % 5000);
        writer->write(slice(cloud.points, done, now));
        done += now;
    }
    writer->finish();
    EXPECT_EQ(writer->position_error(), 0);
    return writer->notes();
}

// Bit for bit, -0 and NaN included.
inline void expect_same_points(const RandomCloud& cloud, const Whole& whole)
{
    ASSERT_EQ(whole.points.size, cloud.points.size);
    Whole source;
    source.info.grid = cloud.info.grid;
    source.points = cloud.points;
    for (std::size_t i = 0; i < cloud.points.size; ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            const double expected = source.position(i)[a], found = whole.position(i)[a];
            ASSERT_EQ(std::memcmp(&expected, &found, sizeof found), 0)
                << "point " << i << ": " << expected << " " << found;
        }
    ASSERT_EQ(whole.points.attributes.size(), cloud.points.attributes.size());
    for (std::size_t c = 0; c < cloud.points.attributes.size(); ++c) {
        const Column &expected = cloud.points.attributes[c], &found = whole.points.attributes[c];
        ASSERT_EQ(found.bytes(), expected.bytes()) << cloud.info.schema[c].name;
        const bool same = !expected.bytes() || std::memcmp(expected.data(), found.data(), expected.bytes()) == 0;
        ASSERT_TRUE(same) << cloud.info.schema[c].name;
    }
}

inline void expect_same_schema(const Schema& expected, const Schema& found)
{
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(found[i].name, expected[i].name);
        EXPECT_EQ(found[i].type, expected[i].type) << expected[i].name;
        EXPECT_EQ(found[i].components, expected[i].components) << expected[i].name;
        EXPECT_EQ(found[i].scale, expected[i].scale) << expected[i].name;
        EXPECT_EQ(found[i].offset, expected[i].offset) << expected[i].name;
        EXPECT_EQ(found[i].description, expected[i].description) << expected[i].name;
    }
}

inline Metadata metadata(const std::string& key, const std::string& value)
{
    const auto* bytes = reinterpret_cast<const std::byte*>(value.data());
    return {key, {bytes, bytes + value.size()}};
}

// Every sample of a few megabytes that can be read, written and read again: the same points, attributes and metadata.
inline void expect_samples_survive(const char* extension)
{
    TemporaryFolder folder;
    std::mt19937_64 random(1);
    std::size_t files = 0;
    for (const char* group : {"las", "ply", "pcd", "crossformat"})
        for (const auto& entry : std::filesystem::directory_iterator(sample(group))) {
            const std::string format = entry.path().extension().string();
            if ((format != ".las" && format != ".ply" && format != ".pcd") || entry.file_size() > 3000000) continue;
            SCOPED_TRACE(entry.path());
            const Whole source = read_whole(entry.path());
            const RandomCloud cloud{source.info, source.points};
            const auto copy = folder / (std::string("a") + extension);
            write_cloud(copy, cloud, random);
            const Whole whole = read_whole(copy);
            expect_same_schema(source.info.schema, whole.info.schema);
            expect_same_points(cloud, whole);
            for (const Metadata& block : source.info.metadata)
                EXPECT_NE(std::find(whole.info.metadata.begin(), whole.info.metadata.end(), block),
                          whole.info.metadata.end())
                    << block.key;
            ++files;
        }
    EXPECT_GE(files, 40u);
}

}  // namespace pcm::test
