// The bookkeeping of L1, without OpenGL: which chunks of which owners lie in which pages of video memory, and which of
// them make room for others.
//
// An owner is one client of the cache (a renderer, a computation); an entry is one node of it. Entries take whole
// pages, wherever they are free. A protected entry is never evicted. An entry is protected while it is pinned, and
// while its owner used it in the latest frame, unless `gl.memory.protected_frames` frames of all owners have begun
// since. An entry that is marked as written holds the only copy of its changes: it is evicted only after it has been
// written back, and stays when that fails.
//
// What to drop is the policy's choice; how entries are found is the container's. One thread.
//
// Invariants: every page below pages() is free or belongs to exactly one entry; the list from newest_ to oldest_ has
// every entry once; an entry whose owner has been removed is pinned or marked as written.
#pragma once

#include "pcm/gl/tuning.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcm {

// lru: evicts the least recently used entries, as many as needed. naive: one sweep over the whole cache evicts every
// unprotected entry, whatever its age.
enum class L1Policy : std::uint8_t { lru, naive };
enum class L1Container : std::uint8_t { hash_map, ordered_map };

// A miss is counted at insert: compulsory when this form of the node was never inserted before, capacity when it had
// been evicted; also forced when a caller waited for it. A hit is a use() that found its entry.
struct L1Counts {
    std::uint64_t hits = 0;
    std::uint64_t compulsory_misses = 0;
    std::uint64_t capacity_misses = 0;
    std::uint64_t forced_misses = 0;
    std::uint64_t evictions = 0;
    std::uint64_t refused = 0;  // inserts for which no room could be made
};

template <class Payload, L1Container container>
class L1Table {
public:
    using Owner = std::uint64_t;
    static constexpr unsigned max_forms = 64;  // bits of seen_

    struct Key {
        Owner owner;
        NodeId node;
        bool operator==(const Key& o) const { return owner == o.owner && node == o.node; }
        bool operator<(const Key& o) const { return owner != o.owner ? owner < o.owner : node < o.node; }
    };
    struct KeyHash {
        std::size_t operator()(const Key& k) const { return std::hash<std::uint64_t>()((k.owner << 32) ^ k.node); }
    };

    class Entry {
    public:
        Payload payload{};
        const Key& key() const { return *key_; }
        const std::vector<std::uint32_t>& pages() const { return pages_; }
        bool written() const { return written_; }
        std::uint32_t pins() const { return pins_; }

    private:
        friend class L1Table;
        const Key* key_ = nullptr;
        std::vector<std::uint32_t> pages_;
        std::uint64_t last_frame_ = 0;
        std::uint32_t pins_ = 0;
        bool written_ = false;
        Entry* newer_ = nullptr;
        Entry* older_ = nullptr;
    };

    explicit L1Table(L1Policy policy) : policy_(policy) {}
    L1Table(const L1Table&) = delete;
    L1Table& operator=(const L1Table&) = delete;

    Owner add_owner()
    {
        latest_frame_[next_owner_] = 0;
        return next_owner_++;
    }
    // Drops the owner's entries; pinned or marked entries are dropped as soon as they are neither.
    void remove_owner(Owner owner)
    {
        latest_frame_.erase(owner);
        for (Entry* entry = newest_; entry;) {
            Entry* const next = entry->older_;
            if (entry->key().owner == owner) drop_if_orphan(*entry);
            entry = next;
        }
        for (auto seen = seen_.begin(); seen != seen_.end();)
            seen = seen->first.owner == owner ? seen_.erase(seen) : std::next(seen);
    }
    bool has_owner(Owner owner) const { return latest_frame_.count(owner) != 0; }
    void begin_frame(Owner owner)
    {
        const auto latest = latest_frame_.find(owner);
        if (latest != latest_frame_.end()) latest->second = ++frame_;
    }
    // One frame that several owners share.
    void begin_frame(const std::vector<Owner>& owners)
    {
        ++frame_;
        for (const Owner owner : owners) {
            const auto latest = latest_frame_.find(owner);
            if (latest != latest_frame_.end()) latest->second = frame_;
        }
    }

    // The entry, or null; valid until it is dropped. use() marks it as used in the owner's latest frame and counts a
    // hit.
    Entry* find(Owner owner, NodeId node)
    {
        const auto found = entries_.find(Key{owner, node});
        return found == entries_.end() ? nullptr : &found->second;
    }
    const Entry* find(Owner owner, NodeId node) const { return const_cast<L1Table*>(this)->find(owner, node); }
    Entry* use(Owner owner, NodeId node)
    {
        Entry* const entry = find(owner, node);
        if (!entry) return nullptr;
        touch(*entry);
        ++counts_.hits;
        return entry;
    }

