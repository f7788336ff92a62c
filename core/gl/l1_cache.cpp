#include "gl/l1_cache.h"

#include "cloud/error.h"
#include "gl/gl_state.h"

#include <GL/glew.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <string>

namespace pcm {

namespace {

// Vertices of `count` points from `first` on. The product is made in double: a relative grid position may exceed what
// float holds exactly, and must be rounded once only.
template <class T>
void write_vertices(std::byte* to, const std::array<std::vector<T>, 3>& xyz, const Vec3d& scale,
                    const std::uint8_t* rgba, std::size_t first, std::size_t count)
{
    const std::size_t stride = rgba ? 16 : 12;
    for (std::size_t i = 0; i < count; ++i, to += stride) {
        float position[3];
        for (std::size_t a = 0; a < 3; ++a)
            position[a] = static_cast<float>(static_cast<double>(xyz[a][first + i]) * scale[a]);
        std::memcpy(to, position, 12);
        if (rgba) std::memcpy(to + 12, rgba + 4 * (first + i), 4);
    }
}

template <class T>
double largest(const std::vector<T>& values)
{
    T most = 0;
    for (const T value : values) most = std::max(most, value);  // unlike max_element, this is vectorised
    return static_cast<double>(most);
}

}  // namespace

L1Cache::L1Cache(const L1Options& options) : options_(options)
{
    constexpr std::uint32_t megabyte = 1u << 20;
    if (options.block_bytes < megabyte || options.block_bytes > 4 * megabyte)
        throw Error(ErrorCode::invalid_argument, {},
                    "a block of video memory of " + std::to_string(options.block_bytes) +
                        " bytes; between 1 and 4 MiB were expected");
    if (options.capacity_bytes < options.block_bytes)
        throw Error(ErrorCode::invalid_argument, {},
                    "a video memory cache of " + std::to_string(options.capacity_bytes) +
                        " bytes does not hold one block of " + std::to_string(options.block_bytes));
    pages_per_block_ = options.block_bytes / page_bytes;
    max_blocks_ = options.capacity_bytes / options.block_bytes;
}

L1Cache::~L1Cache() = default;

L1Cache::Owner L1Cache::add_owner()
{
    latest_frame_[next_owner_] = 0;
    return next_owner_++;
}

void L1Cache::remove_owner(Owner owner)
{
    for (auto slot = order_.begin(); slot != order_.end();) {
        const auto next = std::next(slot);
        if (slot->key.owner == owner) drop(slot);
        slot = next;
    }
    for (auto seen = seen_.begin(); seen != seen_.end();)
        seen = seen->first.owner == owner ? seen_.erase(seen) : std::next(seen);
    latest_frame_.erase(owner);
}

void L1Cache::begin_frame(Owner owner) { latest_frame_[owner] = ++frame_; }

const VertexEntry* L1Cache::use(Owner owner, NodeId node)
{
    const auto found = slots_.find({owner, node});
    if (found == slots_.end()) return nullptr;
    found->second->last_frame = latest_frame_[owner];
    order_.splice(order_.begin(), order_, found->second);
    ++statistics_.hits;
    return &found->second->entry;
}

const VertexEntry* L1Cache::find(Owner owner, NodeId node) const
{
    const auto found = slots_.find({owner, node});
    return found == slots_.end() ? nullptr : &found->second->entry;
}

bool L1Cache::is_protected(const Slot& slot) const
{
    const auto latest = latest_frame_.find(slot.key.owner);
    return latest != latest_frame_.end() && slot.last_frame == latest->second &&
           frame_ - slot.last_frame < frames_protected;
}

void L1Cache::drop(Order::iterator slot)
{
    free_pages_.insert(slot->pages.begin(), slot->pages.end());
    statistics_.resident_bytes -= std::uint64_t(slot->pages.size()) * page_bytes;
    --statistics_.resident_chunks;
    slots_.erase(slot->key);
    order_.erase(slot);
}

bool L1Cache::add_block()
{
    if (blocks_.size() >= max_blocks_) return false;
    drain_gl_errors();  // so that the next one is this call's
    GLuint buffer = 0;
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_COPY_WRITE_BUFFER, buffer);
    glBufferData(GL_COPY_WRITE_BUFFER, options_.block_bytes, nullptr, GL_STATIC_DRAW);
    if (glGetError() == GL_OUT_OF_MEMORY) {
        // The driver has less than we may use: live with what there is.
        glDeleteBuffers(1, &buffer);
        max_blocks_ = blocks_.size();
        return false;
    }
    const auto first = static_cast<std::uint32_t>(blocks_.size()) * pages_per_block_;
    for (std::uint32_t p = 0; p < pages_per_block_; ++p) free_pages_.insert(free_pages_.end(), first + p);
    blocks_.push_back(buffer);
    statistics_.allocated_bytes += options_.block_bytes;
    return true;
}

