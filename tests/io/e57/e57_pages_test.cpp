// The content of pages as it was written, at any offset, and not a byte more.
#include "pcm/io/e57/e57_pages.h"

#include "pcm/system/error.h"
#include "tests/io/e57/e57_file.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>

namespace pcm::test {
namespace {

// Random bytes of this number of pages, and a file of them.
class E57PagesTest : public ::testing::Test {
protected:
    void write(std::size_t pages, std::uint64_t seed)
    {
        std::mt19937_64 random(seed);
        content_.clear();
        while (content_.size() < pages * E57Pages::content_bytes) content_ += static_cast<char>(random());
        write_file(path_, e57_pages(content_));
    }
    std::string read(E57Pages& pages, std::uint64_t logical, std::size_t bytes) const
    {
        std::string read(bytes, '?');
        pages.read(read.data(), bytes, logical);
        return read;
    }
    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "a.e57";
    std::string content_;
};

TEST_F(E57PagesTest, AnyBytesAreThoseOfTheContent)
{
    write(150, 3);  // more than are read at once
    E57Pages pages(path_);
    EXPECT_EQ(pages.physical_size(), 150 * 1024u);
    ASSERT_EQ(pages.logical_size(), content_.size());
    std::mt19937_64 random(4);
    for (int i = 0; i < 2000; ++i) {
        const std::uint64_t logical = random() % (content_.size() + 1);
        const auto bytes = static_cast<std::size_t>(random() % (i % 50 ? 2100 : 90000));
        const std::size_t there = std::min<std::size_t>(bytes, content_.size() - logical);
        ASSERT_EQ(read(pages, logical, there), content_.substr(logical, there)) << logical << " " << there;
    }
    EXPECT_EQ(read(pages, 0, content_.size()), content_);
}

TEST_F(E57PagesTest, TheEndIsTheLastByteOfTheLastPage)
{
    for (const std::size_t count : {1u, 3u, 64u, 65u}) {
        write(count, count);
        E57Pages pages(path_);
        const std::uint64_t size = content_.size();
        EXPECT_EQ(read(pages, size, 0), "");
        EXPECT_EQ(read(pages, size - 7, 7), content_.substr(size - 7));
        constexpr auto most = std::numeric_limits<std::size_t>::max();
        for (const auto& [logical, bytes] : {std::pair<std::uint64_t, std::size_t>{size, 1},
                                             {size - 7, 8},
                                             {0, size + 1},
                                             {size + 1, 0},
                                             {size + 1020, 1},
                                             {1, most},
                                             {size - 1, 1030},
                                             {~std::uint64_t{0}, 1}}) {
            std::string to(std::min<std::size_t>(bytes, 70000), '?');
            try {
                pages.read(to.data(), bytes, logical);
                ADD_FAILURE() << "read " << bytes << " from " << logical << " of " << size;
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::truncated);
                const std::string text = error.what();
                EXPECT_NE(text.find("ends at byte " + std::to_string(1024 * count) + ";"), std::string::npos) << text;
                EXPECT_NE(text.find("; " + std::to_string(bytes) + " bytes of content"), std::string::npos) << text;
                EXPECT_NE(text.find("from byte " + std::to_string(e57_physical(logical))), std::string::npos) << text;
                EXPECT_EQ(to.find_first_not_of('?'), std::string::npos) << "nothing is read";
            }
        }
    }
}

TEST_F(E57PagesTest, OffsetsOfChecksumsAndBeyondTheFileAreNone)
{
    write(3, 1);
    const E57Pages pages(path_);
    for (std::uint64_t physical = 0; physical < 4 * 1024; ++physical) {
        const bool there = physical < 3 * 1024 && physical % 1024 < 1020;
        ASSERT_EQ(pages.to_logical(physical), there ? physical - physical / 1024 * 4 : 3060u) << physical;
        if (!there) continue;
        ASSERT_EQ(E57Pages::to_physical(pages.to_logical(physical)), physical);
    }
}

// Only pages that are read are checked, each time that they are read from the file.
TEST_F(E57PagesTest, AWrongByteIsFoundWhereItIsRead)
{
    for (const std::size_t wrong : {std::size_t{0}, std::size_t{70}, std::size_t{149}}) {
        write(150, 7);
        std::string file = e57_pages(content_);
        file[wrong * 1024 + 5] = static_cast<char>(file[wrong * 1024 + 5] ^ 1);
        write_file(path_, file);
        E57Pages pages(path_);
        for (std::size_t page = 0; page < 150; ++page) {
            const auto one = [&] { return read(pages, page * 1020 + 100, 3); };
            if (page != wrong) {
                EXPECT_EQ(one(), content_.substr(page * 1020 + 100, 3));
                continue;
            }
            for (int again = 0; again < 2; ++again) {
                try {
                    one();
                    ADD_FAILURE() << "page " << page;
                } catch (const Error& error) {
                    EXPECT_EQ(error.code(), ErrorCode::corrupt);
                    const std::string text = error.what(), number = std::to_string(page);
                    const std::string place = "page " + number + ", from byte " + std::to_string(page * 1024) + ":";
                    EXPECT_NE(text.find(place), std::string::npos) << text;
                }
            }
        }
    }
}

// The pages that were there before a read that failed half-way are read again.
TEST_F(E57PagesTest, AfterAReadThatFailedPagesAreReadAnew)
{
    write(150, 9);
    E57Pages pages(path_);
    EXPECT_EQ(read(pages, 0, 1020), content_.substr(0, 1020));
    std::filesystem::resize_file(path_, 110 * 1024);
    EXPECT_THROW(read(pages, 100 * 1020, 1), Error);
    for (std::size_t page = 0; page < 12; ++page)
        EXPECT_EQ(read(pages, page * 1020, 1020), content_.substr(page * 1020, 1020)) << page;
}

}  // namespace
}  // namespace pcm::test
