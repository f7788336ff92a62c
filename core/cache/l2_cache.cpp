#include "pcm/cache/l2_cache.h"

#include "pcm/cache/l2_state.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

namespace pcm {

L2Cache::L2Cache(std::shared_ptr<const Tree> tree, const L2Options& options)
    : L2Cache(std::make_shared<TreeStore>(std::move(tree)), options)
{
}

L2Cache::L2Cache(std::shared_ptr<ChunkStore> store, const L2Options& options) : state_(std::make_shared<State>())
{
    state_->store = std::move(store);
    state_->trees.push_back(state_->store->tree());
    state_->tree = state_->trees.back().get();
    state_->capacity = options.capacity_bytes;
    start_loaders(std::max(1u, options.threads));
}

// Where the system gives fewer threads, the cache works with those; without any, request() would never be served.
void L2Cache::start_loaders(unsigned threads)
{
    state_->threads.reserve(threads);
    for (unsigned t = 0; t < threads; ++t) {
        try {
            state_->threads.emplace_back([state = state_.get()] { state->loader(); });
        } catch (const std::system_error& error) {
            if (t > 0) return;
            throw Error(ErrorCode::io, state_->store->tree()->folder(),
                        std::string("no thread can be started to load chunks: ") + error.what());
        } catch (...) {
            end_loaders();
            throw;
        }
    }
}

L2Cache::~L2Cache() { end_loaders(); }

void L2Cache::end_loaders()
{
    {
        const std::lock_guard lock(state_->mutex);
        state_->closing = state_->closed = true;
        state_->wanted.clear();
        state_->soon.clear();
    }
    state_->work.notify_all();
    state_->loaded.notify_all();
    for (std::thread& thread : state_->threads) thread.join();
}

L2Cache::Handle L2Cache::get(NodeId node, const ColumnSet& columns)
{
    std::unique_lock lock(state_->mutex);
    state_->check_open(node);
    Entry& entry = state_->get(node, columns, lock);
    Handle handle;
    handle.chunk_ = entry.chunk;
    handle.state_ = state_;
    handle.entry_ = &entry;
    state_->pin(entry);
    state_->make_room(lock);
    return handle;
}

L2Cache::Handle L2Cache::find(NodeId node, const ColumnSet& columns)
{
    const std::lock_guard lock(state_->mutex);
    const auto found = state_->entries.find(node);
    Handle handle;
    if (state_->closed || found == state_->entries.end() || !found->second.has(columns)) return handle;
    ++state_->statistics.hits;
    handle.chunk_ = found->second.chunk;
    handle.state_ = state_;
    handle.entry_ = &found->second;
    state_->pin(found->second);
    return handle;
}

L2Cache::Handle::Handle(const Handle& other) : chunk_(other.chunk_), state_(other.state_), entry_(other.entry_)
{
    if (!state_) return;
    const std::lock_guard lock(state_->mutex);
    state_->pin(*entry_);
}

L2Cache::Handle::Handle(Handle&& other) noexcept
    : chunk_(std::move(other.chunk_)), state_(std::move(other.state_)), entry_(std::exchange(other.entry_, nullptr))
{
}

L2Cache::Handle& L2Cache::Handle::operator=(Handle other) noexcept
{
    std::swap(chunk_, other.chunk_);
    std::swap(state_, other.state_);
    std::swap(entry_, other.entry_);
    return *this;
}

L2Cache::Handle::~Handle()
{
    if (!state_) return;
    const std::lock_guard lock(state_->mutex);
    state_->unpin(*entry_);
}

std::optional<ChunkPart> L2Cache::read_part(NodeId node, const ColumnSet& columns,
                                            const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted)
{
    {
        const std::lock_guard lock(state_->mutex);
        state_->check_open(node);
        const auto found = state_->entries.find(node);
        if (found != state_->entries.end() && found->second.dirty.any()) return std::nullopt;
    }
    return state_->store->read_part(node, columns, wanted);
}

void L2Cache::request(std::vector<ChunkRequest> list, std::function<void(NodeId)> on_loaded)
{
    const std::size_t nodes = state_->tree.load()->nodes().size();
    std::deque<State::Wanted> wanted;
    for (const ChunkRequest& request : list)
        if (request.node < nodes) wanted.push_back(state_->wanted_of(request));
    {
        const std::lock_guard lock(state_->mutex);
        state_->wanted.clear();
        if (!state_->closed) state_->wanted = std::move(wanted);
        state_->on_loaded = std::make_shared<const std::function<void(NodeId)>>(std::move(on_loaded));
    }
    state_->work.notify_all();
    state_->loaded.notify_all();
}

void L2Cache::prefetch(const ChunkRequest& request)
{
    constexpr std::size_t most = 16;  // older hints are of no use
    {
        const std::lock_guard lock(state_->mutex);
        if (request.node >= state_->tree.load()->nodes().size() || state_->closed) return;
        if (state_->soon.size() == most) state_->soon.pop_front();
        state_->soon.push_back(request);
    }
    state_->work.notify_one();
}

std::optional<std::string> L2Cache::error_of(NodeId node) const
{
    const std::lock_guard lock(state_->mutex);
    const auto found = state_->entries.find(node);
    return found == state_->entries.end() ? std::nullopt : found->second.error;
}

struct L2Cache::Edit::Inner {
    Handle handle;
    NodeId node = no_node;
    std::vector<std::shared_ptr<Column>> changed;  // one per attribute
    std::bitset<max_attributes> asked;
    int exceptions = std::uncaught_exceptions();

