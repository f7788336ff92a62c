// L1: points as vertices in video memory, between L2 and the renderer.
//
// Memory comes in blocks, a VBO each, that are cut into pages; a chunk takes as many pages as it needs, wherever they
// are free, so a small chunk does not cost a block and no block is ever too fragmented to be used. When no page is
// free, the entries that were drawn longest ago are dropped.
//
// One cache serves all clouds that are drawn in one OpenGL share group. GL thread only: every member but statistics()
// and the constructor wants a context of that group current. No GL object is made before the first upload.
#pragma once

#include "bpc/chunk.h"
#include "cloud/geometry.h"
#include "tree/tree.h"

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <unordered_map>
#include <vector>

namespace pcm {

struct L1Options {
    std::uint64_t capacity_bytes = std::uint64_t(512) << 20;  // hard limit of all blocks together; at least one block
    std::uint32_t block_bytes = std::uint32_t(2) << 20;       // of one VBO; 1 to 4 MiB
};

// A miss is counted at upload: compulsory when these vertices were never uploaded before, capacity when they had been
// and were dropped. A hit is a chunk that was drawn from the cache.
struct L1Statistics {
    std::uint64_t hits = 0;
    std::uint64_t compulsory_misses = 0;
    std::uint64_t capacity_misses = 0;
    std::uint64_t evictions = 0;
    std::uint64_t refused = 0;  // uploads for which no room could be made
    std::uint64_t uploaded_bytes = 0;
    double upload_seconds = 0;         // conversion and transfer, on the GL thread
    std::uint64_t resident_bytes = 0;  // of the pages in use
    std::uint64_t resident_chunks = 0;
    std::uint64_t allocated_bytes = 0;  // of the blocks; never above the capacity
};

// What the colour of a vertex was made from; `none` has no colour and 12 bytes a vertex, the others 16.
enum class VertexColour : std::uint8_t { none, rgb, intensity };

// Vertices in consecutive pages of one block.
struct VertexRange {
    std::uint32_t buffer = 0;  // GL name
    std::int32_t first = 0;    // in vertices of the entry's stride
    std::int32_t count = 0;
};

// Interleaved: float[3] relative to the chunk's origin in source units, then, with a colour, RGBA8.
struct VertexEntry {
    VertexColour colour = VertexColour::none;
    std::uint32_t points = 0;
    Vec3i origin{};  // of the chunk, grid coordinates
    Vec3d extent{};  // of the chunk, source units
    std::vector<VertexRange> ranges;
    std::uint32_t stride() const { return colour == VertexColour::none ? 12u : 16u; }
};

class L1Cache {
public:
    using Owner = std::uint64_t;

    // A page holds 5460 vertices without or 4095 with colour.
    static constexpr std::uint32_t page_bytes = 65520;
    static std::uint32_t points_per_page(VertexColour colour)
    {
        return page_bytes / (colour == VertexColour::none ? 12u : 16u);
    }

    // Throws Error(invalid_argument) for a block size out of range or a capacity below one block.
    explicit L1Cache(const L1Options& options = {});
    ~L1Cache();  // touches no OpenGL: what release() has not freed is left to the context's end
    L1Cache(const L1Cache&) = delete;
    L1Cache& operator=(const L1Cache&) = delete;

    Owner add_owner();
    // Drops the owner's entries; the pages stay for others.
    void remove_owner(Owner owner);

    // A new frame of this owner: what it drew in its last frame may be evicted from now on. What the others drew in
    // their latest frames may not, unless they have drawn nothing for a while (frames_protected frames of all owners).
    void begin_frame(Owner owner);
    static constexpr std::uint64_t frames_protected = 16;

    // The entry if it is resident, whatever its colour; use() also marks it as used in this frame and counts a hit. The
    // pointer is valid until the next upload, remove_owner or release.
    const VertexEntry* use(Owner owner, NodeId node);
    const VertexEntry* find(Owner owner, NodeId node) const;

    // Uploads a chunk, in place of an entry of the same node if there is one, and marks it as used in this frame.
    // `rgba` (4 bytes a point) is read unless `colour` is none. Evicts as needed, least recently used first, never what
    // is protected. False when that does not make room enough (an entry of the same node is kept then), as when the
    // driver is out of memory. Leaves the binding of GL_COPY_WRITE_BUFFER changed.
    bool upload(Owner owner, NodeId node, const ChunkPositions& positions, const Vec3d& scale, VertexColour colour,
                const std::uint8_t* rgba);

    // Pages that the owner can count on: all, less those that others' latest frames protect.
    std::uint64_t pages_available(Owner owner) const;

    // Frees all GL objects; the cache is empty and usable afterwards.
    void release();

    L1Statistics statistics() const;
    const L1Options& options() const { return options_; }

private:
    struct Key {
        Owner owner;
        NodeId node;
        bool operator==(const Key& o) const { return owner == o.owner && node == o.node; }
    };
    struct KeyHash {
        std::size_t operator()(const Key& k) const { return std::hash<std::uint64_t>()((k.owner << 32) ^ k.node); }
    };
    struct Slot {
        Key key{};
        VertexEntry entry;
        std::vector<std::uint32_t> pages;
        std::uint64_t last_frame = 0;
    };
    using Order = std::list<Slot>;  // most recently used first

    bool is_protected(const Slot& slot) const;
    void drop(Order::iterator slot);
    bool make_room(std::size_t pages, Order::iterator replaced);
    bool add_block();
    void transfer(Slot& slot, const ChunkPositions& positions, const Vec3d& scale, const std::uint8_t* rgba);

    L1Options options_;
    std::uint32_t pages_per_block_ = 0;
    std::uint64_t max_blocks_ = 0;
    std::vector<std::uint32_t> blocks_;   // GL names; page p lies in block p / pages_per_block_
    std::set<std::uint32_t> free_pages_;  // ordered, so that a chunk gets neighbouring pages where it can
    Order order_;
    std::unordered_map<Key, Order::iterator, KeyHash> slots_;
    std::unordered_map<Key, std::uint8_t, KeyHash> seen_;  // colours ever uploaded, a bit each
    std::map<Owner, std::uint64_t> latest_frame_;
    std::uint64_t frame_ = 0;
    Owner next_owner_ = 1;
    std::vector<std::byte> staging_;
    L1Statistics statistics_;
};

}  // namespace pcm
