#include "pcm/bpc/column_codec.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <cstring>
#include <random>

namespace {

template <class Word>
std::vector<std::byte> packed(const std::vector<Word>& values)
{
    std::vector<std::byte> bytes;
    pcm::pack(values.data(), values.size(), bytes);
    return bytes;
}

template <class Word>
void expect_round_trip(const std::vector<Word>& values, const std::string& what)
{
    std::vector<std::byte> bytes = packed(values);
    const std::size_t size = bytes.size();
    bytes.resize(size + pcm::codec_slack);
    std::vector<Word> back(values.size());
    EXPECT_EQ(pcm::unpack(bytes.data(), size, back.data(), back.size(), {}), size) << what;
    EXPECT_EQ(back, values) << what;
}

// Sequences as in chunks, and harder ones: constant, small steps, multiples of a power of two, full range, extremes.
template <class Word>
std::vector<Word> sequence(std::mt19937_64& random, std::size_t count, int kind)
{
    std::vector<Word> values(count);
    Word walk = static_cast<Word>(random());
    const int width = static_cast<int>(random() % (sizeof(Word) * 8)) + 1;
    const int shift = static_cast<int>(random() % (sizeof(Word) * 8));
    for (Word& v : values) {
        const auto any = static_cast<Word>(random());
        switch (kind) {
            case 0:
                v = walk;
                break;
            case 1:
                v = any;
                break;
            case 2:
                v = walk = static_cast<Word>(walk + (any >> (sizeof(Word) * 8 - width)) - (Word(1) << (width - 1)));
                break;
            case 3:
                v = static_cast<Word>(any >> (sizeof(Word) * 8 - width));
                break;
            case 4:
                v = static_cast<Word>((any & 15) << shift);
                break;
            case 5:
                v = any & 1 ? ~Word(0) : Word(0);
                break;
            default:
                v = random() % 1000 ? walk : any;
                break;
        }
    }
    return values;
}

template <class Word>
void random_round_trips()
{
    std::mt19937_64 random(7);
    for (int i = 0; i < 3000; ++i) {
        const std::size_t count = 1 + random() % 700;
        const int kind = static_cast<int>(random() % 7);
        expect_round_trip(sequence<Word>(random, count, kind), "case " + std::to_string(i));
    }
}

TEST(ColumnCodec, RoundTrips32) { random_round_trips<std::uint32_t>(); }
TEST(ColumnCodec, RoundTrips64) { random_round_trips<std::uint64_t>(); }

TEST(ColumnCodec, BlockBoundaries)
{
    for (const std::size_t count : {1u, 2u, 127u, 128u, 129u, 255u, 256u, 257u}) {
        std::mt19937_64 random(count);
        for (int kind = 0; kind < 7; ++kind) {
            expect_round_trip(sequence<std::uint32_t>(random, count, kind), std::to_string(count));
            expect_round_trip(sequence<std::uint64_t>(random, count, kind), std::to_string(count));
        }
    }
}

TEST(ColumnCodec, ConstantTakesSixteenBytes) { EXPECT_EQ(packed(std::vector<std::uint32_t>(100000, 42)).size(), 16u); }

TEST(ColumnCodec, RampPacksToAFewBitsAValue)
{
    std::vector<std::uint32_t> values(12800);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint32_t>(1000000 + i * 256);
    EXPECT_LT(packed(values).size(), values.size());  // 2 bits of difference and the block table
}

TEST(ColumnCodec, TruncationIsRefusedAtEveryLength)
{
    std::mt19937_64 random(3);
    const auto values = sequence<std::uint32_t>(random, 300, 2);
    std::vector<std::byte> bytes = packed(values);
    const std::size_t size = bytes.size();
    bytes.resize(size + pcm::codec_slack);
    std::vector<std::uint32_t> back(values.size());
    for (std::size_t length = 0; length < size; ++length)
        EXPECT_THROW(pcm::unpack(bytes.data(), length, back.data(), back.size(), "f"), pcm::Error) << length;
}

// Any bytes: either they are refused or they give values, and nothing outside is touched (the sanitizer sees to that).
TEST(ColumnCodec, SurvivesDamage)
{
    std::mt19937_64 random(11);
    std::size_t refused = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto values = sequence<std::uint64_t>(random, 1 + random() % 300, static_cast<int>(random() % 7));
        const std::vector<std::byte> good = packed(values);
        // A copy of exactly the right size, so that reading past the slack is seen.
        std::vector<std::byte> bytes(good.size() + pcm::codec_slack);
        std::memcpy(bytes.data(), good.data(), good.size());
        for (int k = 0; k < 3; ++k) bytes[random() % good.size()] = static_cast<std::byte>(random());
        std::vector<std::uint64_t> back(values.size());
        try {
            pcm::unpack(bytes.data(), good.size(), back.data(), back.size(), "f");
        } catch (const pcm::Error& error) {
            EXPECT_EQ(error.code(), pcm::ErrorCode::corrupt);
            ++refused;
        }
    }
    EXPECT_GT(refused, 1000u);
}

}  // namespace
