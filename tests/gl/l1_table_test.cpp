// The bookkeeping of L1, with either container, against a naive model; no OpenGL.
#include "tests/gl/l1_model.h"

#include <gtest/gtest.h>

#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

using Log = std::vector<std::array<std::uint64_t, 3>>;  // write-backs in order: owner, node, content

// A table with hooks that add blocks, and that write back unless the node is broken.
template <L1Container container>
struct Subject {
    using Table = L1Table<std::uint64_t, container>;
    struct Hooks {
        Subject& s;
        std::uint32_t grow()
        {
            if (s.table.pages() / s.pages_per_block >= s.max_blocks) return 0;
            s.table.add_pages(s.pages_per_block);
            return s.pages_per_block;
        }
        bool write_back(typename Table::Entry& entry)
        {
            s.log.push_back({entry.key().owner, entry.key().node, entry.payload});
            return !s.broken.count(entry.key().node);
        }
    };
    Subject(L1Policy policy, std::uint32_t per_block, std::uint32_t most, const std::set<NodeId>& broken_nodes)
        : table(policy), pages_per_block(per_block), max_blocks(most), broken(broken_nodes)
    {
    }
    bool set_blocks(std::uint32_t most)
    {
        if (table.pages() > most * pages_per_block && !table.retire_pages(most * pages_per_block, Hooks{*this}))
            return false;
        max_blocks = most;
        return true;
    }
    Table table;
    std::uint32_t pages_per_block, max_blocks;
    const std::set<NodeId>& broken;
    Log log;
};

testing::AssertionResult same(const L1Counts& a, const L1Counts& b)
{
    const auto values = [](const L1Counts& c) {
        return std::array<std::uint64_t, 6>{c.hits,          c.compulsory_misses, c.capacity_misses,
                                            c.forced_misses, c.evictions,         c.refused};
    };
    if (values(a) == values(b)) return testing::AssertionSuccess();
    auto result = testing::AssertionFailure() << "counts differ:";
    for (std::size_t i = 0; i < 6; ++i) result << " " << values(a)[i] << "/" << values(b)[i];
    return result;
}

template <class S>
testing::AssertionResult same(S& subject, L1Model& model)
{
    if (subject.table.size() != model.entries.size()) return testing::AssertionFailure() << "other entries";
    if (subject.table.pages() != model.pages()) return testing::AssertionFailure() << "other pages";
    for (const L1Model::Entry& e : model.entries) {
        const auto* const entry = subject.table.find(e.owner, e.node);
        if (!entry) return testing::AssertionFailure() << "node " << e.node << " of " << e.owner << " is gone";
        if (entry->pages() != e.pages || entry->written() != e.written || entry->pins() != e.pins ||
            entry->payload != e.content)
            return testing::AssertionFailure() << "node " << e.node << " of " << e.owner << " differs";
    }
    return testing::AssertionSuccess();
}

class L1TableWith : public testing::TestWithParam<L1Policy> {};
INSTANTIATE_TEST_SUITE_P(Policies, L1TableWith, testing::Values(L1Policy::lru, L1Policy::naive),
                         [](const auto& parameter) { return parameter.param == L1Policy::lru ? "Lru" : "Naive"; });

}  // namespace