    // A new entry of `pages` pages for an existing owner. It replaces the node's former entry and counts as used in the
    // owner's latest frame. Null when no room can be made, or the former entry is pinned or cannot be written back;
    // nothing is dropped then. `form` (below max_forms) distinguishes forms of a node when misses are counted. Calls,
    // in this order and as far as needed,
    //   hooks.grow()              for more pages: how many add_pages() has added, 0 when no more are available;
    //   hooks.write_back(Entry&)  for a marked entry to be written back: false when that failed.
    template <class Hooks>
    Entry* insert(Owner owner, NodeId node, std::size_t pages, unsigned form, bool forced, Hooks&& hooks)
    {
        Entry* const former = find(owner, node);
        const bool may_replace = !former || (former->pins_ == 0 && clean(*former, hooks));
        if (!may_replace || !make_room(pages, former, hooks)) {
            ++counts_.refused;
            return nullptr;
        }
        if (former) drop(*former);

        const auto placed = entries_.try_emplace(Key{owner, node}).first;
        Entry& entry = placed->second;
        entry.key_ = &placed->first;
        const auto end = std::next(free_.begin(), static_cast<std::ptrdiff_t>(pages));
        entry.pages_.assign(free_.begin(), end);
        free_.erase(free_.begin(), end);
        link_as_newest(entry);
        touch(entry);

        std::uint64_t& seen = seen_[entry.key()];
        const std::uint64_t bit = std::uint64_t{1} << form;
        ++(seen & bit ? counts_.capacity_misses : counts_.compulsory_misses);
        counts_.forced_misses += forced;
        seen |= bit;
        return &entry;
    }

    void mark_written(Entry& entry) { entry.written_ = true; }
    void pin(Entry& entry) { ++entry.pins_; }
    void unpin(Entry& entry)
    {
        --entry.pins_;
        drop_if_orphan(entry);
    }

    // Writes back every marked entry (of one owner, when given), whatever fails; the number that failed.
    template <class Hooks>
    std::size_t flush(const Owner* owner, Hooks&& hooks)
    {
        std::size_t failed = 0;
        for (Entry* entry = oldest_; entry;) {
            Entry* const next = entry->newer_;
            if (!owner || entry->key().owner == *owner) {
                failed += !clean(*entry, hooks);
                drop_if_orphan(*entry);
            }
            entry = next;
        }
        return failed;
    }

    // Removes the marks of one owner's entries or of all, and calls `discarded` for each.
    template <class Discarded>
    void discard(const Owner* owner, Discarded&& discarded)
    {
        for (Entry* entry = oldest_; entry;) {
            Entry* const next = entry->newer_;
            if (entry->written_ && (!owner || entry->key().owner == *owner)) {
                entry->written_ = false;
                discarded(*entry);
                drop_if_orphan(*entry);
            }
            entry = next;
        }
    }

    // Page numbers pages(), pages() + 1, ... become free ones.
    void add_pages(std::uint32_t count)
    {
        for (std::uint32_t p = 0; p < count; ++p) free_.insert(free_.end(), pages_++);
    }
    // Gives up the pages from `first` on, and drops the entries that lie there, protected or not. False, and nothing is
    // dropped, when one of them is pinned or cannot be written back.
    template <class Hooks>
    bool retire_pages(std::uint32_t first, Hooks&& hooks)
    {
        std::vector<Entry*> leaving;
        for (Entry* entry = newest_; entry; entry = entry->older_)
            for (const std::uint32_t page : entry->pages_)
                if (page >= first) {
                    leaving.push_back(entry);
                    break;
                }
        for (Entry* const entry : leaving)
            if (entry->pins_ > 0) return false;
        for (Entry* const entry : leaving)
            if (!clean(*entry, hooks)) {
                for (Entry* const other : leaving) drop_if_orphan(*other);
                return false;
            }
        for (Entry* const entry : leaving) drop(*entry);
        counts_.evictions += leaving.size();
        free_.erase(free_.lower_bound(first), free_.end());
        pages_ = first < pages_ ? first : pages_;
        return true;
    }
    // Forgets all entries, marked ones too, and all pages.
    void clear()
    {
        entries_.clear();
        free_.clear();
        newest_ = oldest_ = nullptr;
        pages_ = 0;
    }

