#include "pcm/gl/l1/l1_cache.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/gl/l1/l1_read_back.h"
#include "pcm/system/error.h"
#include "pcm/system/seconds.h"

#include <GL/glew.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <variant>

namespace pcm {

namespace {

using Clock = std::chrono::steady_clock;

std::uint64_t blocks_of(std::uint64_t capacity, std::uint32_t block_bytes)
{
    if (capacity < block_bytes)
        throw Error(ErrorCode::invalid_argument, {},
                    "a video memory cache of " + std::to_string(capacity) + " bytes does not hold one block of " +
                        std::to_string(block_bytes));
    return capacity / block_bytes;
}

}  // namespace

struct L1Cache::Payload {
    VertexEntry vertices;
    std::unique_ptr<ColumnEntry> columns;     // instead of the vertices
    std::shared_ptr<L1WriteBack> write_back;  // while a column is marked
};

// The table with the container that was chosen at run time.
class L1Cache::Table {
public:
    explicit Table(const L1Options& options)
    {
        if (options.container == L1Container::hash_map)
            tables_.emplace<1>(options.policy);
        else
            tables_.emplace<2>(options.policy);
    }
    template <class Use>
    decltype(auto) operator()(Use&& use)
    {
        if (auto* const table = std::get_if<1>(&tables_)) return use(*table);
        return use(*std::get_if<2>(&tables_));
    }

private:
    std::variant<std::monostate, L1Table<Payload, L1Container::hash_map>, L1Table<Payload, L1Container::ordered_map>>
        tables_;
};

struct L1Cache::Hooks {
    L1Cache& cache;
    std::uint32_t grow() { return cache.add_block() ? cache.pages_per_block_ : 0; }
    template <class Entry>
    bool write_back(Entry& entry)
    {
        return cache.write_back(entry.key().node, entry.payload);
    }
};

L1Cache::L1Cache(const L1Options& options) : options_(options)
{
    constexpr std::uint32_t megabyte = 1u << 20;
    if (options.block_bytes < megabyte || options.block_bytes > 4 * megabyte)
        throw Error(ErrorCode::invalid_argument, {},
                    "a block of video memory of " + std::to_string(options.block_bytes) +
                        " bytes; between 1 and 4 MiB were expected");
    pages_per_block_ = options.block_bytes / page_bytes;
    max_blocks_ = blocks_of(options.capacity_bytes, options.block_bytes);
    table_ = std::make_unique<Table>(options);
}

L1Cache::~L1Cache() = default;

L1Cache::Owner L1Cache::add_owner(std::shared_ptr<L1WriteBack> write_back)
{
    const Owner owner = (*table_)([](auto& table) { return table.add_owner(); });
    write_backs_[owner] = std::move(write_back);
    return owner;
}

void L1Cache::remove_owner(Owner owner)
{
    (*table_)([&](auto& table) { table.remove_owner(owner); });
    write_backs_.erase(owner);
}

void L1Cache::begin_frame(Owner owner)
{
    (*table_)([&](auto& table) { table.begin_frame(owner); });
}

void L1Cache::begin_frame(const std::vector<Owner>& owners)
{
    (*table_)([&](auto& table) { table.begin_frame(owners); });
}

const VertexEntry* L1Cache::use(Owner owner, NodeId node)
{
    return (*table_)([&](auto& table) -> const VertexEntry* {
        const auto* const entry = table.use(owner, node);
        return entry ? &entry->payload.vertices : nullptr;
    });
}

const VertexEntry* L1Cache::find(Owner owner, NodeId node) const
{
    return (*table_)([&](auto& table) -> const VertexEntry* {
        const auto* const entry = table.find(owner, node);
        return entry ? &entry->payload.vertices : nullptr;
    });
}

const ColumnEntry* L1Cache::use_columns(Owner owner, NodeId node)
{
    return (*table_)([&](auto& table) -> const ColumnEntry* {
        const auto* const entry = table.use(owner, node);
        return entry ? entry->payload.columns.get() : nullptr;
    });
}

const ColumnEntry* L1Cache::find_columns(Owner owner, NodeId node) const
{
    return (*table_)([&](auto& table) -> const ColumnEntry* {
        const auto* const entry = table.find(owner, node);
        return entry ? entry->payload.columns.get() : nullptr;
    });
}

std::vector<std::byte> L1Cache::read(Owner owner, NodeId node, std::size_t column) const
{
    const ColumnEntry* const entry = find_columns(owner, node);
    if (!entry || column >= entry->strides.size())
        throw Error(
            ErrorCode::invalid_argument, {},
            "column " + std::to_string(column) + " of node " + std::to_string(node) + " is not in video memory");
    std::vector<std::byte> bytes(std::size_t(entry->points) * entry->strides[column]);
    ReadBack(*entry).read(column, bytes.data());
    return bytes;
}

bool L1Cache::add_block()
{
    if (blocks_.size() >= max_blocks_) return false;
    drain_gl_errors();  // the next error is from this call
    GLuint buffer = 0;
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_COPY_WRITE_BUFFER, buffer);
    glBufferData(GL_COPY_WRITE_BUFFER, options_.block_bytes, nullptr, GL_STATIC_DRAW);
    if (glGetError() == GL_OUT_OF_MEMORY) {
        // The driver has less memory than the capacity: no more blocks are made.
        glDeleteBuffers(1, &buffer);
        max_blocks_ = blocks_.size();
        return false;
    }
    blocks_.push_back(buffer);
    (*table_)([&](auto& table) { table.add_pages(pages_per_block_); });
    return true;
}

