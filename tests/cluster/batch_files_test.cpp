#include "pcm/cluster/batch_files.h"

#include "pcm/bpc/byte_order.h"
#include "tests/support.h"
#include "tests/thread_team.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

using namespace test;

constexpr const char* stage = "batches";

class BatchFiles : public testing::Test {
protected:
    BatchFiles()
    {
        cloud_.layout = RowLayout(cloud_.schema, false);
        jobs_.begin(stage);
    }
    // A batch of `rows` rows in bin 1 of 2.
    void write(std::uint64_t number, std::size_t rows, const BatchFacts& facts)
    {
        const JobFolder::Key job{stage, number};
        const auto path = jobs_.unfinished(job);
        ByteWriter record;
        std::uint64_t bytes;
        {
            ScratchSpace space;
            Scratch scratch(path, cloud_.layout, cloud_.schema, space);
            scratch.add_bins(2);
            const std::vector<std::byte> zeros(rows * cloud_.layout.bytes);
            Scratch::Work work;
            scratch.append(1, zeros.data(), rows, work);
            bytes = scratch.bytes();
            save_batch(facts, scratch, record);
        }
        jobs_.finish(job, path, bytes, record.bytes());
    }
    // What each of the ranks gets.
    void take(unsigned ranks, std::size_t batches,
              const std::function<void(const BatchFacts&, const BinRows&, const FileInfo&)>& see)
    {
        ThreadTeams(ranks).run([&](Team& team) {
            BinRows rows(cloud_);
            FileInfo info;
            info.notes = {"a header's"};
            const BatchFacts facts = take_batches(team, jobs_, stage, batches, 2, rows, info);
            const std::lock_guard lock(mutex_);
            see(facts, rows, info);
        });
    }

    TemporaryFolder folder_;
    const JobFolder jobs_{folder_.path(), 0, false};
    Ingested cloud_;
    std::mutex mutex_;
};

// Notes and metadata come in the order of the input, whichever rank reads their record, and once.
TEST_F(BatchFiles, HaveWhatWasFoundInTheOrderOfTheInput)
{
    for (std::uint64_t number = 0; number < 5; ++number) {
        BatchFacts facts;
        facts.rounded = number == 3;
        facts.observed.see(Vec3i{static_cast<std::int64_t>(number), 0, 0});
        facts.late.notes = {"note " + std::to_string(number / 2), "a header's"};
        facts.late.metadata = {{"key " + std::to_string(4 - number), {std::byte(number)}}};
        write(number, 10 + number, facts);
    }
    unsigned seen = 0;
    for (const unsigned ranks : {1u, 3u})
        take(ranks, 5, [&](const BatchFacts& facts, const BinRows& rows, const FileInfo& info) {
            ++seen;
            EXPECT_TRUE(facts.kept);
            EXPECT_TRUE(facts.rounded);
            EXPECT_EQ(facts.observed.points, 5u);
            EXPECT_EQ(rows.bins(), 2u);
            EXPECT_EQ(rows.rows(0), 0u);
            EXPECT_EQ(rows.rows(1), 60u);
            EXPECT_EQ(rows.read(1).size(), 60 * cloud_.layout.bytes);
            EXPECT_EQ(info.notes, (std::vector<std::string>{"a header's", "note 0", "note 1", "note 2"}));
            ASSERT_EQ(info.metadata.size(), 5u);
            EXPECT_EQ(info.metadata[0].key, "key 4");
            EXPECT_EQ(info.metadata[4].value, std::vector<std::byte>{std::byte(4)});
        });
    EXPECT_EQ(seen, 4u);
}

TEST_F(BatchFiles, OfWhichOneHasLostIntegersGiveNoRows)
{
    for (std::uint64_t number = 0; number < 3; ++number) {
        BatchFacts facts;
        facts.kept = number != 1;
        write(number, 4, facts);
    }
    take(3, 3, [](const BatchFacts& facts, const BinRows& rows, const FileInfo&) {
        EXPECT_FALSE(facts.kept);
        EXPECT_EQ(rows.bins(), 0u);
    });
}

}  // namespace
}  // namespace pcm
