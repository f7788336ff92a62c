// A journal gives back the records that were written as a whole, whatever a crash left behind them.

#include "pcm/build/journal.h"

#include "tests/sanitizers.h"
#include "tests/support.h"

#include <fstream>
#include <random>

namespace pcm {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

std::string content(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}
void set_content(const fs::path& path, const std::string& text)
{
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file << text;
}

class JournalTest : public testing::Test {
protected:
    // Records of several lengths: nothing, one byte, zeros, random bytes.
    JournalTest()
    {
        std::mt19937_64 random(3);
        for (const std::size_t size : {1u, 0u, 12u, 5u}) {
            Bytes bytes(size);
            if (size != 12)
                for (std::byte& b : bytes) b = static_cast<std::byte>(random());
            payloads_.push_back(bytes);
        }
        Journal journal(path());
        EXPECT_TRUE(journal.records().empty());
        ends_.push_back(0);
        for (std::size_t r = 0; r < payloads_.size(); ++r) {
            journal.append(kind_of(r), payloads_[r]);
            ends_.push_back(fs::file_size(path()));
        }
        whole_ = content(path());
    }
    fs::path path() const { return folder_ / "journal"; }
    static std::uint32_t kind_of(std::size_t record) { return static_cast<std::uint32_t>(1000 + record); }

    void expect_records(const Journal& journal, std::size_t count) const
    {
        ASSERT_EQ(journal.records().size(), count);
        for (std::size_t r = 0; r < count; ++r) {
            EXPECT_EQ(journal.records()[r].kind, kind_of(r));
            EXPECT_TRUE(journal.records()[r].bytes == payloads_[r]) << r;
        }
    }

    test::TemporaryFolder folder_;
    std::vector<Bytes> payloads_;
    std::vector<std::uintmax_t> ends_;  // size of the file after each record
    std::string whole_;
};

TEST_F(JournalTest, GivesBackWhatWasAppended)
{
    const Journal journal(path());
    expect_records(journal, payloads_.size());
    EXPECT_EQ(content(path()), whole_);
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(JournalTest, PCM_NOT_UNDER_THREAD(CutOffAtEveryByteItKeepsTheWholeRecordsAndAppendsAfterThem))
{
    for (std::size_t size = 0; size <= whole_.size(); ++size) {
        SCOPED_TRACE(size);
        set_content(path(), whole_.substr(0, size));
        std::size_t whole = 0;
        while (whole + 1 < ends_.size() && ends_[whole + 1] <= size) ++whole;
        {
            Journal journal(path());
            expect_records(journal, whole);
            EXPECT_EQ(fs::file_size(path()), ends_[whole]);  // a torn record is removed from the file
            for (std::size_t r = whole; r < payloads_.size(); ++r) journal.append(kind_of(r), payloads_[r]);
        }
        ASSERT_EQ(content(path()), whole_);
    }
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(JournalTest, PCM_NOT_UNDER_THREAD(AByteThatChangedEndsTheRecordsThere))
{
    for (std::size_t at = 0; at < whole_.size(); ++at)
        for (const int bit : {0, 7}) {
            SCOPED_TRACE(at);
            std::string damaged = whole_;
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
            set_content(path(), damaged);
            std::size_t whole = 0;
            while (ends_[whole + 1] <= at) ++whole;
            expect_records(Journal(path()), whole);
        }
}

// The length of a damaged head may say anything; it is not believed.
TEST_F(JournalTest, RandomTailsAreNotTakenForRecords)
{
    std::mt19937_64 random(4);
    for (int trial = 0; trial < 200; ++trial) {
        std::string tail(random() % 100, '\0');
        if (trial % 2)
            for (char& c : tail) c = static_cast<char>(random());
        set_content(path(), whole_ + tail);
        expect_records(Journal(path()), payloads_.size());
        EXPECT_EQ(content(path()), whole_);
    }
}

TEST_F(JournalTest, CutsRecordsInMemoryAndInTheFile)
{
    for (std::size_t from = 0; from <= payloads_.size() + 1; ++from) {
        set_content(path(), whole_);
        const std::size_t left = std::min(from, payloads_.size());
        {
            Journal journal(path());
            journal.cut(from);
            expect_records(journal, left);
            EXPECT_EQ(fs::file_size(path()), ends_[left]);
            journal.append(77, Bytes(9, std::byte{1}));
        }
        const Journal again(path());
        ASSERT_EQ(again.records().size(), left + 1);
        EXPECT_EQ(again.records()[left].kind, 77u);
        EXPECT_EQ(again.records()[left].bytes, Bytes(9, std::byte{1}));
    }
}

TEST_F(JournalTest, ForgetsWhatWasFoundInMemoryAlone)
{
    {
        Journal journal(path());
        journal.forget_found();
        EXPECT_TRUE(journal.records().empty());
        journal.append(kind_of(0), {});
    }
    EXPECT_EQ(Journal(path()).records().size(), payloads_.size() + 1);
    EXPECT_EQ(content(path()).substr(0, whole_.size()), whole_);
}

}  // namespace
}  // namespace pcm
