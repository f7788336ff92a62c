// Selections of a tree of which not all nodes have been read.
#include "tests/tree/small_tree.h"
#include "tests/view/random_views.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

namespace {

using namespace pcm;
using namespace pcm::test;

using Named = std::pair<std::uint32_t, NodeId>;

std::vector<Named> order_of(const SceneSelection& selection)
{
    std::vector<Named> order;
    for (const auto& [tree, index] : selection.order)
        order.emplace_back(tree, selection.trees[tree].wanted[index].node);
    return order;
}

NodeId ancestor_of(const DetailSelection& selection, const DetailNode& node)
{
    return node.ancestor == no_ancestor ? no_node : selection.wanted[node.ancestor].node;
}

const DetailNode* find(const std::vector<DetailNode>& list, NodeId id)
{
    const auto found = std::find_if(list.begin(), list.end(), [&](const DetailNode& node) { return node.node == id; });
    return found == list.end() ? nullptr : &*found;
}

// Each node of the one, as the other has it.
void expect_part_of(const DetailSelection& part, const DetailSelection& whole)
{
    for (const DetailNode& node : part.wanted) {
        const DetailNode* const same = find(whole.wanted, node.node);
        ASSERT_NE(same, nullptr) << node.node;
        EXPECT_EQ(same->error_px, node.error_px);
        EXPECT_EQ(same->parent, node.parent);
        EXPECT_EQ(ancestor_of(whole, *same), ancestor_of(part, node));
    }
    double before = std::numeric_limits<double>::infinity();
    for (const DetailNode& node : part.unread) {
        EXPECT_LE(node.error_px, before);  // best first
        before = node.error_px;
        for (const std::vector<DetailNode>* list : {&whole.wanted, &whole.beyond})
            if (const DetailNode* const same = find(*list, node.node)) EXPECT_GE(node.error_px, same->error_px);
    }
}

void expect_order(const DetailSelection& selection)
{
    for (std::uint32_t i = 0; i < selection.wanted.size(); ++i)
        if (selection.wanted[i].ancestor != no_ancestor) EXPECT_LT(selection.wanted[i].ancestor, i);
}

class UnreadNodes : public SmallTree {
protected:
    // The tree, with few nodes in a page.
    void build_pages(std::uint32_t nodes_a_page) const
    {
        build(120000, 1000);
        write_in_pages(tree(), nodes_a_page);
    }
    Camera random_camera(std::mt19937_64& random, const Tree& opened) const
    {
        const Box3d box = opened.info().bounds();
        std::uniform_real_distribution<double> unit(-0.3, 1.3);
        Vec3d eye{};
        for (std::size_t a = 0; a < 3; ++a) eye[a] = box.min[a] + unit(random) * box.extent(a);
        eye[2] += 0.2 * box.extent(0);
        return random_view(random, eye, box.min, box.extent(0));
    }
};

TEST_F(UnreadNodes, AViewThatDoesNotWaitBecomesTheOneThatDoes)
{
    std::mt19937_64 random(1);
    build_pages(7);
    const auto whole = Tree::open(tree());
    for ([[maybe_unused]] const Node& node : whole->nodes()) {
    }
    std::size_t lacked = 0, compared = 0;
    for (int round = 0; round < 60; ++round) {
        const Camera view = random_camera(random, *whole);
        DetailLimits limits;
        limits.target_px = round % 3 == 0 ? -1 : 0.5 + static_cast<double>(random() % 40);
        if (round % 4 == 1) limits.order = DetailOrder::depth;
        if (round % 2) limits.kept = [](std::uint32_t, NodeId node) { return node % 3 == 0; };
        const SceneSelection full = select_scene({{&whole->nodes(), &whole->info().grid, view}}, limits);
        const auto opened = Tree::open(tree());
        const NodeTable& nodes = opened->nodes();
        SceneSelection now;
        for (;;) {
            const std::size_t pages = nodes.pages_loaded();
            now = select_scene({{&nodes, &opened->info().grid, view, nullptr, false}}, limits);
            ASSERT_EQ(nodes.pages_loaded(), pages);
            EXPECT_EQ(now.lacks_nodes(), !now.trees[0].unread.empty());
            if (limits.order == DetailOrder::error) expect_part_of(now.trees[0], full.trees[0]);
            expect_order(now.trees[0]);
            const auto all_are_there = [](const DetailNode&) { return true; };
            EXPECT_GE(choose_drawable(now.trees[0], all_are_there).error_px,
                      choose_drawable(full.trees[0], all_are_there).error_px);
            if (now.trees[0].unread.empty()) break;
            ++lacked;
            nodes.at(now.trees[0].unread[random() % now.trees[0].unread.size()].node);
        }
        EXPECT_EQ(order_of(now), order_of(full));
        // Nodes that are not wanted may stay unread, and be outside of the view.
        EXPECT_GE(now.trees[0].beyond.size(), full.trees[0].beyond.size());
        for (const DetailNode& node : full.trees[0].beyond) EXPECT_NE(find(now.trees[0].beyond, node.node), nullptr);
        ++compared;
    }
    EXPECT_EQ(compared, 60u);
    EXPECT_GT(lacked, 100u);
}

TEST_F(UnreadNodes, WhatIsShownAlreadyStaysInFront)
{
    std::mt19937_64 random(2);
    build_pages(5);
    for (int round = 0; round < 30; ++round) {
        const auto opened = Tree::open(tree());
        const NodeTable& nodes = opened->nodes();
        const Camera view = random_camera(random, *opened);
        DetailLimits everything;
        everything.target_px = -1;
        const auto select = [&] {
            return select_scene({{&nodes, &opened->info().grid, view, nullptr, false},
                                 {&nodes, &opened->info().grid, view, nullptr, false}},
                                everything);
        };
        SceneSelection shown = select();
        while (shown.lacks_nodes()) {
            const std::vector<DetailNode>& unread = shown.trees[0].unread;
            nodes.at(unread[random() % unread.size()].node);
            SceneSelection more = select();
            const std::vector<Named> before = order_of(shown), unordered = order_of(more);
            put_first(shown, more);
            const std::vector<Named> after = order_of(more);
            ASSERT_GE(after.size(), before.size());
            EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin()));
            EXPECT_EQ(std::set<Named>(after.begin(), after.end()), std::set<Named>(unordered.begin(), unordered.end()));
            EXPECT_EQ(after.size(), unordered.size());
            // The others keep their order.
            std::vector<Named> rest(after.begin() + static_cast<std::ptrdiff_t>(before.size()), after.end()), expected;
            const std::set<Named> first(before.begin(), before.end());
            for (const Named& node : unordered)
                if (!first.count(node)) expected.push_back(node);
            EXPECT_EQ(rest, expected);
            shown = std::move(more);
        }
    }
}

}  // namespace