bool L1Cache::upload(Owner owner, NodeId node, const ChunkVertices& vertices)
{
    const auto start = Clock::now();
    const std::size_t per_page = points_per_page(vertices.format);
    const std::size_t pages = (vertices.points + per_page - 1) / per_page;
    write_back_error_ = nullptr;
    const bool done = (*table_)([&](auto& table) {
        if (!table.has_owner(owner))
            throw Error(ErrorCode::invalid_argument, {}, "no owner " + std::to_string(owner) + " in this L1");
        auto* const slot = table.insert(owner, node, pages, vertices.format.number(), false, Hooks{*this});
        if (!slot) return false;
        VertexEntry& entry = slot->payload.vertices;
        static_cast<VertexFacts&>(entry) = vertices;
        transfer(entry, slot->pages(), vertices.bytes);
        return true;
    });
    if (!done) return false;
    const double seconds = seconds_since(start);
    statistics_.upload_seconds += seconds;
    statistics_.upload_times.add(seconds);
    return true;
}

const ColumnEntry* L1Cache::upload_columns(Owner owner, NodeId node, std::uint32_t points, const Vec3i& origin,
                                           const std::vector<ColumnSource>& columns, bool forced)
{
    const auto start = Clock::now();
    std::size_t pages = 0;
    for (const ColumnSource& column : columns) {
        if (column.stride == 0 || column.stride > max_stride)
            throw Error(ErrorCode::unsupported, {},
                        "a column of " + std::to_string(column.stride) +
                            " bytes per point does not fit into video memory; 1 to " + std::to_string(max_stride) +
                            " were expected");
        pages += pages_of(column.stride, points);
    }
    write_back_error_ = nullptr;
    const ColumnEntry* const done = (*table_)([&](auto& table) -> const ColumnEntry* {
        if (!table.has_owner(owner))
            throw Error(ErrorCode::invalid_argument, {}, "no owner " + std::to_string(owner) + " in this L1");
        auto* const slot = table.insert(owner, node, pages, 0, forced, Hooks{*this});
        if (!slot) return nullptr;
        slot->payload.columns = std::make_unique<ColumnEntry>();
        ColumnEntry& entry = *slot->payload.columns;
        entry.points = points;
        entry.origin = origin;
        for (const ColumnSource& column : columns) entry.strides.push_back(column.stride);
        entry.written.resize(columns.size());
        transfer(entry, slot->pages(), columns);
        return &entry;
    });
    if (!done) return nullptr;
    const double seconds = seconds_since(start);
    statistics_.upload_seconds += seconds;
    statistics_.upload_times.add(seconds);
    return done;
}

Served L1Cache::request(const std::vector<NodeId>& nodes, std::optional<double> milliseconds,
                        const std::function<Supply(NodeId)>& supply, const std::function<bool(NodeId)>& upload)
{
    const auto start = Clock::now();
    Served served;
    for (const NodeId node : nodes) {
        const Supply state = supply(node);
        if (state == Supply::stop) break;
        if (state == Supply::absent) continue;
        served.out_of_time = milliseconds && served.uploaded > 0 && seconds_since(start) * 1e3 >= *milliseconds;
        if (served.out_of_time) break;
        served.refused = !upload(node);
        if (served.refused) break;
        ++served.uploaded;
    }
    return served;
}

void L1Cache::pin(Owner owner, NodeId node)
{
    (*table_)([&](auto& table) {
        if (auto* const entry = table.find(owner, node)) table.pin(*entry);
    });
}

void L1Cache::unpin(Owner owner, NodeId node)
{
    (*table_)([&](auto& table) {
        if (auto* const entry = table.find(owner, node)) table.unpin(*entry);
    });
}

