// Sums over nodes: the order in which they are added, and what ends them.
#include "pcm/detect/node_sums.h"

#include "tests/place/shape_cloud.h"

#include <chrono>
#include <functional>
#include <thread>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

class NodeSums : public testing::Test {
protected:
    NodeSums()
    {
        Dice dice(5);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 300000; ++i) points.push_back({{dice.between(0, 9), dice.between(0, 9), 0}, {}});
        tree_ = build_surface_tree(folder_.path(), points);
    }
    std::vector<NodeId> nodes_added(unsigned threads)
    {
        std::vector<NodeId> all;
        sum_over_nodes<std::vector<NodeId>>(
            *tree_, threads, [](std::vector<NodeId>& part, NodeId node) { part.push_back(node); },
            [&](const std::vector<NodeId>& part) { all.insert(all.end(), part.begin(), part.end()); }, [](double) {});
        return all;
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
};

TEST_F(NodeSums, AreAddedInTheOrderOfTheNodes)
{
    std::vector<NodeId> wanted;
    for (NodeId node = 0; node < tree_->nodes().size(); ++node)
        if (tree_->node(node).points > 0) wanted.push_back(node);
    ASSERT_GT(wanted.size(), node_groups / 8);
    for (const unsigned threads : {1u, 2u, 5u}) EXPECT_EQ(nodes_added(threads), wanted) << threads;
}

TEST_F(NodeSums, EndWithWhatIsThrown)
{
    const auto run = [&](const std::function<void()>& see, const std::function<void(double)>& tick) {
        sum_over_nodes<int>(
            *tree_, 2, [&](int&, NodeId) { see(); }, [](const int&) {}, tick);
    };
    const auto slowly = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); };
    EXPECT_THROW(run(slowly, [](double) { throw Error(ErrorCode::cancelled, {}, "cancelled"); }), Error);
    EXPECT_THROW(run([] { throw Error(ErrorCode::io, {}, "unreadable"); }, [](double) {}), Error);
}

}  // namespace
