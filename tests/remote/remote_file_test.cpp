#include "pcm/remote/remote_file.h"

#include "pcm/system/error.h"
#include "pcm/system/work_done.h"
#include "tests/remote/scripted_server.h"
#include "tests/support.h"

#include <random>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr std::uint64_t block = RemoteFile::block_bytes;

std::string random_bytes(std::size_t size, unsigned seed)
{
    std::mt19937_64 random(seed);
    std::string bytes(size, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    return bytes;
}

class RemoteFileTest : public testing::Test {
protected:
    static std::string read(const ByteSource& file, std::uint64_t offset, std::size_t bytes)
    {
        std::string to(bytes, '\0');
        to.resize(file.read_some_at(to.data(), bytes, offset));
        return to;
    }
    std::size_t asked() const { return server_.requests().size(); }

    const std::string content_ = random_bytes(12 * block + 12345, 1);
    ScriptedServer server_{[this](const HttpRequest& request) { return answer_for(request, content_); }};
    TemporaryFolder temporary_;
    const BlockFolder none_{temporary_ / "none", 0}, folder_{temporary_ / "kept", std::uint64_t{64} << 20};
};

TEST_F(RemoteFileTest, AnyReadIsThatOfTheFile)
{
    const RemoteFile file(server_.address("x"), none_);
    std::mt19937 random(2);
    for (int i = 0; i < 200; ++i) {
        const std::uint64_t offset = random() % (content_.size() + 1000);
        const std::size_t bytes = random() % (i % 2 ? 1000 : 4 * block);
        EXPECT_EQ(read(file, offset, bytes), offset < content_.size() ? content_.substr(offset, bytes) : "");
    }
    EXPECT_EQ(file.size(), content_.size());
    EXPECT_LE(asked(), 20u);
    std::string to(10, ' ');
    EXPECT_THROW(file.read_at(to.data(), 10, content_.size() - 9), Error);
    EXPECT_NO_THROW(file.read_at(to.data(), 10, content_.size() - 10));
}

TEST_F(RemoteFileTest, NothingIsAskedBeforeTheFirstReadAndEachBlockOnce)
{
    const RemoteFile file(server_.address("x"), none_);
    EXPECT_EQ(asked(), 0u);
    read(file, 3 * block + 5, 10);
    EXPECT_EQ(asked(), 1u);
    read(file, 3 * block, block);
    EXPECT_EQ(asked(), 1u);
    // Blocks 0 to 2 and 4 to 11, in requests of at most 8 blocks.
    read(file, 0, 12 * block);
    EXPECT_EQ(asked(), 3u);
    std::uint64_t sum = 0;
    for (const HttpRequest& request : server_.requests()) sum += request.range()->second - request.range()->first + 1;
    EXPECT_EQ(sum, 12 * block);
}

TEST_F(RemoteFileTest, RequestsGrowWhereReadsFollowEachOtherUpToABound)
{
    const std::string large = random_bytes(40 * block, 5);
    server_.set_handler([&](const HttpRequest& request) { return answer_for(request, large); });
    const auto blocks_of = [](const HttpRequest& request) {
        return (request.range()->second - request.range()->first + 1) / block;
    };
    const RemoteFile in_steps(server_.address("x"), none_);
    for (std::uint64_t at = 0; at < large.size(); at += block / 2) read(in_steps, at, block / 2);
    std::vector<std::uint64_t> asked;
    for (const HttpRequest& request : server_.requests()) asked.push_back(blocks_of(request));
    EXPECT_EQ(asked, (std::vector<std::uint64_t>{4, 8, 8, 8, 8, 4}));
    const RemoteFile at_once(server_.address("x"), none_);
    read(at_once, 20 * block, 20 * block);
    for (std::size_t i = asked.size(); i < server_.requests().size(); ++i)
        EXPECT_LE(blocks_of(server_.requests()[i]), RemoteFile::most_blocks_of_request);
    // Reads here and there bring what they ask for.
    const std::size_t before = server_.requests().size();
    const RemoteFile scattered(server_.address("x"), none_);
    for (const std::uint64_t number : {30u, 10u, 20u, 35u, 15u}) read(scattered, number * block, 10);
    for (std::size_t i = before; i < server_.requests().size(); ++i) EXPECT_EQ(blocks_of(server_.requests()[i]), 1u);
}

TEST_F(RemoteFileTest, WhatWasReadServesTheNextProcess)
{
    read(RemoteFile(server_.address("x"), folder_), 0, 5 * block);
    const std::size_t before = asked();
    const RemoteFile file(server_.address("x"), folder_);
    EXPECT_EQ(read(file, 100, 4 * block), content_.substr(100, 4 * block));
    EXPECT_EQ(asked(), before + 1);  // whether it is still that file
    EXPECT_EQ(server_.requests().back().method, "HEAD");
    EXPECT_EQ(read(file, 6 * block, 10), content_.substr(6 * block, 10));
    EXPECT_EQ(asked(), before + 2);
}

TEST_F(RemoteFileTest, WhatIsKeptOfAnOlderFileIsNotShown)
{
    read(RemoteFile(server_.address("x"), folder_), 0, 5 * block);
    const std::string newer = random_bytes(content_.size(), 3);
    server_.set_handler([&](const HttpRequest& request) { return answer_for(request, newer, "b"); });
    const RemoteFile file(server_.address("x"), folder_);
    EXPECT_EQ(read(file, 100, 3 * block), newer.substr(100, 3 * block));
    EXPECT_TRUE(file.keeps_its_name());
    server_.set_handler([&](const HttpRequest& request) { return answer_for(request, content_, "a"); });
    EXPECT_FALSE(file.keeps_its_name());
    EXPECT_THROW(read(file, 8 * block, 10), Error);
    EXPECT_EQ(read(file, 200, 100), newer.substr(200, 100));  // in memory, and of one file
}

TEST_F(RemoteFileTest, WithoutTheServerWhatIsKeptIsShownAndNothingElse)
{
    read(RemoteFile(server_.address("x"), folder_), 0, 5 * block);
    const std::string address = server_.address("x");
    server_.stop();
    const RemoteFile file(address, folder_);
    EXPECT_EQ(read(file, 100, 4 * block), content_.substr(100, 4 * block));
    EXPECT_EQ(file.size(), content_.size());
    try {
        read(file, 8 * block, 10);
        FAIL();
    } catch (const Error& error) {
        EXPECT_TRUE(is_unreachable(error)) << error.what();
    }
    EXPECT_THROW(read(RemoteFile(address, none_), 0, 10), Error);
}

TEST_F(RemoteFileTest, ManyThreadsReadItWhileConnectionsFail)
{
    std::atomic<int> count{0};
    server_.set_handler([&](const HttpRequest& request) {
        HttpAnswer answer = answer_for(request, content_);
        switch (++count % 5) {
            case 1:
                answer = HttpAnswer();
                answer.status = 503;
                break;
            case 3:
                answer.cut_after = answer.body.size() / 2;
                break;
            default:
                break;
        }
        return answer;
    });
    const RemoteFile file(server_.address("x"), none_);
    const WorkDone before = work_done();
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < 6; ++i)
        threads.emplace_back([&, i] {
            std::mt19937 random(i);
            for (int k = 0; k < 40; ++k) {
                const std::uint64_t offset = random() % content_.size();
                EXPECT_EQ(read(file, offset, 200000), content_.substr(offset, 200000));
            }
        });
    for (std::thread& thread : threads) thread.join();
    const WorkDone done = work_done() - before;
    EXPECT_EQ(done.requests, asked());
    EXPECT_GE(done.bytes_received, content_.size());
    EXPECT_LE(done.bytes_received, 2 * content_.size());
}

}  // namespace
