// LAZ of other writers (one chunk without a table, a table that is missing or at the end), and damaged LAZ.
#include "tests/io/cloud_copy.h"
#include "tests/io/las_file.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace pcm::test {
namespace {

struct Laz {
    Whole cloud;
    std::string bytes;
    std::size_t points_at = 0;  // where the pointer to the chunk table is

    std::uint64_t table_at() const
    {
        std::uint64_t position = 0;
        std::memcpy(&position, bytes.data() + points_at, 8);
        return position;
    }
    std::size_t laszip_vlr_at() const { return bytes.find("laszip encoded") + 52; }  // its payload
};

Laz laz_of(const TemporaryFolder& folder, int format, std::size_t points, std::size_t extra_bytes)
{
    std::mt19937_64 random(1);
    Laz laz;
    laz.cloud =
        read_whole(write_file(folder / "source.las", random_las(random, 4, format, points, extra_bytes).bytes()));
    write_cloud(folder / "source.laz", laz.cloud);
    laz.bytes = read_bytes(folder / "source.laz");
    std::uint32_t at = 0;
    std::memcpy(&at, laz.bytes.data() + 96, 4);
    laz.points_at = at;
    return laz;
}

template <class T>
std::string with(std::string bytes, std::size_t at, T value)
{
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return bytes;
}

TEST(LazDamage, FilesWithoutAChunkTableAreReadInOrder)
{
    PCM_REQUIRE_LAZ();
    TemporaryFolder folder;
    for (const int format : {3, 7}) {
        const Laz laz = laz_of(folder, format, 3000, 4);
        // The writer did not update the pointer to the table, ...
        const std::string lost = with(laz.bytes, laz.points_at, std::int64_t{-1}).substr(0, laz.table_at());
        Whole whole = read_whole(write_file(folder / "a.laz", lost));
        expect_same_cloud(laz.cloud, whole);
        EXPECT_TRUE(any_mentions(whole.info.notes, "missing"));
        // ... or wrote it at the end of the file, ...
        Bytes at_end;
        at_end.raw(with(laz.bytes, laz.points_at, std::int64_t{-1})).put(laz.table_at());
        whole = read_whole(write_file(folder / "a.laz", at_end.data));
        expect_same_cloud(laz.cloud, whole);
        EXPECT_TRUE(whole.info.notes.empty());
        // ... or the table is damaged.
        whole = read_whole(write_file(folder / "a.laz", with(laz.bytes, laz.table_at() + 4, 0xFFFFFFFFu)));
        expect_same_cloud(laz.cloud, whole);
        EXPECT_TRUE(any_mentions(whole.info.notes, "damaged"));
    }
}

TEST(LazDamage, OneChunkWithoutATable)
{
    PCM_REQUIRE_LAZ();
    TemporaryFolder folder;
    const Laz laz = laz_of(folder, 1, 3000, 0);
    std::string bytes = with(laz.bytes, laz.laszip_vlr_at(), std::uint16_t{1});
    bytes = bytes.substr(0, laz.table_at());
    bytes.erase(laz.points_at, 8);
    expect_same_cloud(laz.cloud, read_whole(write_file(folder / "a.laz", bytes)));
}

TEST(LazDamage, ChunksOfVariableSizeNeedATableOrLayers)
{
    PCM_REQUIRE_LAZ();
    TemporaryFolder folder;
    for (const int format : {3, 7}) {
        const Laz laz = laz_of(folder, format, 3000, 0);
        std::string bytes = with(laz.bytes, laz.laszip_vlr_at() + 12, 0xFFFFFFFFu);
        bytes = with(bytes, laz.points_at, std::int64_t{-1}).substr(0, laz.table_at());
        const auto path = write_file(folder / "a.laz", bytes);
        if (format == 7) {
            expect_same_cloud(laz.cloud, read_whole(path));
        } else {
            const Error error = error_of([&] { open_reader(path); });
            EXPECT_EQ(error.code(), ErrorCode::corrupt);
            EXPECT_TRUE(mentions(error.what(), "variable size")) << error.what();
        }
    }
}

TEST(LazDamage, MorePointsThanTheChunksHoldAreRefused)
{
    PCM_REQUIRE_LAZ();
    TemporaryFolder folder;
    const Laz laz = laz_of(folder, 7, 100, 0);
    const auto path = write_file(folder / "a.laz", with(laz.bytes, 247, std::uint64_t{44000000}));
    const Error error = error_of([&] { open_reader(path); });
    EXPECT_EQ(error.code(), ErrorCode::truncated);
    EXPECT_TRUE(mentions(error.what(), "44000000 points")) << error.what();
}

// GPS times are in sequences that the points switch between. Bytes of ones only are nothing but switches, more than a
// stack is deep.
TEST(LazDamage, SwitchesWithoutEndAreRefused)
{
    PCM_REQUIRE_LAZ();
    TemporaryFolder folder;
    for (const int format : {1, 3, 6, 7}) {
        SCOPED_TRACE(format);
        Laz laz = laz_of(folder, format, 5000, 0);
        // A chunk: its first point; of formats to 5 one stream; of later ones the number of points, the sizes of the
        // layers, the layers, GPS times the ninth.
        std::size_t from = laz.points_at + 8 + (format == 1 ? 28 : format == 3 ? 34 : format == 6 ? 30 : 36);
        std::size_t to = laz.table_at();
        if (format >= 6) {
            std::vector<std::uint32_t> layers(format == 6 ? 9 : 10);
            const std::size_t sizes = from + 4, bytes = layers.size() * sizeof layers[0];
            std::memcpy(layers.data(), laz.bytes.data() + sizes, bytes);
            from = std::accumulate(layers.begin(), layers.begin() + 8, sizes + bytes);
            to = from + layers[8];
        }
        ASSERT_GT(to, from + 10000);
        ASSERT_LE(to, laz.table_at());
        std::fill(laz.bytes.begin() + static_cast<std::ptrdiff_t>(from),
                  laz.bytes.begin() + static_cast<std::ptrdiff_t>(to), '\xFF');
        const auto path = write_file(folder / "a.laz", laz.bytes);
        for (const unsigned threads : {1u, 2u}) {
            ReadOptions options;
            options.threads = threads;
            const Error error = error_of([&] { read_whole(*open_reader(path, options)); });
            EXPECT_EQ(error.code(), ErrorCode::corrupt);
            EXPECT_TRUE(mentions(error.what(), "switch between their sequences")) << error.what();
        }
    }
}

TEST(LazDamage, CutAnywhere)
{
    PCM_REQUIRE_LAZ();
    TemporaryFolder folder;
    for (const int format : {2, 8}) {
        const Laz laz = laz_of(folder, format, 20, 3);
        for (std::size_t size = 0; size < laz.bytes.size(); ++size) {
            const auto path = write_file(folder / "a.laz", laz.bytes.substr(0, size));
            try {
                // The points are complete; only the table after them is not.
                const Whole whole = read_whole(path);
                ASSERT_GE(size, laz.table_at() + 8) << "of " << laz.bytes.size() << " bytes";
                expect_same_cloud(laz.cloud, whole);
                EXPECT_TRUE(any_mentions(whole.info.notes, "chunk table is damaged"));
            } catch (const Error& error) {
                ASSERT_TRUE(mentions(error.what(), path.string())) << error.what();
            }
        }
    }
}

TEST(LazDamage, ChangedAnywhere)
{
    PCM_REQUIRE_LAZ();
    TemporaryFolder folder;
    std::mt19937_64 random(3);
    int read = 0, refused = 0;
    for (const int format : {0, 5, 6, 10}) {
        const Laz laz = laz_of(folder, format, 200, 2);
        for (int round = 0; round < 500; ++round) {
            std::string bytes = laz.bytes;
            for (std::size_t i = 0; i <= random() % 4; ++i) {
                const std::size_t at = random() % 3 ? 96 + random() % 700 : random() % bytes.size();
                if (at < bytes.size()) bytes[at] = static_cast<char>(random() % 3 ? random() : 0xFF);
            }
            const auto path = write_file(folder / "a.laz", bytes);
            ReadOptions options;
            options.threads = 1 + static_cast<unsigned>(random() % 3);
            try {
                const auto reader = open_reader(path, options);
                PointBatch batch;
                std::uint64_t points = 0;
                while (reader->read(batch, 1000)) points += batch.size;
                EXPECT_EQ(points, reader->info().points);
                ++read;
            } catch (const Error& error) {
                ASSERT_TRUE(mentions(error.what(), path.string())) << error.what();
                ++refused;
            }
        }
    }
    EXPECT_GT(read, 100);
    EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace pcm::test
