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

// Sequences as in chunks, and harder ones: constant, small steps, multiples of a power of two, full range, extremes, a
// few values far apart.
template <class Word>
std::vector<Word> sequence(std::mt19937_64& random, std::size_t count, int kind)
{
    std::vector<Word> values(count);
    Word walk = static_cast<Word>(random());
    const int width = static_cast<int>(random() % (sizeof(Word) * 8)) + 1;
    const int shift = static_cast<int>(random() % (sizeof(Word) * 8));
    std::vector<Word> few(1 + random() % 300);
    for (Word& v : few) v = static_cast<Word>(random());
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
            case 6:
                v = few[static_cast<std::size_t>(any % few.size())];
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
        const int kind = static_cast<int>(random() % 8);
        expect_round_trip(sequence<Word>(random, count, kind), "case " + std::to_string(i));
    }
}

TEST(ColumnCodec, RoundTrips32) { random_round_trips<std::uint32_t>(); }
TEST(ColumnCodec, RoundTrips64) { random_round_trips<std::uint64_t>(); }

TEST(ColumnCodec, BlockBoundaries)
{
    for (const std::size_t count : {1u, 2u, 127u, 128u, 129u, 255u, 256u, 257u}) {
        std::mt19937_64 random(count);
        for (int kind = 0; kind < 8; ++kind) {
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

// Colours of 8 bits that a program has stretched to 16.
std::vector<std::uint32_t> stretched(std::size_t distinct, std::size_t count)
{
    std::mt19937_64 random(5);
    std::vector<std::uint32_t> values(count);
    for (std::size_t i = 0; i < count; ++i)
        values[i] = static_cast<std::uint32_t>((i < distinct ? i : random() % distinct) * 257);
    return values;
}

TEST(ColumnCodec, FewValuesAreListed)
{
    for (const std::size_t distinct : {190u, 256u}) {
        const auto values = stretched(distinct, 4096);
        expect_round_trip(values, std::to_string(distinct));
        EXPECT_LT(packed(values).size(), 4096u + 512) << distinct;  // 8 bits a value, the blocks and the list
    }
    EXPECT_GT(packed(stretched(257, 4096)).size(), 2 * 4096u);
    expect_round_trip(stretched(257, 4096), "257");
}

void set_size(std::vector<std::byte>& bytes)
{
    const auto size = static_cast<std::uint32_t>(bytes.size());
    std::memcpy(bytes.data() + 4, &size, 4);
}

// The bytes of FORMAT.md: the values 5, 70000 and 9000000, and the places 0, 1, 2, 1.
std::vector<std::byte> listed_bytes()
{
    const std::vector<std::byte> values = packed<std::uint32_t>({5, 70000, 9000000}),
                                 places = packed<std::uint32_t>({0, 1, 2, 1});
    std::vector<std::byte> bytes(16);
    bytes[0] = std::byte(3);
    bytes[2] = std::byte(2);
    bytes.insert(bytes.end(), values.begin(), values.end());
    bytes.insert(bytes.end(), places.begin(), places.end());
    set_size(bytes);
    return bytes;
}

void expect_listed(const std::vector<std::byte>& bytes, const std::string& refusal)
{
    std::vector<std::byte> padded = bytes;
    padded.resize(bytes.size() + pcm::codec_slack);
    std::vector<std::uint32_t> back(4);
    try {
        EXPECT_EQ(pcm::unpack(padded.data(), bytes.size(), back.data(), back.size(), "f"), bytes.size());
        EXPECT_EQ(back, (std::vector<std::uint32_t>{5, 70000, 9000000, 70000}));
        EXPECT_EQ(refusal, "");
    } catch (const pcm::Error& error) {
        EXPECT_NE(refusal, "");
        EXPECT_NE(std::string(error.what()).find(refusal), std::string::npos) << error.what();
    }
}

TEST(ColumnCodec, ListsAreChecked)
{
    const std::vector<std::byte> good = listed_bytes();
    expect_listed(good, "");
    std::vector<std::byte> bad = good;
    bad[2] = std::byte(1);  // one value fewer than there are places for
    expect_listed(bad, "a place beyond its list");
    bad = good;
    bad[3] = std::byte(1);
    expect_listed(bad, "too many listed values");
    bad = good;
    bad[16] = std::byte(3);
    expect_listed(bad, "a list within a list");
    bad = good;
    bad[16 + 8] = std::byte(0xff);  // the base of all listed values
    bad[16] = std::byte(0);         // and all are this one
    expect_listed(bad, "packed column: ");
    const std::vector<std::uint32_t> same(3, 7);
    const std::vector<std::byte> equal = packed(same);
    bad.assign(good.begin(), good.begin() + 16);
    const std::vector<std::byte> places = packed<std::uint32_t>({0, 1, 2, 1});
    bad.insert(bad.end(), equal.begin(), equal.end());
    bad.insert(bad.end(), places.begin(), places.end());
    set_size(bad);
    expect_listed(bad, "listed values out of order");
    bad = good;
    bad.push_back(std::byte(0));
    set_size(bad);
    expect_listed(bad, "longer than its lists");
}

// Any bytes: either they are refused or they give values, and nothing outside is touched (the sanitizer sees to that).
TEST(ColumnCodec, SurvivesDamage)
{
    std::mt19937_64 random(11);
    std::size_t refused = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto values = sequence<std::uint64_t>(random, 1 + random() % 300, static_cast<int>(random() % 8));
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
