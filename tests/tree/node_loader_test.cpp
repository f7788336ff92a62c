// Nodes that are read in the background.
#include "pcm/tree/node_loader.h"

#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "tests/tree/small_tree.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;

// A file whose reads wait while it is closed, and fail where it is away.
class DoorFile final : public ByteSource {
public:
    explicit DoorFile(const std::filesystem::path& path) : file_(path, File::Mode::read) {}
    const std::filesystem::path& path() const override { return file_.path(); }
    std::uint64_t size() const override { return file_.size(); }
    std::size_t read_some_at(void* to, std::size_t bytes, std::uint64_t offset) const override
    {
        std::unique_lock lock(mutex_);
        ++reads_;
        change_.notify_all();
        change_.wait(lock, [&] { return is_open_; });
        if (is_away_) throw Error(ErrorCode::io, path(), "the server is away");
        return file_.read_some_at(to, bytes, offset);
    }
    bool keeps_its_name() const override { return true; }

    void set(bool is_open, bool is_away = false)
    {
        const std::lock_guard lock(mutex_);
        is_open_ = is_open;
        is_away_ = is_away;
        change_.notify_all();
    }
    int reads() const
    {
        const std::lock_guard lock(mutex_);
        return reads_;
    }
    void wait_for_reads(int reads) const
    {
        std::unique_lock lock(mutex_);
        change_.wait(lock, [&] { return reads_ >= reads; });
    }

private:
    File file_;
    mutable std::mutex mutex_;
    mutable std::condition_variable change_;
    mutable int reads_ = 0;
    bool is_open_ = true, is_away_ = false;
};

// A tree with pages of seven nodes, the first of which has been read.
class NodeLoaderTest : public SmallTree {
protected:
    void SetUp() override
    {
        build(120000, 1000);
        write_in_pages(tree(), 7);
        file_ = std::make_shared<DoorFile>(index_path());
        nodes_ = open_index(file_).nodes;
        ASSERT_EQ(nodes_.pages_loaded(), 1u);
        ASSERT_GT(nodes_.size(), 100u);
    }
    static void wait_for(const NodeLoader& loader)
    {
        while (loader.waits()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }

    std::shared_ptr<DoorFile> file_;
    NodeTable nodes_;
};

TEST_F(NodeLoaderTest, WhatIsRequestedComesAndNothingElse)
{
    std::atomic<int> woken{0};
    NodeLoader loader(nodes_, 3600);
    loader.set_wake([&] { ++woken; });
    EXPECT_FALSE(loader.waits());
    loader.request({0, 3});
    EXPECT_FALSE(loader.waits());  // they have been read
    std::vector<NodeId> wanted{50, 51, 90};
    loader.request(wanted);
    wait_for(loader);
    std::set<std::uint32_t> pages;  // those above its nodes are read before a page
    const std::vector<Node> all = index().nodes;
    std::vector<NodeId> open = wanted;
    while (!open.empty()) {
        const std::uint32_t page = open.back() / 7;
        open.pop_back();
        if (!pages.insert(page).second) continue;
        for (NodeId id = 7 * page; id < std::min<std::size_t>(7 * (page + 1), all.size()); ++id)
            if (id > 0) open.push_back(all[id].parent);
    }
    for (NodeId id = 0; id < nodes_.size(); ++id) EXPECT_EQ(nodes_.find(id) != nullptr, pages.count(id / 7) != 0) << id;
    EXPECT_EQ(nodes_.find(50), &nodes_[50]);
    EXPECT_GE(woken, 1);
    EXPECT_LE(woken, 3);
    EXPECT_EQ(loader.error(), "");
    EXPECT_EQ(loader.seconds_to_retry(), 0);
}

TEST_F(NodeLoaderTest, ARequestWaitsForNothingAndReplacesTheFormerOne)
{
    NodeLoader loader(nodes_, 3600);
    const int before = file_->reads();
    file_->set(false);
    loader.request({50, 120});
    file_->wait_for_reads(before + 1);
    EXPECT_TRUE(loader.waits());
    EXPECT_EQ(nodes_.find(50), nullptr);
    loader.request({90});
    EXPECT_TRUE(loader.waits());
    file_->set(true);
    wait_for(loader);
    EXPECT_NE(nodes_.find(50), nullptr);  // it was being read
    EXPECT_NE(nodes_.find(90), nullptr);
    EXPECT_EQ(nodes_.find(120), nullptr);
    loader.request({});
    EXPECT_FALSE(loader.waits());
}

TEST_F(NodeLoaderTest, AfterAFailureItWaitsBeforeItTriesAgain)
{
    std::atomic<int> woken{0};
    NodeLoader patient(nodes_, 3600);
    patient.set_wake([&] { ++woken; });
    file_->set(true, true);
    patient.request({50, 90});
    wait_for(patient);
    EXPECT_NE(patient.error().find("the server is away"), std::string::npos) << patient.error();
    EXPECT_GT(patient.seconds_to_retry(), 3500);
    EXPECT_EQ(woken, 1);
    const int reads = file_->reads();
    patient.request({50, 90});
    EXPECT_FALSE(patient.waits());
    EXPECT_EQ(file_->reads(), reads);

    NodeLoader eager(nodes_, 0);
    eager.request({50});
    wait_for(eager);
    EXPECT_NE(eager.error(), "");
    EXPECT_GT(eager.seconds_to_retry(), 0);
    eager.request({});  // nothing is lacking any more
    EXPECT_EQ(eager.error(), "");
    EXPECT_EQ(eager.seconds_to_retry(), 0);
    eager.request({50});
    wait_for(eager);
    file_->set(true);
    eager.request({50});
    wait_for(eager);
    EXPECT_EQ(eager.error(), "");
    EXPECT_NE(nodes_.find(50), nullptr);
}

// A page that is damaged does not keep others away.
TEST_F(NodeLoaderTest, WhatFailedIsTriedAfterTheOthers)
{
    NodeLoader loader(nodes_, 0);
    file_->set(true, true);
    loader.request({50});
    wait_for(loader);
    EXPECT_EQ(nodes_.find(90), nullptr);
    const int before = file_->reads();
    file_->set(false);
    loader.request({50, 90});
    file_->wait_for_reads(before + 1);
    loader.request({});  // what is being read stays
    file_->set(true);
    wait_for(loader);
    EXPECT_NE(nodes_.find(90), nullptr);
    EXPECT_EQ(nodes_.find(50), nullptr);
}

TEST_F(NodeLoaderTest, ThreadsLookAtNodesWhileTheyComeAndTheEndWaits)
{
    for (int round = 0; round < 20; ++round) {
        const NodeTable nodes = open_index(file_).nodes;
        std::atomic<bool> ends{false};
        std::atomic<std::size_t> seen{0};
        std::thread looker([&] {
            do {
                for (NodeId id = 0; id < nodes.size(); ++id)
                    if (const Node* const node = nodes.find(id)) seen += node->points > 0;
            } while (!ends);
        });
        {
            NodeLoader loader(nodes, 3600);
            std::vector<NodeId> all;
            for (NodeId id = 0; id < nodes.size(); ++id) all.push_back(id);
            loader.request(all);
            if (round % 2) wait_for(loader);
        }
        ends = true;
        looker.join();
        EXPECT_GT(seen, 0u);
        if (round % 2) EXPECT_EQ(nodes.pages_loaded(), nodes.pages());
    }
}

}  // namespace