void L1Cache::mark_written(Owner owner, NodeId node, std::size_t column)
{
    const auto write_back = write_backs_.find(owner);
    (*table_)([&](auto& table) {
        auto* const entry = table.find(owner, node);
        ColumnEntry* const columns = entry ? entry->payload.columns.get() : nullptr;
        if (!columns || column >= columns->written.size() || write_back == write_backs_.end() || !write_back->second)
            throw Error(ErrorCode::invalid_argument, {},
                        "column " + std::to_string(column) + " of node " + std::to_string(node) +
                            " cannot be marked as written: " +
                            (!columns ? "it is not in video memory"
                             : column >= columns->written.size()
                                 ? "there are " + std::to_string(columns->written.size()) + " columns"
                                 : "its owner has no write-back"));
        columns->written[column] = true;
        entry->payload.write_back = write_back->second;
        table.mark_written(*entry);
    });
}

bool L1Cache::write_back(NodeId node, Payload& payload)
{
    const auto start = Clock::now();
    const ReadBack changed(*payload.columns);
    try {
        // After this, glGetBufferSubData reads what shaders have written.
        if (glMemoryBarrier) glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        payload.write_back->write(node, changed);
    } catch (...) {
        if (!write_back_error_) write_back_error_ = std::current_exception();
        ++statistics_.failed_write_backs;
        return false;
    }
    payload.columns->written.assign(payload.columns->written.size(), false);
    payload.write_back = nullptr;
    const double seconds = seconds_since(start);
    ++statistics_.written_back_chunks;
    statistics_.written_back_bytes += changed.bytes();
    statistics_.write_back_seconds += seconds;
    statistics_.write_back_times.add(seconds);
    return true;
}

void L1Cache::flush_owner(const Owner* owner)
{
    write_back_error_ = nullptr;
    const std::size_t failed = (*table_)([&](auto& table) { return table.flush(owner, Hooks{*this}); });
    if (failed > 0) std::rethrow_exception(write_back_error_);
}

void L1Cache::flush(Owner owner) { flush_owner(&owner); }
void L1Cache::flush() { flush_owner(nullptr); }

void L1Cache::discard_owner(const Owner* owner)
{
    (*table_)([&](auto& table) {
        table.discard(owner, [](auto& entry) {
            ColumnEntry& columns = *entry.payload.columns;
            columns.written.assign(columns.written.size(), false);
            entry.payload.write_back = nullptr;
        });
    });
}

void L1Cache::discard(Owner owner) { discard_owner(&owner); }
void L1Cache::discard() { discard_owner(nullptr); }

std::uint64_t L1Cache::pages_available(Owner owner) const { return pages_available(std::vector<Owner>{owner}); }

std::uint64_t L1Cache::pages_available(const std::vector<Owner>& owners) const
{
    const std::uint64_t others = (*table_)([&](auto& table) { return table.pages_protected_by_others(owners); });
    return max_blocks_ * pages_per_block_ - others;
}

void L1Cache::set_capacity(std::uint64_t bytes)
{
    const std::uint64_t blocks = blocks_of(bytes, options_.block_bytes);
    if (blocks_.size() > blocks) {
        write_back_error_ = nullptr;
        const auto first = static_cast<std::uint32_t>(blocks * pages_per_block_);
        if (!(*table_)([&](auto& table) { return table.retire_pages(first, Hooks{*this}); })) {
            if (write_back_error_) std::rethrow_exception(write_back_error_);
            throw Error(ErrorCode::invalid_argument, {},
                        "the capacity of video memory cannot shrink below chunks that views hold",
                        "release the views first");
        }
        glDeleteBuffers(static_cast<GLsizei>(blocks_.size() - blocks), blocks_.data() + blocks);
        blocks_.resize(blocks);
    }
    options_.capacity_bytes = bytes;
    max_blocks_ = blocks;
}

void L1Cache::release()
{
    const std::size_t pinned = (*table_)([](auto& table) { return table.pinned(); });
    if (pinned > 0)
        throw Error(ErrorCode::invalid_argument, {},
                    "video memory cannot be freed while " + std::to_string(pinned) + " chunks in it are held",
                    "release the views first");
    flush();
    if (!blocks_.empty()) glDeleteBuffers(static_cast<GLsizei>(blocks_.size()), blocks_.data());
    blocks_.clear();
    (*table_)([](auto& table) { table.clear(); });
    max_blocks_ = options_.capacity_bytes / options_.block_bytes;
}

L1Statistics L1Cache::statistics() const
{
    L1Statistics statistics = statistics_;
    (*table_)([&](auto& table) {
        const L1Counts& counts = table.counts();
        statistics.hits = counts.hits;
        statistics.compulsory_misses = counts.compulsory_misses;
        statistics.capacity_misses = counts.capacity_misses;
        statistics.forced_misses = counts.forced_misses;
        statistics.evictions = counts.evictions;
        statistics.refused = counts.refused;
        statistics.resident_bytes = table.pages_in_use() * page_bytes;
        statistics.resident_chunks = table.size();
    });
    statistics.allocated_bytes = std::uint64_t(blocks_.size()) * options_.block_bytes;
    return statistics;
}

}  // namespace pcm