    // Pages in entries that other owners' latest frames, or pins, protect.
    std::uint64_t pages_protected_by_others(Owner owner) const
    {
        return pages_protected_by_others(std::vector<Owner>{owner});
    }
    std::uint64_t pages_protected_by_others(const std::vector<Owner>& owners) const
    {
        std::uint64_t pages = 0;
        for (const Entry* entry = newest_; entry; entry = entry->older_)
            if (std::find(owners.begin(), owners.end(), entry->key().owner) == owners.end() && is_protected(*entry))
                pages += entry->pages_.size();
        return pages;
    }
    std::uint32_t pages() const { return pages_; }
    std::uint64_t pages_in_use() const { return pages_ - free_.size(); }
    std::size_t size() const { return entries_.size(); }
    std::size_t pinned() const
    {
        std::size_t count = 0;
        for (const Entry* entry = newest_; entry; entry = entry->older_) count += entry->pins_ > 0;
        return count;
    }
    const L1Counts& counts() const { return counts_; }

private:
    using Map = std::conditional_t<container == L1Container::hash_map, std::unordered_map<Key, Entry, KeyHash>,
                                   std::map<Key, Entry>>;

    bool is_protected(const Entry& entry) const
    {
        if (entry.pins_ > 0) return true;
        const auto latest = latest_frame_.find(entry.key().owner);
        return latest != latest_frame_.end() && entry.last_frame_ == latest->second &&
               frame_ - entry.last_frame_ < gl_tuning().memory.protected_frames;
    }

    void link_as_newest(Entry& entry)
    {
        entry.newer_ = nullptr;
        entry.older_ = newest_;
        (newest_ ? newest_->newer_ : oldest_) = &entry;
        newest_ = &entry;
    }
    void unlink(Entry& entry)
    {
        (entry.newer_ ? entry.newer_->older_ : newest_) = entry.older_;
        (entry.older_ ? entry.older_->newer_ : oldest_) = entry.newer_;
    }
    void touch(Entry& entry)
    {
        const auto latest = latest_frame_.find(entry.key().owner);
        entry.last_frame_ = latest == latest_frame_.end() ? 0 : latest->second;
        if (newest_ == &entry) return;
        unlink(entry);
        link_as_newest(entry);
    }

    void drop(Entry& entry)
    {
        unlink(entry);
        free_.insert(entry.pages_.begin(), entry.pages_.end());
        entries_.erase(entries_.find(*entry.key_));
    }
    void drop_if_orphan(Entry& entry)
    {
        if (!entry.written_ && entry.pins_ == 0 && !latest_frame_.count(entry.key().owner)) drop(entry);
    }

    template <class Hooks>
    bool clean(Entry& entry, Hooks& hooks)
    {
        if (entry.written_) entry.written_ = !hooks.write_back(entry);
        return !entry.written_;
    }

    // Frees pages until `pages` are free, counting those of the entry that is about to be replaced (may be null).
    // Victims are chosen and written back first, and dropped only if together they free enough: a refusal evicts
    // nothing.
    template <class Hooks>
    bool make_room(std::size_t pages, const Entry* former, Hooks& hooks)
    {
        const std::size_t own = former ? former->pages_.size() : 0;
        while (free_.size() + own < pages)
            if (hooks.grow() == 0) break;
        std::size_t present = free_.size() + own;
        if (present >= pages) return true;

        std::size_t candidates = 0;
        for (const Entry* entry = oldest_; entry; entry = entry->newer_)
            if (entry != former && !is_protected(*entry)) candidates += entry->pages_.size();
        if (present + candidates < pages) return false;

        std::vector<Entry*> victims;
        for (Entry* entry = oldest_; entry; entry = entry->newer_) {
            if (policy_ == L1Policy::lru && present >= pages) break;
            if (entry == former || is_protected(*entry) || !clean(*entry, hooks)) continue;
            present += entry->pages_.size();
            victims.push_back(entry);
        }
        if (present < pages) {
            for (Entry* const victim : victims) drop_if_orphan(*victim);
            return false;
        }
        for (Entry* const victim : victims) drop(*victim);
        counts_.evictions += victims.size();
        return true;
    }

    L1Policy policy_;
    Map entries_;
    Entry* newest_ = nullptr;
    Entry* oldest_ = nullptr;
    std::set<std::uint32_t> free_;  // ordered, so that an entry gets neighbouring pages where it can
    std::uint32_t pages_ = 0;
    std::unordered_map<Key, std::uint64_t, KeyHash> seen_;  // forms ever inserted, one bit per form
    std::map<Owner, std::uint64_t> latest_frame_;
    std::uint64_t frame_ = 0;
    Owner next_owner_ = 1;
    L1Counts counts_;
};

}  // namespace pcm
