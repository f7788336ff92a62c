// Rows come back from a spool as they were written, behind what the caller has already.
#include "pcm/build/bins/spool.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"
#include "tests/build/schema_of.h"
#include "tests/support.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

using Rows = std::vector<std::byte>;

Schema mixed_schema() { return schema_of({{ScalarType::u16, 1}, {ScalarType::u8, 3}, {ScalarType::f64, 1}}); }

// Random attributes; coordinates of doubles are quotients of 1000, of 7 or any, by block.
Rows random_rows(std::size_t count, const RowLayout& layout, bool doubles, int kind, std::mt19937_64& random)
{
    Rows rows(count * layout.bytes);
    for (std::byte& b : rows) b = static_cast<std::byte>(random());
    for (std::size_t i = 0; doubles && i < count; ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            const double number = static_cast<double>(static_cast<std::int64_t>(random() >> 34) - (1 << 29));
            const double value = kind == 0 ? number / 1000 : kind == 1 ? number / 7 : number * 1.2345678912345e-3;
            std::memcpy(rows.data() + i * layout.bytes + a * sizeof value, &value, sizeof value);
        }
    return rows;
}

std::vector<std::string> sorted(const Rows& rows, std::size_t row_bytes)
{
    std::vector<std::string> texts;
    for (std::size_t at = 0; at < rows.size(); at += row_bytes)
        texts.emplace_back(reinterpret_cast<const char*>(rows.data()) + at, row_bytes);
    std::sort(texts.begin(), texts.end());
    return texts;
}

TEST(Spool, IsReadByAnotherWhereItIsKept)
{
    std::mt19937_64 random(3);
    for (const bool doubles : {false, true}) {
        TemporaryFolder folder;
        ScratchSpace space;
        const RowLayout layout(mixed_schema(), doubles);
        ByteWriter saved;
        Rows all, back;
        {
            Spool spool(folder / "spool", layout, mixed_schema(), doubles, space);
            Spool::Writer writer(spool);
            for (int block = 0; block < 6; ++block) {
                Rows written = random_rows(1 + random() % 3000, layout, doubles, block % 3, random);
                all.insert(all.end(), written.begin(), written.end());
                writer.append(written.data(), written.size() / layout.bytes);
            }
            spool.keep();
            spool.save(saved);
        }
        for (int time = 0; time < 2; ++time) {
            ByteReader in(saved.bytes().data(), saved.size(), {});
            const Spool spool(folder / "spool", layout, mixed_schema(), doubles, space, in);
            EXPECT_EQ(in.left(), 0u);
            EXPECT_EQ(spool.rows(), all.size() / layout.bytes);
            back.clear();
            for (std::size_t piece = 0; piece < spool.pieces(); ++piece) spool.read(piece, back);
            EXPECT_TRUE(back == all);
        }
        EXPECT_TRUE(std::filesystem::exists(folder / "spool"));
    }
}

TEST(Spool, GivesBackEveryRowOfEveryWriter)
{
    std::mt19937_64 random(1);
    for (const bool doubles : {false, true}) {
        TemporaryFolder folder;
        ScratchSpace space;
        const RowLayout layout(mixed_schema(), doubles);
        Spool spool(folder / "spool", layout, mixed_schema(), doubles, space);
        EXPECT_EQ(spool.row_bytes(), layout.bytes);
        Spool::Writer first(spool), second(spool);
        Rows all;
        std::uint64_t count = 0;
        for (int block = 0; block < 12; ++block) {
            const std::size_t rows = block == 3 ? 0 : 1 + random() % 3000;
            Rows written = random_rows(rows, layout, doubles, block % 4 / (block < 6 ? 1 : 2), random);
            all.insert(all.end(), written.begin(), written.end());
            (block % 2 ? second : first).append(written.data(), rows);
            count += rows;
            EXPECT_EQ(spool.rows(), count);
        }
        ASSERT_EQ(spool.pieces(), 11u) << "no block without rows";
        EXPECT_EQ(space.peak() % ScratchFile::page, 0u);
        // All into one vector, behind what is there; and each alone.
        const Rows before(3 * layout.bytes, std::byte{0x5a});
        Rows together = before, apart;
        for (std::size_t piece = 0; piece < spool.pieces(); ++piece) {
            spool.read(piece, together);
            Rows alone;
            spool.read(piece, alone);
            apart.insert(apart.end(), alone.begin(), alone.end());
        }
        EXPECT_TRUE(std::equal(before.begin(), before.end(), together.begin()));
        together.erase(together.begin(), together.begin() + static_cast<std::ptrdiff_t>(before.size()));
        EXPECT_TRUE(together == apart);
        EXPECT_EQ(sorted(apart, layout.bytes), sorted(all, layout.bytes));
    }
}

TEST(Spool, ReleasesBlocksAndItsFile)
{
    TemporaryFolder folder;
    ScratchSpace space;
    std::mt19937_64 random(2);
    {
        const RowLayout layout(mixed_schema(), false);
        Spool spool(folder / "spool", layout, mixed_schema(), false, space);
        Spool::Writer writer(spool);
        for (int block = 0; block < 3; ++block) {
            Rows rows = random_rows(1000, layout, false, 0, random);
            writer.append(rows.data(), 1000);
        }
        const std::uint64_t peak = space.peak();
        EXPECT_GT(peak, 3 * 1000 * layout.bytes / 2);
        spool.give_back(1);
        space.take(peak / 3);  // as much as the block had
        EXPECT_EQ(space.peak(), peak);
        Rows rows;
        spool.read(0, rows);
        spool.read(2, rows);
        EXPECT_EQ(rows.size(), 2000 * layout.bytes);
        // Neither a hole nor damaged bytes are read as a block.
        EXPECT_THROW(spool.read(1, rows), Error);
        std::fstream(folder / "spool", std::ios::in | std::ios::out | std::ios::binary).put('\x7f').put('\x01');
        EXPECT_THROW(spool.read(0, rows), Error);
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "spool"));
}

}  // namespace