TEST_P(L1TableWith, AMillionRandomOperationsAgreeWithANaiveModel)
{
    constexpr std::uint32_t per_block = 17;
    std::mt19937_64 random(29);
    std::set<NodeId> broken;  // their write-backs fail for a while
    Subject<L1Container::hash_map> hashed(GetParam(), per_block, 4, broken);
    Subject<L1Container::ordered_map> ordered(GetParam(), per_block, 4, broken);
    L1Model model;
    Log log;
    model.policy = GetParam();
    model.pages_per_block = per_block;
    model.max_blocks = 4;
    model.write_back = [&](const L1Model::Entry& e) {
        log.push_back({e.owner, e.node, e.content});
        return !broken.count(e.node);
    };
    std::vector<std::uint64_t> owners;
    const auto add_owner = [&] {
        const auto owner = hashed.table.add_owner();
        EXPECT_EQ(ordered.table.add_owner(), owner);
        model.latest[owner] = 0;
        return owner;
    };
    for (int i = 0; i < 3; ++i) owners.push_back(add_owner());
    std::vector<std::pair<std::uint64_t, NodeId>> pins;
    std::uint64_t content = 0, failed_flushes = 0, failed_shrinks = 0;
    const std::vector<std::size_t> sizes{1, 1, 2, 3, 2, 0, 5, 9};

    for (int step = 0; step < 1'000'000; ++step) {
        auto& owner = owners[random() % owners.size()];
        const auto node = static_cast<NodeId>(random() % 40);
        const std::uint64_t action = random() % 1000;
        if (action < (step / 10000 % 2 ? 100u : 8u)) {  // phases of few frames, in which much is protected
            hashed.table.begin_frame(owner);
            ordered.table.begin_frame(owner);
            model.latest[owner] = ++model.frame;
        } else if (action < 600) {
            const bool there = model.use(owner, node);
            ASSERT_EQ(hashed.table.use(owner, node) != nullptr, there) << "step " << step;
            ASSERT_EQ(ordered.table.use(owner, node) != nullptr, there) << "step " << step;
        } else if (action < 880) {
            const std::size_t pages = random() % 500 == 0 ? 40 : sizes[random() % sizes.size()];
            const unsigned form = std::array{0u, 31u, 32u, 63u}[random() % 4];
            const bool forced = random() % 2;
            const bool done = model.insert(owner, node, pages, form, forced);
            auto* const a = hashed.table.insert(owner, node, pages, form, forced, decltype(hashed)::Hooks{hashed});
            auto* const b = ordered.table.insert(owner, node, pages, form, forced, decltype(ordered)::Hooks{ordered});
            ASSERT_EQ(a != nullptr, done) << "step " << step;
            ASSERT_EQ(b != nullptr, done) << "step " << step;
            if (done) a->payload = b->payload = model.find(owner, node)->content = ++content;
        } else if (action < 930) {
            if (L1Model::Entry* const e = model.find(owner, node)) {
                e->written = true;
                e->content = ++content;
                auto* const a = hashed.table.find(owner, node);
                auto* const b = ordered.table.find(owner, node);
                ASSERT_TRUE(a && b);
                hashed.table.mark_written(*a);
                ordered.table.mark_written(*b);
                a->payload = b->payload = content;
            }
        } else if (action < 960) {
            if (L1Model::Entry* const e = model.find(owner, node); e && pins.size() < 6) {
                ++e->pins;
                hashed.table.pin(*hashed.table.find(owner, node));
                ordered.table.pin(*ordered.table.find(owner, node));
                pins.push_back({owner, node});
            }
        } else if (action < 980) {
            if (!pins.empty()) {
                std::swap(pins[random() % pins.size()], pins.back());
                const auto [o, n] = pins.back();
                pins.pop_back();
                --model.find(o, n)->pins;
                model.forget_orphans();
                hashed.table.unpin(*hashed.table.find(o, n));
                ordered.table.unpin(*ordered.table.find(o, n));
            }
        } else if (action < 987) {
            if (!broken.erase(node) && broken.size() < 12) broken.insert(node);
        } else if (action < 992) {
            const std::uint64_t* const of = random() % 2 ? &owner : nullptr;
            const std::size_t failed = model.flush(of);
            ASSERT_EQ(hashed.table.flush(of, decltype(hashed)::Hooks{hashed}), failed) << "step " << step;
            ASSERT_EQ(ordered.table.flush(of, decltype(ordered)::Hooks{ordered}), failed) << "step " << step;
            failed_flushes += failed > 0;
        } else if (action < 996) {
            const auto most = static_cast<std::uint32_t>(2 + random() % 4);
            const bool done = model.set_blocks(most);
            ASSERT_EQ(hashed.set_blocks(most), done) << "step " << step;
            ASSERT_EQ(ordered.set_blocks(most), done) << "step " << step;
            failed_shrinks += !done;
        } else if (action < 997) {
            const std::uint64_t* const of = random() % 2 ? &owner : nullptr;
            model.discard(of);
            hashed.table.discard(of, [](auto&) {});
            ordered.table.discard(of, [](auto&) {});
        } else if (action < 999) {
            model.remove_owner(owner);
            hashed.table.remove_owner(owner);
            ordered.table.remove_owner(owner);
            owner = add_owner();
        } else {
            std::uint64_t others = 0;
            for (const L1Model::Entry& e : model.entries)
                if (e.owner != owner && model.is_protected(e)) others += e.pages.size();
            ASSERT_EQ(hashed.table.pages_protected_by_others(owner), others);
            ASSERT_EQ(ordered.table.pages_protected_by_others(owner), others);
        }
        ASSERT_EQ(hashed.log, log) << "step " << step;
        ASSERT_EQ(ordered.log, log) << "step " << step;
        log.clear();
        hashed.log.clear();
        ordered.log.clear();
        ASSERT_EQ(hashed.table.pages_in_use(), model.pages_in_use()) << "step " << step;
        if (step % 20 == 0) {
            ASSERT_TRUE(same(hashed, model)) << "step " << step;
            ASSERT_TRUE(same(ordered, model)) << "step " << step;
            ASSERT_TRUE(same(hashed.table.counts(), model.counts)) << "step " << step;
            ASSERT_TRUE(same(ordered.table.counts(), model.counts)) << "step " << step;
        }
    }
    // Every case occurred.
    EXPECT_GT(model.counts.evictions, 10000u);
    EXPECT_GT(model.counts.refused, 1000u);
    EXPECT_GT(model.counts.capacity_misses, 10000u);
    EXPECT_GT(failed_flushes, 100u);
    EXPECT_GT(failed_shrinks, 100u);
}

