// Rows come back from their packing bit for bit, whatever they hold; damaged bytes are refused or give other rows, and
// nothing outside of the rows is touched.

#include "pcm/build/bins/row_packing.h"

#include "pcm/system/error.h"
#include "tests/build/schema_of.h"
#include "tests/sanitizers.h"

#include <gtest/gtest.h>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

namespace pcm {
namespace {

using Rows = std::vector<std::byte>;

Schema mixed_schema()
{
    return test::schema_of({{ScalarType::u16, 1},
                            {ScalarType::u8, 3},
                            {ScalarType::i8, 1},
                            {ScalarType::f64, 1},
                            {ScalarType::i64, 1},
                            {ScalarType::f32, 3},
                            {ScalarType::u64, 1},
                            {ScalarType::i16, 2}});
}

// Rows of one kind of content; every byte of a row is set.
Rows rows_of(const std::string& kind, std::size_t count, const RowLayout& layout, std::mt19937_64& random)
{
    Rows rows(count * layout.bytes);
    const Rows model = [&] {
        Rows row(layout.bytes);
        for (std::byte& b : row) b = static_cast<std::byte>(random());
        return row;
    }();
    for (std::size_t i = 0; i < count; ++i) {
        std::byte* row = rows.data() + i * layout.bytes;
        std::memcpy(row, model.data(), layout.bytes);
        for (std::size_t b = 0; b < layout.bytes; ++b) {
            if (kind == "random") row[b] = static_cast<std::byte>(random());
            if (kind == "extremes") row[b] = static_cast<std::byte>(random() % 2 ? 0xff : 0);
            if (kind == "one bit") row[b] = static_cast<std::byte>(random() % 64 == 0 ? 0x80 : 0);
            if (kind == "even bytes" && b % 2 == 0) row[b] = static_cast<std::byte>(random());
        }
        if (kind == "all or nothing") std::memset(row, i % 3 ? 0xff : 0, layout.bytes);  // in signed fields: -1, 0
        if (kind == "last row differs" && i + 1 == count) std::memset(row, 0xa5, layout.bytes);
    }
    return rows;
}

const char* const kinds[] = {"constant",   "random",         "extremes",        "one bit",
                             "even bytes", "all or nothing", "last row differs"};

void expect_round_trip(const Schema& schema, bool wide, bool coordinates, bool signed_coordinates)
{
    std::mt19937_64 random(7);
    const RowLayout layout(schema, wide);
    const RowPacking packing(layout, schema, coordinates, signed_coordinates);
    const std::size_t kept = coordinates ? 0 : 3 * layout.coordinate_bytes;  // bytes that are not packed
    for (const std::string kind : kinds)
        for (const std::size_t count : {1u, 2u, 3u, 511u, 512u, 513u, 1025u}) {
            SCOPED_TRACE(kind + ", " + std::to_string(count) + " rows");
            const Rows rows = rows_of(kind, count, layout, random);
            std::vector<std::byte> packed(5, std::byte{1});  // pack() appends
            packing.pack(rows.data(), count, packed);
            ASSERT_EQ(packed[4], std::byte{1});
            Rows back(rows.size(), std::byte{0x5c});
            packing.unpack(packed.data() + 5, packed.size() - 5, back.data(), count, "file");
            for (std::size_t i = 0; i < count; ++i) {
                const std::byte *a = rows.data() + i * layout.bytes, *b = back.data() + i * layout.bytes;
                ASSERT_EQ(std::memcmp(a + kept, b + kept, layout.bytes - kept), 0) << "row " << i;
                for (std::size_t k = 0; k < kept; ++k) ASSERT_EQ(b[k], std::byte{0x5c}) << "row " << i;
            }
            // In another order.
            std::vector<std::uint32_t> order(count);
            std::iota(order.begin(), order.end(), 0u);
            std::shuffle(order.begin(), order.end(), random);
            packed.clear();
            packing.pack(rows.data(), order.data(), count, packed);
            packing.unpack(packed.data(), packed.size(), back.data(), count, "file");
            for (std::size_t i = 0; i < count; ++i)
                ASSERT_EQ(std::memcmp(rows.data() + order[i] * layout.bytes + kept,
                                      back.data() + i * layout.bytes + kept, layout.bytes - kept),
                          0)
                    << "row " << i;
        }
}

// Not under the thread sanitizer: all of it runs in one thread.
TEST(RowPacking, PCM_NOT_UNDER_THREAD(RoundTrips))
{
    for (const bool wide : {false, true})
        for (const bool signed_coordinates : {false, true}) {
            expect_round_trip(mixed_schema(), wide, true, signed_coordinates);
            expect_round_trip({}, wide, true, signed_coordinates);
        }
    expect_round_trip(mixed_schema(), false, false, false);
    expect_round_trip(mixed_schema(), true, false, false);
}

// A field that has the same value in all rows takes no bits, one of few values few.
TEST(RowPacking, ConstantFieldsTakeNothing)
{
    std::mt19937_64 random(8);
    const RowLayout layout(mixed_schema(), true);
    const RowPacking packing(layout, mixed_schema(), true);
    std::vector<std::byte> one, block;
    const Rows rows = rows_of("constant", 512, layout, random);
    packing.pack(rows.data(), 1, one);
    packing.pack(rows.data(), 512, block);
    EXPECT_EQ(one.size(), block.size());
    Rows counted = rows;
    for (std::uint32_t i = 0; i < 512; ++i) {
        const std::uint64_t x = 1000000007u + i % 8 * 1024;  // 3 bits, above those that are constant
        std::memcpy(counted.data() + i * layout.bytes, &x, 8);
    }
    std::vector<std::byte> three_bits;
    packing.pack(counted.data(), 512, three_bits);
    EXPECT_EQ(three_bits.size(), block.size() + 512 * 3 / 8);
}

// Differences to the smallest value are stored, so values on both sides of zero need few bits as signed numbers.
TEST(RowPacking, SignedFieldsAreStoredAsSuch)
{
    const Schema schema = test::schema_of({{ScalarType::i32, 1}});
    const RowLayout layout(schema, false);
    const RowPacking packing(layout, schema, false);
    Rows rows(512 * layout.bytes);
    for (std::int32_t i = 0; i < 512; ++i) {
        const std::int32_t value = i % 2 - 1;
        std::memcpy(rows.data() + static_cast<std::size_t>(i) * layout.bytes + layout.offsets[0], &value, 4);
    }
    std::vector<std::byte> packed;
    packing.pack(rows.data(), 512, packed);
    EXPECT_EQ(packed.size(), 8 + 2 + 512 / 8u);
}

// A copy of bytes whose end is the end of the memory that may be read: reading further ends the process.
class BytesBeforeAnAbyss {
public:
    explicit BytesBeforeAnAbyss(const std::vector<std::byte>& bytes)
        : page_(static_cast<std::size_t>(::sysconf(_SC_PAGESIZE))),
          readable_((bytes.size() / page_ + 1) * page_),
          memory_(static_cast<std::byte*>(
              ::mmap(nullptr, readable_ + page_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))),
          size_(bytes.size())
    {
        if (memory_ == MAP_FAILED || ::mprotect(memory_ + readable_, page_, PROT_NONE) != 0)
            throw std::runtime_error("no memory with a guard page");
        std::copy(bytes.begin(), bytes.end(), memory_ + (readable_ - size_));
    }
    ~BytesBeforeAnAbyss() { ::munmap(memory_, readable_ + page_); }
    BytesBeforeAnAbyss(const BytesBeforeAnAbyss&) = delete;
    BytesBeforeAnAbyss& operator=(const BytesBeforeAnAbyss&) = delete;
    const std::byte* data() const { return memory_ + (readable_ - size_); }
    std::size_t size() const { return size_; }

private:
    const std::size_t page_, readable_;
    std::byte* const memory_;
    const std::size_t size_;
};

TEST(RowPacking, AnyOtherLengthIsRefused)
{
    std::mt19937_64 random(9);
    const RowLayout layout(mixed_schema(), false);
    const RowPacking packing(layout, mixed_schema(), true);
    for (const std::string kind : {"constant", "random", "even bytes"})
        for (const std::size_t count : {1u, 40u, 513u}) {
            const Rows rows = rows_of(kind, count, layout, random);
            std::vector<std::byte> packed;
            packing.pack(rows.data(), count, packed);
            Rows back(rows.size());
            const std::size_t step = packed.size() > 3000 ? 97 : 1;
            for (std::size_t size = 0; size < packed.size(); size += step) {
                const BytesBeforeAnAbyss cut({packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size)});
                EXPECT_THROW(packing.unpack(cut.data(), cut.size(), back.data(), count, "file"), Error) << size;
            }
            packed.push_back(std::byte{0});
            EXPECT_THROW(packing.unpack(packed.data(), packed.size(), back.data(), count, "file"), Error);
        }
}

TEST(RowPacking, DamagedBytesTouchNothingOutside)
{
    std::mt19937_64 random(10);
    const RowLayout layout(mixed_schema(), true);
    const RowPacking packing(layout, mixed_schema(), true);
    const std::size_t count = 300, guard = 64;
    const Rows rows = rows_of("even bytes", count, layout, random);
    std::vector<std::byte> packed;
    packing.pack(rows.data(), count, packed);
    int refused = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<std::byte> damaged = packed;
        const std::size_t reach = trial % 2 ? damaged.size() : 160;  // often in the header
        for (int n = 0; n < 1 + trial % 3; ++n) damaged[random() % reach] = static_cast<std::byte>(random());
        Rows back(rows.size() + 2 * guard, std::byte{0x77});
        try {
            packing.unpack(damaged.data(), damaged.size(), back.data() + guard, count, "name");
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::corrupt);
            EXPECT_EQ(error.path(), "name");
            ++refused;
        }
        for (std::size_t b = 0; b < guard; ++b) {
            ASSERT_EQ(back[b], std::byte{0x77});
            ASSERT_EQ(back[back.size() - 1 - b], std::byte{0x77});
        }
    }
    EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace pcm