// Frees pages until `pages` are free, counting those of the entry that is about to be replaced (end(): none).
bool L1Cache::make_room(std::size_t pages, Order::iterator replaced)
{
    std::size_t present = free_pages_.size() + (replaced == order_.end() ? 0 : replaced->pages.size());
    while (present < pages && add_block()) present += pages_per_block_;
    if (present >= pages) return true;

    // Look before dropping anything: a refusal must not cost others their pages.
    std::size_t evictable = 0;
    for (auto slot = order_.begin(); slot != order_.end(); ++slot)
        if (slot != replaced && !is_protected(*slot)) evictable += slot->pages.size();
    if (present + evictable < pages) return false;
    for (auto slot = order_.end(); present < pages;) {
        --slot;
        if (slot == replaced || is_protected(*slot)) continue;
        const auto victim = slot++;
        present += victim->pages.size();
        drop(victim);
        ++statistics_.evictions;
    }
    return true;
}

void L1Cache::transfer(Slot& slot, const ChunkPositions& positions, const Vec3d& scale, const std::uint8_t* rgba)
{
    const std::size_t stride = slot.entry.stride();
    const std::size_t per_page = points_per_page(slot.entry.colour);
    staging_.resize(page_bytes);
    std::size_t first = 0;
    for (const std::uint32_t page : slot.pages) {
        // One page at a time: what was just written is still in the processor's cache when the driver copies it.
        const std::size_t count = std::min(per_page, positions.size() - first);
        positions.wide ? write_vertices(staging_.data(), positions.wide_xyz, scale, rgba, first, count)
                       : write_vertices(staging_.data(), positions.narrow_xyz, scale, rgba, first, count);
        const std::uint32_t buffer = blocks_[page / pages_per_block_];
        const std::uint32_t place = page % pages_per_block_;
        glBindBuffer(GL_COPY_WRITE_BUFFER, buffer);
        glBufferSubData(GL_COPY_WRITE_BUFFER, GLintptr(place) * page_bytes, static_cast<GLsizeiptr>(count * stride),
                        staging_.data());
        first += count;

        const auto vertex = static_cast<std::int32_t>(place * per_page);
        auto& ranges = slot.entry.ranges;
        if (!ranges.empty() && ranges.back().buffer == buffer && ranges.back().first + ranges.back().count == vertex)
            ranges.back().count += static_cast<std::int32_t>(count);
        else
            ranges.push_back({buffer, vertex, static_cast<std::int32_t>(count)});
    }
    statistics_.uploaded_bytes += std::uint64_t(positions.size()) * stride;
}

bool L1Cache::upload(Owner owner, NodeId node, const ChunkPositions& positions, const Vec3d& scale, VertexColour colour,
                     const std::uint8_t* rgba)
{
    const auto start = std::chrono::steady_clock::now();
    const Key key{owner, node};
    const auto found = slots_.find(key);
    const auto replaced = found == slots_.end() ? order_.end() : found->second;
    const std::size_t per_page = points_per_page(colour);
    const std::size_t pages = (positions.size() + per_page - 1) / per_page;
    if (!make_room(pages, replaced)) {
        ++statistics_.refused;
        return false;
    }
    if (replaced != order_.end()) drop(replaced);

    order_.emplace_front();
    Slot& slot = order_.front();
    slot.key = key;
    slot.last_frame = latest_frame_[owner];
    slot.entry.colour = colour;
    slot.entry.points = static_cast<std::uint32_t>(positions.size());
    slot.entry.origin = positions.origin;
    for (std::size_t a = 0; a < 3; ++a)
        slot.entry.extent[a] =
            scale[a] * (positions.wide ? largest(positions.wide_xyz[a]) : largest(positions.narrow_xyz[a]));
    slot.pages.assign(free_pages_.begin(), std::next(free_pages_.begin(), static_cast<std::ptrdiff_t>(pages)));
    free_pages_.erase(free_pages_.begin(), std::next(free_pages_.begin(), static_cast<std::ptrdiff_t>(pages)));
    slots_[key] = order_.begin();
    transfer(slot, positions, scale, colour == VertexColour::none ? nullptr : rgba);

    std::uint8_t& seen = seen_[key];
    const auto bit = static_cast<std::uint8_t>(1u << static_cast<unsigned>(colour));
    ++(seen & bit ? statistics_.capacity_misses : statistics_.compulsory_misses);
    seen = static_cast<std::uint8_t>(seen | bit);
    statistics_.resident_bytes += std::uint64_t(pages) * page_bytes;
    ++statistics_.resident_chunks;
    statistics_.upload_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return true;
}

std::uint64_t L1Cache::pages_available(Owner owner) const
{
    std::uint64_t pages = max_blocks_ * pages_per_block_;
    for (const Slot& slot : order_)
        if (slot.key.owner != owner && is_protected(slot)) pages -= slot.pages.size();
    return pages;
}

void L1Cache::release()
{
    if (!blocks_.empty()) glDeleteBuffers(static_cast<GLsizei>(blocks_.size()), blocks_.data());
    blocks_.clear();
    free_pages_.clear();
    order_.clear();
    slots_.clear();
    max_blocks_ = options_.capacity_bytes / options_.block_bytes;
    statistics_.resident_bytes = statistics_.resident_chunks = statistics_.allocated_bytes = 0;
}

L1Statistics L1Cache::statistics() const { return statistics_; }

}  // namespace pcm
