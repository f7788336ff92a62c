// Bins of points on disk, as a build writes them and one that resumes finds them.

#include "pcm/build/levels/sorted_points.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <random>
#include <vector>

namespace {

using namespace pcm;

template <class Coord>
class SortedPointsTest : public testing::Test {
protected:
    using Points = std::vector<Point<Coord>>;

    // Bins of many sizes, those of whole blocks too; the last but one stays empty.
    void SetUp() override
    {
        for (const std::size_t size : {std::size_t(1), sorted_block - 1, sorted_block, sorted_block + 1,
                                       3 * sorted_block, 3 * sorted_block + 500, std::size_t(0), std::size_t(77)}) {
            Points points(size);
            for (Point<Coord>& p : points)
                for (Coord& c : p) c = static_cast<Coord>(random_());
            bins_.push_back(points);
        }
        SortedPoints<Coord> written(path_, File::Mode::create_new);
        written.resize(bins_.size());
        for (std::size_t b = bins_.size(); b-- > 0;)
            if (!bins_[b].empty()) bytes_ += written.put(b, bins_[b]);
        EXPECT_EQ(written.bytes(), bytes_);
        for (std::size_t b = 0; b < bins_.size(); ++b) written.save(b, saved_);
    }

    static void expect_bin(const SortedPoints<Coord>& store, std::size_t bin, const Points& expected)
    {
        typename SortedPoints<Coord>::Reader reader(store, bin);
        ASSERT_EQ(reader.size(), expected.size());
        ASSERT_EQ(store.box(bin).points, expected.size());
        for (std::size_t i = expected.size(); i-- > 0;) ASSERT_EQ(reader[i], expected[i]) << bin << " " << i;
        for (std::size_t a = 0; a < 3 && !expected.empty(); ++a) {
            const auto [low, high] = std::minmax_element(expected.begin(), expected.end(),
                                                         [&](const auto& p, const auto& q) { return p[a] < q[a]; });
            EXPECT_EQ(store.box(bin).low[a], (*low)[a]);
            EXPECT_EQ(store.box(bin).high[a], (*high)[a]);
        }
    }

    // The code of the Error that loading all bins from the first `size` bytes saved throws.
    ErrorCode refusal(std::size_t size)
    {
        SortedPoints<Coord> found(path_, File::Mode::change);
        found.resize(bins_.size());
        ByteReader in(saved_.bytes().data(), size, "saved");
        try {
            for (std::size_t b = 0; b < bins_.size(); ++b) found.load(b, in);
        } catch (const Error& error) {
            return error.code();
        }
        return ErrorCode::cancelled;  // none
    }

    std::mt19937_64 random_{3};
    const test::TemporaryFolder folder_;
    const std::filesystem::path path_ = folder_.path() / "points";
    std::vector<Points> bins_;
    ByteWriter saved_;
    std::uint64_t bytes_ = 0;
};

using Coordinates = testing::Types<std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(SortedPointsTest, Coordinates);

TYPED_TEST(SortedPointsTest, AreFoundAgainWhereTheyWereSaved)
{
    SortedPoints<TypeParam> found(this->path_, File::Mode::change);
    EXPECT_EQ(found.bytes(), this->bytes_);
    found.resize(this->bins_.size());
    ByteReader in(this->saved_.bytes().data(), this->saved_.size(), "saved");
    for (std::size_t b = 0; b < this->bins_.size(); ++b) found.load(b, in);
    EXPECT_EQ(in.left(), 0u);
    for (std::size_t b = 0; b < this->bins_.size(); ++b) this->expect_bin(found, b, this->bins_[b]);
    // What is put then lies behind them.
    const auto more = std::vector<Point<TypeParam>>(this->bins_[3].rbegin(), this->bins_[3].rend());
    this->bytes_ += found.put(6, more);
    EXPECT_EQ(found.bytes(), this->bytes_);
    this->expect_bin(found, 6, more);
    this->expect_bin(found, 0, this->bins_[0]);
}

TYPED_TEST(SortedPointsTest, OfWhichSomeAreMissingAreRefused)
{
    EXPECT_EQ(this->refusal(this->saved_.size()), ErrorCode::cancelled);
    for (std::size_t size = 0; size < this->saved_.size(); size += 7)
        EXPECT_EQ(this->refusal(size), ErrorCode::corrupt) << size;
    std::filesystem::resize_file(this->path_, this->bytes_ - 1);
    EXPECT_EQ(this->refusal(this->saved_.size()), ErrorCode::corrupt);
}

TYPED_TEST(SortedPointsTest, ChangedBytesAreNoticed)
{
    SortedPoints<TypeParam> found(this->path_, File::Mode::change);
    found.resize(this->bins_.size());
    ByteReader in(this->saved_.bytes().data(), this->saved_.size(), "saved");
    for (std::size_t b = 0; b < this->bins_.size(); ++b) found.load(b, in);
    File file(this->path_, File::Mode::change);
    std::byte last{};
    file.read_at(&last, 1, this->bytes_ - 1);  // a byte of bin 0, which was put last
    last ^= std::byte{1};
    file.write_at(&last, 1, this->bytes_ - 1);
    typename SortedPoints<TypeParam>::Reader reader(found, 0);
    EXPECT_THROW(reader[0], Error);
    this->expect_bin(found, 1, this->bins_[1]);
}

}  // namespace