TEST(L1Table, LruEvictsAsMuchAsNeededAndNaiveEverythingUnprotected)
{
    for (const L1Policy policy : {L1Policy::lru, L1Policy::naive}) {
        const std::set<NodeId> none;
        Subject<L1Container::hash_map> s(policy, 10, 1, none);
        const auto owner = s.table.add_owner();
        s.table.begin_frame(owner);
        for (NodeId node = 0; node < 10; ++node)
            ASSERT_TRUE(s.table.insert(owner, node, 1, 0, false, decltype(s)::Hooks{s}));
        EXPECT_FALSE(s.table.insert(owner, 10, 1, 0, false, decltype(s)::Hooks{s}));  // all were used in this frame
        s.table.begin_frame(owner);
        for (NodeId node = 0; node < 3; ++node) s.table.use(owner, node);
        ASSERT_TRUE(s.table.insert(owner, 10, 1, 0, false, decltype(s)::Hooks{s}));
        EXPECT_EQ(s.table.size(), policy == L1Policy::lru ? 10u : 4u);
        EXPECT_FALSE(s.table.find(owner, 3));
        EXPECT_TRUE(s.table.find(owner, 0));
        EXPECT_EQ(s.table.counts().evictions, policy == L1Policy::lru ? 1u : 7u);
    }
}

TEST(L1Table, AnEntryThatCannotBeWrittenBackStaysAndAnotherIsEvicted)
{
    std::set<NodeId> broken{0};
    Subject<L1Container::ordered_map> s(L1Policy::lru, 2, 1, broken);
    const auto owner = s.table.add_owner();
    s.table.begin_frame(owner);
    for (NodeId node = 0; node < 2; ++node) {
        auto* const entry = s.table.insert(owner, node, 1, 0, false, decltype(s)::Hooks{s});
        ASSERT_TRUE(entry);
        s.table.mark_written(*entry);
    }
    s.table.begin_frame(owner);
    ASSERT_TRUE(s.table.insert(owner, 2, 1, 0, false, decltype(s)::Hooks{s}));
    EXPECT_EQ(s.log, (Log{{owner, 0, 0}, {owner, 1, 0}}));
    EXPECT_TRUE(s.table.find(owner, 0) && s.table.find(owner, 0)->written());
    EXPECT_FALSE(s.table.find(owner, 1));
    s.table.begin_frame(owner);
    EXPECT_FALSE(s.table.insert(owner, 3, 2, 0, false, decltype(s)::Hooks{s}));
    EXPECT_TRUE(s.table.find(owner, 2));  // a refusal evicts nothing
    s.table.remove_owner(owner);
    EXPECT_EQ(s.table.size(), 1u);
    EXPECT_EQ(s.table.flush(nullptr, decltype(s)::Hooks{s}), 1u);
    broken.clear();
    EXPECT_EQ(s.table.flush(nullptr, decltype(s)::Hooks{s}), 0u);
    EXPECT_EQ(s.table.size(), 0u);
    EXPECT_EQ(s.table.pages_in_use(), 0u);
}
