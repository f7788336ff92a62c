// The rules of gl/l1/l1_table.h, word for word, by linear search.
#pragma once

#include "pcm/gl/l1/l1_table.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <vector>

namespace pcm::test {

struct L1Model {
    struct Entry {
        std::uint64_t owner = 0;
        NodeId node = 0;
        std::vector<std::uint32_t> pages;
        std::uint64_t frame = 0;
        std::uint64_t used = 0;  // tick
        unsigned pins = 0;
        bool written = false;
        std::uint64_t content = 0;
    };

    L1Policy policy = L1Policy::lru;
    std::uint32_t pages_per_block = 1;
    std::uint32_t blocks = 0, max_blocks = 0;
    std::function<bool(const Entry&)> write_back = [](const Entry&) { return true; };

    std::vector<Entry> entries;
    std::map<std::uint64_t, std::uint64_t> latest;
    std::set<std::pair<std::pair<std::uint64_t, NodeId>, unsigned>> seen;
    std::uint64_t frame = 0, tick = 0;
    L1Counts counts;

    Entry* find(std::uint64_t owner, NodeId node)
    {
        for (Entry& e : entries)
            if (e.owner == owner && e.node == node) return &e;
        return nullptr;
    }
    bool is_protected(const Entry& e) const
    {
        const auto l = latest.find(e.owner);
        return e.pins > 0 || (l != latest.end() && e.frame == l->second && frame - e.frame < 16);
    }
    std::size_t pages_in_use() const
    {
        std::size_t sum = 0;
        for (const Entry& e : entries) sum += e.pages.size();
        return sum;
    }
    std::uint32_t pages() const { return blocks * pages_per_block; }
    std::set<std::uint32_t> free_pages() const
    {
        std::vector<bool> taken(pages());
        for (const Entry& e : entries)
            for (const std::uint32_t p : e.pages) taken[p] = true;
        std::set<std::uint32_t> free;
        for (std::uint32_t p = 0; p < pages(); ++p)
            if (!taken[p]) free.insert(p);
        return free;
    }
    // Numbers of the entries, least recently used first.
    std::vector<std::pair<std::uint64_t, NodeId>> by_age() const
    {
        std::vector<std::pair<std::uint64_t, std::pair<std::uint64_t, NodeId>>> order;
        for (const Entry& e : entries) order.push_back({e.used, {e.owner, e.node}});
        std::sort(order.begin(), order.end());
        std::vector<std::pair<std::uint64_t, NodeId>> keys;
        for (const auto& o : order) keys.push_back(o.second);
        return keys;
    }
    void erase(std::uint64_t owner, NodeId node)
    {
        entries.erase(std::find_if(entries.begin(), entries.end(),
                                   [&](const Entry& e) { return e.owner == owner && e.node == node; }));
    }
    bool clean(Entry& e)
    {
        if (e.written) e.written = !write_back(e);
        return !e.written;
    }
    void forget_orphans()
    {
        entries.erase(
            std::remove_if(entries.begin(), entries.end(),
                           [&](const Entry& e) { return !e.written && e.pins == 0 && !latest.count(e.owner); }),
            entries.end());
    }

    bool use(std::uint64_t owner, NodeId node)
    {
        Entry* const e = find(owner, node);
        if (!e) return false;
        e->frame = latest.count(owner) ? latest[owner] : 0;
        e->used = ++tick;
        ++counts.hits;
        return true;
    }

    bool insert(std::uint64_t owner, NodeId node, std::size_t need, unsigned form, bool forced)
    {
        const auto refuse = [&] {
            ++counts.refused;
            forget_orphans();
            return false;
        };
        Entry* former = find(owner, node);
        if (former && (former->pins > 0 || !clean(*former))) return refuse();
        const auto room = [&] { return pages() - pages_in_use() + (former ? former->pages.size() : 0); };
        while (room() < need && blocks < max_blocks) ++blocks;
        if (room() < need) {
            std::size_t candidates = 0;
            for (const Entry& e : entries)
                if (&e != former && !is_protected(e)) candidates += e.pages.size();
            if (room() + candidates < need) return refuse();
            std::size_t gain = 0;
            std::vector<std::pair<std::uint64_t, NodeId>> victims;
            for (const auto& [o, n] : by_age()) {
                Entry* const e = find(o, n);
                if (policy == L1Policy::lru && room() + gain >= need) break;
                if (e == former || is_protected(*e) || !clean(*e)) continue;
                gain += e->pages.size();
                victims.push_back({o, n});
            }
            if (room() + gain < need) return refuse();
            for (const auto& [o, n] : victims) erase(o, n);
            counts.evictions += victims.size();
        }
        if (find(owner, node)) erase(owner, node);
        Entry e;
        e.owner = owner;
        e.node = node;
        e.frame = latest[owner];
        e.used = ++tick;
        const auto free = free_pages();
        for (auto page = free.begin(); e.pages.size() < need; ++page) e.pages.push_back(*page);
        entries.push_back(std::move(e));
        const bool before = !seen.insert({{owner, node}, form}).second;
        ++(before ? counts.capacity_misses : counts.compulsory_misses);
        counts.forced_misses += forced;
        return true;
    }

    void remove_owner(std::uint64_t owner)
    {
        latest.erase(owner);
        for (auto s = seen.begin(); s != seen.end();) s = s->first.first == owner ? seen.erase(s) : std::next(s);
        forget_orphans();
    }
    std::size_t flush(const std::uint64_t* owner)
    {
        std::size_t failed = 0;
        for (const auto& [o, n] : by_age())
            if (!owner || o == *owner) failed += !clean(*find(o, n));
        forget_orphans();
        return failed;
    }
    void discard(const std::uint64_t* owner)
    {
        for (Entry& e : entries)
            if (!owner || e.owner == *owner) e.written = false;
        forget_orphans();
    }
    bool set_blocks(std::uint32_t most)
    {
        if (blocks > most) {
            const std::uint32_t first = most * pages_per_block;
            std::vector<std::pair<std::uint64_t, NodeId>> leaving = by_age();
            std::reverse(leaving.begin(), leaving.end());
            leaving.erase(std::remove_if(leaving.begin(), leaving.end(),
                                         [&](const auto& key) {
                                             const auto& p = find(key.first, key.second)->pages;
                                             return p.empty() || *std::max_element(p.begin(), p.end()) < first;
                                         }),
                          leaving.end());
            for (const auto& [o, n] : leaving)
                if (find(o, n)->pins > 0) return false;
            for (const auto& [o, n] : leaving)
                if (!clean(*find(o, n))) {
                    forget_orphans();
                    return false;
                }
            for (const auto& [o, n] : leaving) erase(o, n);
            counts.evictions += leaving.size();
            blocks = most;
        }
        max_blocks = most;
        return true;
    }
};

}  // namespace pcm::test
