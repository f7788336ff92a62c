#include "pcm/bpc/bpc_array.h"

#include "pcm/bpc/batch_chunk.h"
#include "pcm/bpc/bpc_file.h"
#include "pcm/bpc/bpc_file_writer.h"
#include "pcm/system/error.h"
#include "tests/bpc/array_rows.h"
#include "tests/support.h"

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <numeric>
#include <random>

namespace {

// Bytes allocated by operator new, and the largest sum of these and the columns' pages since it was last set.
std::atomic<std::size_t> live{0}, most{0};

}  // namespace

// Not inlined, for the compiler would see malloc and delete, or new and free, side by side and warn.
[[gnu::noinline]] void* operator new(std::size_t size)
{
    void* memory = std::malloc(size ? size : 1);
    if (!memory) throw std::bad_alloc();
    const std::size_t now = (live += malloc_usable_size(memory)) + pcm::pages_in_use();
    std::size_t before = most.load();
    while (now > before && !most.compare_exchange_weak(before, now)) {
    }
    return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept
{
    if (memory) live -= malloc_usable_size(memory);
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }

namespace pcm {
namespace {

using namespace test;

// The smallest memory for an array, from the error of an array without memory.
std::size_t least_memory(const std::filesystem::path& path, BpcArrayOptions options)
{
    options.memory_bytes = 1;
    try {
        BpcArray array(path, options);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        const std::string text = error.what(), before = "needs at least ";
        return std::stoul(text.substr(text.find(before) + before.size()));
    }
    ADD_FAILURE() << "an array with a byte of memory";
    return 0;
}

class BpcArrayAgainstVector : public testing::TestWithParam<std::tuple<bool, bool>> {};

// Random operations with room for two or three chunks of a hundred: every value is the vector's at every time.
TEST_P(BpcArrayAgainstVector, RandomOperations)
{
    const bool gridded = std::get<0>(GetParam()), read_ahead = std::get<1>(GetParam());
    TemporaryFolder folder;
    const auto path = folder / "a.bpc";
    std::mt19937_64 random(gridded ? 1 : 2);
    BpcArrayOptions options;
    options.chunk_points = 100;
    options.read_ahead = read_ahead;
    std::vector<Row> model;
    std::uint64_t evicted = 0, spilled = 0, ahead = 0;
    for (int life = 0; life < 4; ++life) {
        if (life) options.memory_bytes = least_memory(path, options) + 200 * 1024 + random() % 20000;
        std::unique_ptr<BpcArray> array(life ? new BpcArray(path, options)
                                             : new BpcArray(path, cloud_of_rows(gridded), options));
        const Columns columns(*array);
        std::vector<Row> flushed = model;
        for (int step = 0; step < 600; ++step) {
            ASSERT_EQ(array->size(), model.size());
            const std::uint64_t i = model.empty() ? 0 : random() % model.size();
            switch (model.empty() ? 0 : random() % 12) {
                case 0:  // many points more
                    for (std::size_t n = random() % 150; n > 0; --n) {
                        model.push_back(random_row(random, gridded));
                        array->push_back();
                        put(*array, model.size() - 1, model.back(), columns);
                    }
                    break;
                case 1: {  // the same as a batch
                    PointBatch batch;
                    batch.reset(array->schema(), gridded, random() % 250);
                    for (std::size_t k = 0; k < batch.size; ++k) {
                        model.push_back(random_row(random, gridded));
                        for (std::size_t a = 0; a < 3; ++a) {
                            const Grid grid = array->grid().value_or(Grid{});
                            if (gridded)
                                batch.grid_xyz[a][k] = static_cast<std::int32_t>(
                                    (model.back().position[a] - grid.offset[a]) / grid.scale[a]);
                            else
                                batch.xyz[a][k] = model.back().position[a];
                        }
                        batch.attributes[0].as<std::uint16_t>()[k] = model.back().intensity;
                        std::copy_n(model.back().normal.data(), 3, batch.attributes[1].as<float>() + 3 * k);
                        batch.attributes[2].as<double>()[k] = model.back().time;
                    }
                    array->append(batch);
                    break;
                }
                case 2:
                case 3:  // all of a point
                    model[i] = random_row(random, gridded);
                    put(*array, i, model[i], columns);
                    break;
                case 4:
                case 5:  // one value
                    model[i].intensity = static_cast<std::uint16_t>(random());
                    (*array)[i].set(columns.intensity, model[i].intensity);
                    break;
                case 6: {  // a stretch in order, read and written
                    const std::uint64_t end = std::min<std::uint64_t>(model.size(), i + random() % 1000);
                    for (auto it = array->begin() + static_cast<std::int64_t>(i);
                         it < array->begin() + static_cast<std::int64_t>(end); ++it) {
                        const auto at = (*it).index();
                        ASSERT_EQ((*it).get(columns.time), model[at].time);
                        (*it).set(columns.time, model[at].time += 1);
                    }
                    break;
                }
                case 7:  // backwards
                    for (std::uint64_t k = i; k > 0 && i - k < 500; --k)
                        ASSERT_EQ(array->get(k, columns.normal, 1), model[k].normal[1]);
                    break;
                case 8:
                    if (random() % 8 == 0) {
                        array->flush();
                        flushed = model;
                    }
                    break;
                default:
                    ASSERT_TRUE(get(*array, i, columns) == model[i]) << i;
                    ASSERT_EQ(array->value(i, 0), model[i].intensity);
                    break;
            }
        }
        for (std::uint64_t i = 0; i < model.size(); ++i) ASSERT_TRUE(get(*array, i, columns) == model[i]) << i;
        evicted += array->statistics().chunks_evicted;
        spilled += array->statistics().columns_spilled;
        ahead += array->statistics().chunks_read_ahead;
        if (life == 2)
            model = flushed;  // dropped without a flush
        else
            array->flush();
        array.reset();
        EXPECT_EQ(files_in(folder.path()), 1u) << "no scratch file is left";
    }
    EXPECT_GT(evicted, 100u);
    EXPECT_GT(spilled, 100u);
    EXPECT_EQ(ahead > 0, read_ahead);
    BpcArray array(path);
    EXPECT_EQ(array.metadata(), cloud_of_rows(gridded).metadata);
    const Columns columns(array);
    ASSERT_EQ(array.size(), model.size());
    for (std::uint64_t i = 0; i < model.size(); ++i) ASSERT_TRUE(get(array, i, columns) == model[i]) << i;
}

INSTANTIATE_TEST_SUITE_P(GridAndDoubles, BpcArrayAgainstVector, testing::Combine(testing::Bool(), testing::Bool()));

TEST(BpcArray, MemoryStaysWithinTheBudget)
{
    TemporaryFolder folder;
    const auto path = folder / "a.bpc";
    write_numbered(path, 150000, 10000);
    for (const bool gridded_file : {true, false}) {
        if (!gridded_file) write_numbered(path, 150000, 10000, false);
        for (const bool read_ahead : {false, true}) {
            BpcArrayOptions options;
            options.chunk_points = 10000;
            options.read_ahead = read_ahead;
            options.memory_bytes = least_memory(path, options) + (std::size_t{1} << 20);
            const std::size_t before = live + pages_in_use();
            most = before;
            {
                BpcArray array(path, options);
                const Columns columns(array);
                std::mt19937_64 random(3);
                double sum = 0;
                for (auto point : array) {
                    sum += point.position()[0];
                    point.set(columns.intensity, 7);
                }
                EXPECT_EQ(sum, 150000 * (1000 + 149999 / 2.0));
                for (int i = 0; i < 300; ++i) (array)[random() % array.size()].set(columns.time, 1);
                for (int i = 0; i < 30000; ++i) array.push_back().set(columns.intensity, 9);
                EXPECT_GT(array.statistics().columns_spilled, 15u);
                EXPECT_LE(array.statistics().most_resident_bytes, options.memory_bytes);
                array.flush();
            }
            // The thread and the small things around it are not counted in the budget.
            EXPECT_LE(most - before, options.memory_bytes + 65536) << "read ahead " << read_ahead;
            EXPECT_GT(most - before, options.memory_bytes / 3) << "a budget that is used";
            write_numbered(path, 150000, 10000, gridded_file);
        }
    }
}

TEST(BpcArray, OnlyUsedColumnsAreRead)
{
    TemporaryFolder folder;
    write_numbered(folder / "a.bpc", 1000, 100);
    // Every column but the intensity is damaged: nobody may notice.
    {
        const BpcFile file(folder / "a.bpc");
        std::fstream bytes(folder / "a.bpc", std::ios::in | std::ios::out | std::ios::binary);
        for (std::uint64_t c = 0; c < 10; ++c) {
            const ChunkPlace place = *file.index().at(c);
            const BpcHeader header = file.header(place);
            for (const BpcColumn& column : {header.positions, header.attributes[1], header.attributes[2]}) {
                bytes.seekp(static_cast<std::streamoff>(place.offset + column.offset + 9));
                bytes.put('\x55');
            }
        }
    }
    BpcArray array(folder / "a.bpc");
    const Columns columns(array);
    std::uint64_t sum = 0;
    for (auto point : array) sum += point.get(columns.intensity);
    EXPECT_EQ(sum, 999u * 1000 / 2);
    try {
        array.position(250);
        FAIL() << "a damaged column";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::corrupt);
        EXPECT_NE(std::string(error.what()).find("a.bpc"), std::string::npos) << error.what();
    }
    EXPECT_EQ(array.get(250, columns.intensity), 250) << "the array is as it was";
}

TEST(BpcArray, ChunksWithoutChangesAreCopied)
{
    TemporaryFolder folder;
    write_numbered(folder / "a.bpc", 1000, 100);
    const BpcFile before(folder / "a.bpc");
    BpcArray array(folder / "a.bpc");
    array[555].set(array.column<std::uint16_t>("intensity"), 1);
    array.save_as(folder / "b.bpc");
    EXPECT_EQ(array.statistics().chunks_decoded, 2u) << "one of ten, its intensity first, then the rest for encoding";
    const BpcFile after(folder / "b.bpc");
    for (std::uint64_t c = 0; c < 10; ++c) {
        const auto bytes = [&](const BpcFile& file) {
            const ChunkPlace place = *file.index().at(c);
            std::vector<std::byte> all(static_cast<std::size_t>(file.header(place).total_bytes));
            file.file().read_at(all.data(), all.size(), place.offset);
            return all;
        };
        EXPECT_EQ(bytes(before) == bytes(after), c != 5) << c;
    }
}

// Bare chunks on two grids, as doubles, and their flush.
TEST(BpcArray, OverBareChunks)
{
    TemporaryFolder folder;
    PointBatch batch;
    batch.reset({}, true, 50);
    for (std::size_t i = 0; i < 50; ++i)
        for (auto& axis : batch.grid_xyz) axis[i] = static_cast<std::int32_t>(i);
    const Grid one{{0.5, 0.5, 0.5}, {0, 0, 0}}, other{{2, 2, 2}, {1, 1, 1}};
    {
        File file(folder / "a.bpc", File::Mode::create_new);
        const auto first = encode_batch(batch, {}, one), second = encode_batch(batch, {}, other);
        file.write_at(first.data(), first.size(), 0);
        file.write_at(second.data(), second.size(), first.size());
    }
    const auto expect = [&](BpcArray& array, double third) {
        ASSERT_EQ(array.size(), 100u);
        EXPECT_FALSE(array.grid());
        for (std::uint64_t i = 0; i < 100; ++i) {
            const double x = i == 3   ? third
                             : i < 50 ? one.to_source(static_cast<std::int64_t>(i), 0)
                                      : other.to_source(static_cast<std::int64_t>(i) - 50, 0);
            ASSERT_EQ(array.position(i)[0], x);
        }
    };
    {
        BpcArray array(folder / "a.bpc");
        expect(array, 1.5);
        array.set_position(3, {0.1, 1, 1});
        EXPECT_THROW(array.grid_position(3), Error);
        array.flush();
        expect(array, 0.1);
    }
    BpcArray array(folder / "a.bpc");
    expect(array, 0.1);
}

TEST(BpcArray, WhatIsRefused)
{
    TemporaryFolder folder;
    write_numbered(folder / "a.bpc", 10, 100);
    BpcArray array(folder / "a.bpc");
    EXPECT_THROW(array.column<float>("intensity"), Error);
    EXPECT_THROW(array.column<std::uint16_t>("radius"), Error);
    EXPECT_THROW(array.position(10), Error);
    EXPECT_THROW(array.set_position(0, {std::numeric_limits<double>::quiet_NaN(), 0, 0}), Error);
    EXPECT_THROW(array.set_position(0, {0, 1e12, 0}), Error);
    EXPECT_THROW(array.append(PointBatch{}), Error);
    EXPECT_EQ(array.position(0), (Vec3d{1000, 0.25, -3}));
    array.set_position(0, {1000.2, 0.3, 1});
    EXPECT_EQ(array.position(0), (Vec3d{1000, 0.25, 1})) << "the nearest on the grid";
    EXPECT_EQ(array.grid_position(0), (std::array<std::int32_t, 3>{0, 1, 32}));
    for (const std::int32_t last :
         {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()}) {
        const double x = 1000 + 0.5 * last;
        array.set_position(0, {x, 0.25, 1});
        EXPECT_EQ(array.grid_position(0)[0], last);
        EXPECT_THROW(array.set_position(0, {x + (last < 0 ? -0.5 : 0.5), 0.25, 1}), Error);
        EXPECT_EQ(array.grid_position(0)[0], last) << "what was refused changes nothing";
    }
    EXPECT_THROW(BpcArray(folder / "none.bpc"), Error);
}

TEST(BpcArray, IteratorsAreRandomAccess)
{
    TemporaryFolder folder;
    write_numbered(folder / "a.bpc", 1000, 100);
    BpcArray array(folder / "a.bpc");
    EXPECT_EQ(array.end() - array.begin(), 1000);
    EXPECT_EQ((array.begin() + 7)[3].index(), 10u);
    EXPECT_EQ((*--array.end()).index(), 999u);
    // The first point at or beyond a coordinate, by halving.
    const auto found = std::lower_bound(array.begin(), array.end(), 1123.5,
                                        [](const BpcArray::Point& p, double x) { return p.position()[0] < x; });
    EXPECT_EQ((*found).index(), 124u);
    BpcArray none(folder / "b.bpc", cloud_of_rows(true));
    EXPECT_TRUE(none.empty());
    EXPECT_TRUE(none.begin() == none.end());
    none.flush();
    EXPECT_TRUE(BpcArray(folder / "b.bpc").empty());
}

}  // namespace
}  // namespace pcm