    bool any() const
    {
        return std::any_of(changed.begin(), changed.end(), [](const auto& column) { return column != nullptr; });
    }
};

L2Cache::Edit::Edit(std::unique_ptr<Inner> inner) : inner_(std::move(inner)) {}
L2Cache::Edit::Edit(Edit&&) noexcept = default;
L2Cache::Edit& L2Cache::Edit::operator=(Edit&& other) noexcept
{
    std::swap(inner_, other.inner_);
    return *this;
}

L2Cache::Edit::~Edit()
{
    if (!inner_) return;
    State& state = *inner_->handle.state_;
    {
        const std::lock_guard lock(state.mutex);
        inner_->handle.entry_->editing = false;
        if (inner_->any() && std::uncaught_exceptions() <= inner_->exceptions && !state.unmarked)
            state.unmarked = inner_->node;
    }
    state.loaded.notify_all();
}

const Chunk& L2Cache::Edit::chunk() const { return *inner_->handle; }

Column& L2Cache::Edit::column(std::size_t attribute)
{
    if (attribute >= inner_->changed.size() || !inner_->asked.test(attribute))
        throw Error(ErrorCode::invalid_argument, inner_->handle.state_->store->tree()->folder(),
                    "attribute number " + std::to_string(attribute) +
                        " is not one of the columns that the edit was opened with");
    std::shared_ptr<Column>& column = inner_->changed[attribute];
    if (!column) column = std::make_shared<Column>(*inner_->handle->attributes[attribute]);
    return *column;
}

bool L2Cache::Edit::changed() const { return inner_->any(); }

void L2Cache::Edit::discard()
{
    for (auto& column : inner_->changed) column.reset();
}

void L2Cache::Edit::mark_written()
{
    if (!inner_->any()) return;
    State& state = *inner_->handle.state_;
    for (const auto& column : inner_->changed)
        if (column && column->size() != inner_->handle->points)
            throw Error(ErrorCode::invalid_argument, state.store->tree()->folder(),
                        "a changed column of node " + std::to_string(inner_->node) + " has " +
                            std::to_string(column->size()) + " points, not " + std::to_string(inner_->handle->points));
    std::unique_lock lock(state.mutex);
    state.check_open(inner_->node);
    Entry& entry = *inner_->handle.entry_;
    // Other clients may have loaded more columns meanwhile.
    auto chunk = std::make_shared<Chunk>(*entry.chunk);
    const std::uint64_t dirty_before = entry.dirty_bytes();
    for (std::size_t k = 0; k < inner_->changed.size(); ++k)
        if (inner_->changed[k]) {
            chunk->attributes[k] = std::move(inner_->changed[k]);
            inner_->changed[k].reset();
            entry.dirty.set(k);
        }
    entry.chunk = chunk;
    ++entry.version;
    state.statistics.dirty_bytes += entry.dirty_bytes() - dirty_before;
    inner_->handle.chunk_ = entry.chunk;
    state.make_room(lock);
}

L2Cache::Edit L2Cache::edit(NodeId node, const ColumnSet& columns)
{
    std::unique_lock lock(state_->mutex);
    state_->check_open(node);
    if (!state_->store->writable())
        throw Error(ErrorCode::invalid_argument, state_->store->tree()->folder(),
                    "this point cloud was opened for reading only", "open it for writing");
    if (state_->write_failure && state_->charged > state_->capacity) state_->write_failure->raise();
    state_->loaded.wait(lock, [&] { return !state_->entry_of(node).editing; });
    state_->check_open(node);
    state_->entry_of(node).editing = true;
    try {
        Entry& entry = state_->get(node, columns, lock);
        auto inner = std::make_unique<Edit::Inner>();
        inner->handle.chunk_ = entry.chunk;
        inner->handle.state_ = state_;
        inner->handle.entry_ = &entry;
        state_->pin(entry);
        inner->node = node;
        inner->asked = columns.attributes;
        inner->changed.resize(entry.chunk->attributes.size());
        state_->make_room(lock);
        return Edit(std::move(inner));
    } catch (...) {
        state_->entry_of(node).editing = false;
        state_->loaded.notify_all();
        throw;
    }
}

void L2Cache::flush()
{
    std::unique_lock lock(state_->mutex);
    if (state_->closed) return;
    if (state_->unmarked) {
        const NodeId node = *state_->unmarked;
        state_->unmarked.reset();
        throw Error(
            ErrorCode::invalid_argument, state_->store->tree()->folder(),
            "points of node " + std::to_string(node) + " were changed and not marked as written; the change is dropped",
            "call mark_written() before the edit ends");
    }
    std::vector<NodeId> dirty;
    for (const auto& [node, entry] : state_->entries)
        if (entry.dirty.any() || entry.writing) dirty.push_back(node);
    std::sort(dirty.begin(), dirty.end());
    for (const NodeId node : dirty) {
        Entry& entry = state_->entry_of(node);
        state_->loaded.wait(lock, [&] { return !entry.writing; });
        if (entry.dirty.none()) continue;
        if (const auto failure = state_->write_back(entry, lock)) failure->raise();
    }
    state_->write_failure.reset();
    lock.unlock();
    state_->store->commit();
}

void L2Cache::close()
{
    flush();
    abandon();
}

void L2Cache::abandon()
{
    {
        const std::lock_guard lock(state_->mutex);
        state_->closed = true;
        state_->wanted.clear();
        state_->soon.clear();
        while (state_->oldest) state_->drop(*state_->oldest);
    }
    state_->loaded.notify_all();
}

void L2Cache::take_schema()
{
    const std::shared_ptr<const Tree> tree = state_->store->tree();
    const std::lock_guard lock(state_->mutex);
    if (tree->info().schema.size() == state_->trees.back()->info().schema.size()) return;
    state_->trees.push_back(tree);
    state_->tree = tree.get();
}

void L2Cache::wait_idle()
{
    std::unique_lock lock(state_->mutex);
    state_->loaded.wait(lock, [&] {
        return state_->wanted.empty() && state_->soon.empty() && !state_->room_wanted && state_->active_loads == 0;
    });
}

void L2Cache::clear()
{
    const std::lock_guard lock(state_->mutex);
    for (Entry* entry = state_->oldest; entry;) {
        Entry* const next = entry->newer;
        if (entry->dirty.none()) state_->drop(*entry);
        entry = next;
    }
}

void L2Cache::set_capacity(std::uint64_t bytes)
{
    std::unique_lock lock(state_->mutex);
    state_->capacity = bytes;
    state_->make_room(lock);
}

std::uint64_t L2Cache::capacity() const
{
    const std::lock_guard lock(state_->mutex);
    return state_->capacity;
}

L2Statistics L2Cache::statistics() const
{
    const std::lock_guard lock(state_->mutex);
    L2Statistics statistics = state_->statistics;
    statistics.resident_bytes = state_->charged;
    return statistics;
}

const Tree& L2Cache::tree() const { return *state_->tree.load(); }

}  // namespace pcm
