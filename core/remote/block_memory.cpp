#include "pcm/remote/block_memory.h"

#include <condition_variable>
#include <list>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace pcm {

struct BlockMemory::State {
    using Key = std::pair<const void*, std::uint64_t>;
    struct Entry {
        RemoteBlock block;  // null: a thread is fetching it
        std::list<Key>::iterator use;
        std::thread::id by = std::this_thread::get_id();  // the thread that fetches it
    };

    std::size_t most_blocks;
    std::mutex mutex;
    std::condition_variable changed;
    std::map<Key, Entry> entries;
    std::list<Key> by_use;  // blocks in memory; used last first

    // With the lock: takes what is there and claims what no thread is fetching.
    std::vector<std::uint64_t> take_or_claim(const void* file, std::uint64_t first, std::vector<RemoteBlock>& blocks);
    void keep(const Key& key, RemoteBlock block);
    void give_up(const void* file);
};

BlockMemory::BlockMemory(std::size_t most_blocks) : state_(std::make_unique<State>())
{
    state_->most_blocks = most_blocks;
}

BlockMemory::~BlockMemory() = default;

std::vector<std::uint64_t> BlockMemory::State::take_or_claim(const void* file, std::uint64_t first,
                                                             std::vector<RemoteBlock>& blocks)
{
    std::vector<std::uint64_t> claimed;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        if (blocks[i]) continue;
        const Key key(file, first + i);
        const auto [entry, is_new] = entries.try_emplace(key);
        if (is_new) claimed.push_back(first + i);
        if (!entry->second.block) continue;
        blocks[i] = entry->second.block;
        by_use.splice(by_use.begin(), by_use, entry->second.use);
    }
    return claimed;
}

void BlockMemory::State::keep(const Key& key, RemoteBlock block)
{
    Entry& entry = entries[key];
    entry.block = std::move(block);
    by_use.push_front(key);
    entry.use = by_use.begin();
    if (by_use.size() <= most_blocks) return;
    entries.erase(by_use.back());
    by_use.pop_back();
}

// What this thread has claimed and not fetched.
void BlockMemory::State::give_up(const void* file)
{
    for (auto it = entries.lower_bound({file, 0}); it != entries.end() && it->first.first == file;)
        it = !it->second.block && it->second.by == std::this_thread::get_id() ? entries.erase(it) : std::next(it);
    changed.notify_all();
}

void BlockMemory::claim(const void* file, std::uint64_t first, std::uint64_t end, Numbers& numbers)
{
    const std::lock_guard lock(state_->mutex);
    for (std::uint64_t number = first; number < end; ++number)
        if (state_->entries.try_emplace({file, number}).second) numbers.push_back(number);
}

std::vector<RemoteBlock> BlockMemory::get(const void* file, std::uint64_t first, std::size_t count, const Fetch& fetch)
{
    State& state = *state_;
    std::vector<RemoteBlock> blocks(count);
    std::unique_lock lock(state.mutex);
    for (;;) {
        const std::vector<std::uint64_t> claimed = state.take_or_claim(file, first, blocks);
        if (claimed.empty()) {
            bool whole = true;
            for (const RemoteBlock& block : blocks) whole = whole && block;
            if (whole) return blocks;
            state.changed.wait(lock);
            continue;
        }
        lock.unlock();
        Fetched fetched;
        try {
            fetched = fetch(claimed);
        } catch (...) {
            lock.lock();
            state.give_up(file);
            throw;
        }
        lock.lock();
        for (auto& [number, block] : fetched) {
            if (number >= first && number < first + count) blocks[static_cast<std::size_t>(number - first)] = block;
            state.keep({file, number}, std::move(block));
        }
        state.changed.notify_all();
    }
}

void BlockMemory::forget(const void* file)
{
    State& state = *state_;
    const std::lock_guard lock(state.mutex);
    for (auto it = state.entries.lower_bound({file, 0}); it != state.entries.end() && it->first.first == file;) {
        if (it->second.block) state.by_use.erase(it->second.use);
        it = state.entries.erase(it);
    }
}

}  // namespace pcm
