#include "pcm/tree/tree.h"

#include "pcm/convert/open_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/tree/verify.h"
#include "pcm/update/repair.h"
#include "pcm/update/tree_update.h"
#include "tests/remote/scripted_server.h"
#include "tests/tree/small_tree.h"

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// A tree on a server of this machine.
class RemoteTreeTest : public SmallTree {
protected:
    RemoteTreeTest()
    {
        setenv("PCM_NETWORK_CACHE", "0", 1);
        build();
    }
    fs::path address() const { return server_.address(tree().filename().string()); }

    ScriptedServer server_{files_of(tree().parent_path())};
};

TEST_F(RemoteTreeTest, ItsPointsAreThoseOfTheFolder)
{
    const auto here = Tree::open(tree()), there = Tree::open(address());
    EXPECT_EQ(there->folder(), address());
    EXPECT_EQ(there->info().content_hash, here->info().content_hash);
    ColumnSet columns;
    columns.positions = true;
    ASSERT_EQ(there->nodes().size(), here->nodes().size());
    for (NodeId id = 0; id < here->nodes().size(); ++id) {
        const Chunk a = here->read_chunk(id, columns), b = there->read_chunk(id, columns);
        ASSERT_EQ(a.positions->size(), b.positions->size());
        for (std::size_t i = 0; i < a.positions->size(); ++i)
            for (std::size_t axis = 0; axis < 3; ++axis)
                ASSERT_EQ(a.positions->grid(i, axis), b.positions->grid(i, axis));
    }
    const VerifyReport report = verify_tree(address(), 2, {});
    EXPECT_TRUE(report.faults.empty());
    EXPECT_TRUE(report.notes.empty());
}

TEST_F(RemoteTreeTest, AnAddressWithoutATreeSaysSo)
{
    try {
        Tree::open(server_.address("nothing.pct"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::not_found);
        EXPECT_NE(std::string(error.what()).find("index.pct"), std::string::npos) << error.what();
    }
}

// Files are put on a server one by one: all of them are of one tree, or nothing is shown.
TEST_F(RemoteTreeTest, AnIndexBesideTheDataOfAnotherTreeIsRefused)
{
    TreeIndex other = index();
    other.info.content_hash ^= 1;  // as where one value of one point differs
    write_index(other);
    try {
        Tree::open(address());
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::corrupt);
        EXPECT_NE(std::string(error.what()).find("put the tree on the server again"), std::string::npos)
            << error.what();
        EXPECT_EQ(std::string(error.what()).find("pcmlab repair"), std::string::npos) << error.what();
    }
}

TEST_F(RemoteTreeTest, DamageIsSaidAndNotRepairedThere)
{
    const fs::path data = tree() / "chunks-000.bpc";
    std::vector<std::byte> bytes = read_file(data);
    bytes[bytes.size() / 2] ^= std::byte{16};
    write_file(data, bytes);
    const VerifyReport report = verify_tree(address(), 1, {});
    EXPECT_EQ(report.faults.size(), 1u);
    write_file(data, {bytes.begin(), bytes.begin() + 100});
    EXPECT_THROW(Tree::open(address()), Error);
}

TEST_F(RemoteTreeTest, AReplacedTreeIsNoticed)
{
    const auto tree_there = Tree::open(address());
    ColumnSet columns;
    columns.positions = true;
    server_.set_handler(
        [](const HttpRequest& request) { return answer_for(request, std::string(1 << 22, 'x'), "another"); });
    // What was read before is of the old tree, and stays; the rest cannot be read.
    for (NodeId id = 0; id < tree_there->nodes().size(); ++id) {
        try {
            tree_there->read_chunk(id, columns);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("replaced"), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(Tree::open(address()), Error);
}

TEST_F(RemoteTreeTest, NothingIsWrittenThere)
{
    const auto refused = [](const auto& call) {
        try {
            call();
        } catch (const Error& error) {
            return error.code() == ErrorCode::unsupported;
        }
        return false;
    };
    EXPECT_TRUE(refused([&] { TreeUpdate{address()}; }));
    EXPECT_TRUE(refused([&] { repair_tree(address(), {}); }));
    EXPECT_TRUE(refused([&] { output_tree(address()); }));
    EXPECT_TRUE(refused([&] { output_file(server_.address("a.las")); }));
    for (const HttpRequest& request : server_.requests()) EXPECT_EQ(request.method, "GET");
}

TEST_F(RemoteTreeTest, ItIsReadLikeAFile)
{
    CloudSources sources({address()}, {});
    PointBatch batch;
    std::uint64_t points = 0;
    const auto reader = sources.open();
    while (reader->read(batch, 1000)) points += batch.size;
    EXPECT_EQ(points, Tree::open(tree())->info().points);
}

}  // namespace
