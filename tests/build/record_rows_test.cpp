// Rows that come straight from records are those that come by way of columns.

#include "pcm/build/bins/record_rows.h"
#include "pcm/io/pipe/merged_reader.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <random>

namespace pcm {
namespace {

using namespace test;
namespace fs = std::filesystem;

std::uint8_t byte_at(const std::vector<std::byte>& bytes, std::size_t at)
{
    return std::to_integer<std::uint8_t>(bytes[at]);
}

// Fields of every length, next to each other and apart, in and out of order, and bits of bytes; counts around a block.
TEST(RecordRows, EveryFieldIsWhereTheRowHasIt)
{
    std::mt19937 random(3);
    for (const std::size_t count : {0u, 1u, 255u, 256u, 257u, 1000u}) {
        RecordBatch batch;
        std::vector<FieldPlace> fields;
        Schema schema;
        std::size_t next = 12;
        for (unsigned k = 0; k < 30; ++k) {
            const unsigned bytes = k % 4 == 3 ? 1 : 1 + random() % 13;
            FieldPlace field{next, bytes, 0, 0};
            if (k % 4 == 3) {
                field.shift = random() % 8;
                field.mask = (1u << (1 + random() % 8)) - 1;
            }
            next += random() % 3 ? bytes : bytes + random() % 5;
            fields.push_back(field);
            schema.add(Attribute{"a" + std::to_string(k), ScalarType::u8, bytes, 1.0, 0.0, {}});
        }
        std::swap(fields[4].offset, fields[8].offset);  // fields may overlap
        batch.stride = next + 13;
        batch.size = count;
        batch.bytes.resize((count + 2) * batch.stride);
        for (std::byte& b : batch.bytes) b = static_cast<std::byte>(random());
        batch.fields = std::make_shared<const std::vector<FieldPlace>>(fields);

        const RowLayout layout(schema, false);
        std::vector<std::byte> rows;
        Observed observed, expected;
        put_record_rows(batch, layout, rows, observed);
        ASSERT_EQ(rows.size(), count * layout.bytes);
        for (std::size_t i = 0; i < count; ++i) {
            Vec3i q;
            for (std::size_t a = 0; a < 3; ++a) {
                std::int32_t c;
                std::memcpy(&c, batch.bytes.data() + i * batch.stride + 4 * a, 4);
                q[a] = c;
                EXPECT_EQ(coordinates_of(batch, i)[a], to_coordinate<std::uint32_t>(c));
            }
            expected.see(q);
            EXPECT_EQ(coordinates_of<std::uint32_t>(rows.data() + i * layout.bytes), coordinates_of(batch, i));
            for (std::size_t k = 0; k < fields.size(); ++k)
                for (std::size_t b = 0; b < fields[k].bytes; ++b) {
                    unsigned value = byte_at(batch.bytes, i * batch.stride + fields[k].offset + b);
                    if (fields[k].mask) value = value >> fields[k].shift & fields[k].mask;
                    ASSERT_EQ(byte_at(rows, i * layout.bytes + layout.offsets[k] + b), value) << k << " " << b;
                }
        }
        EXPECT_EQ(observed.points, count);
        EXPECT_EQ(observed.hash, hash_rows(rows.data(), count, layout.bytes));
        EXPECT_EQ(observed.extremes, expected.extremes);
    }
}

// A reader whose records nobody sees.
class ByColumns final : public PointReader {
public:
    explicit ByColumns(PointReader& reader) : reader_(reader) {}
    const FileInfo& info() const override { return reader_.info(); }
    bool read(PointBatch& batch, std::size_t max_points) override { return reader_.read(batch, max_points); }
    bool seekable() const override { return reader_.seekable(); }
    void seek(std::uint64_t index) override { reader_.seek(index); }
    double fraction_read() const override { return reader_.fraction_read(); }

private:
    PointReader& reader_;
};

void expect_the_tree_by_columns(const std::vector<fs::path>& files, bool has_records)
{
    const TemporaryFolder folder;
    MergedReader straight(files, {}), other(files, {});
    ByColumns by_columns(other);
    EXPECT_EQ(straight.has_records(), has_records);
    build_tree(straight, {"cloud"}, folder / "straight.pct", small_chunks());
    build_tree(by_columns, {"cloud"}, folder / "columns.pct", small_chunks());
    EXPECT_TRUE(contents(folder / "straight.pct") == contents(folder / "columns.pct"));
}

TEST(RecordRows, OfEveryLasFileMakeTheTreeByColumns)
{
    PCM_REQUIRE_SAMPLE("MANIFEST.csv");
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(sample("las"))) {
        const std::string extension = entry.path().extension();
        if (extension != ".las" && extension != ".laz") continue;
        SCOPED_TRACE(entry.path());
        expect_the_tree_by_columns({entry.path()}, true);
        ++files;
    }
    EXPECT_GT(files, 30u);
}

// Tiles on one grid have records; those with grids of their own, and files of several schemas, do not.
TEST(RecordRows, OfTiles)
{
    const TemporaryFolder folder;
    const Grid grid{{0.01, 0.01, 0.01}, {0, 0, 0}}, other{{0.01, 0.01, 0.01}, {0.5, 0, 0}};
    write_las(folder / "a.las", records(Shape::surface, 5000, 1), grid);
    write_las(folder / "b.las", records(Shape::volume, 3000, 2), grid);
    write_las(folder / "c.las", records(Shape::volume, 3000, 3), other);
    write_ply<float>(folder / "d.ply", {{1, 2, 3}, {4, 5, 6}});
    fs::copy_file(folder / "b.las", folder / "e.las");
    std::fstream(folder / "e.las", std::ios::in | std::ios::out | std::ios::binary).seekp(104).put(0);  // no colours
    expect_the_tree_by_columns({folder / "a.las", folder / "b.las"}, true);
    EXPECT_FALSE(MergedReader({folder / "a.las", folder / "c.las"}, {}).has_records());
    expect_the_tree_by_columns({folder / "a.las", folder / "d.ply"}, false);
    expect_the_tree_by_columns({folder / "a.las", folder / "e.las"}, false);
    MergedReader ply({folder / "d.ply"}, {});
    RecordBatch batch;
    EXPECT_FALSE(ply.has_records());
    EXPECT_THROW(ply.read_records(batch, 10), Error);
}

}  // namespace
}  // namespace pcm
