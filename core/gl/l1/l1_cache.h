// L1: chunks in video memory, between L2 and the code that draws them or computes on them.
//
// Memory is allocated in blocks, one VBO each, divided into pages. A chunk takes as many pages as it needs, wherever
// they are free: a small chunk does not cost a block, and fragmentation never makes a block unusable. When no page is
// free, the replacement policy chooses entries to evict.
//
// An entry holds a chunk either as vertices to be drawn (upload()) or as columns to compute on (upload_columns()).
// Changed columns are marked as written. Before such an entry is evicted, and on flush() and release(), they are read
// back and given to the owner's L1WriteBack. When that refuses, the entry is not changed.
//
// One cache serves all clouds that are drawn in one OpenGL share group. GL thread only: every member but statistics()
// and the constructor needs a current context of that group, unless it says otherwise. No GL object is made before the
// first upload.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cache/load_times.h"
#include "pcm/cloud/geometry.h"
#include "pcm/gl/l1/chunk_vertices.h"
#include "pcm/gl/l1/l1_table.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

struct L1Options {
    std::uint64_t capacity_bytes = std::uint64_t(512) << 20;  // hard limit of all blocks together; at least one block
    std::uint32_t block_bytes = std::uint32_t(2) << 20;       // size of one VBO; 1 to 4 MiB
    L1Policy policy = L1Policy::lru;
    L1Container container = L1Container::hash_map;
};

// A miss is counted at upload: compulsory when the chunk was never uploaded before, capacity when it had been evicted;
// also forced when a computation had to wait for it. A hit is a use of a resident chunk, to draw it or to compute on
// it.
struct L1Statistics {
    std::uint64_t hits = 0;
    std::uint64_t compulsory_misses = 0;
    std::uint64_t capacity_misses = 0;
    std::uint64_t forced_misses = 0;
    std::uint64_t evictions = 0;
    std::uint64_t refused = 0;  // uploads for which no room could be made
    std::uint64_t uploaded_bytes = 0;
    double upload_seconds = 0;  // on the GL thread
    LoadTimes upload_times;     // times of a chunk's upload
    std::uint64_t written_back_chunks = 0;
    std::uint64_t written_back_bytes = 0;
    std::uint64_t failed_write_backs = 0;
    double write_back_seconds = 0;     // reading out of video memory and passing on
    LoadTimes write_back_times;        // times of a chunk's write-back
    std::uint64_t resident_bytes = 0;  // size of the pages in use
    std::uint64_t resident_chunks = 0;
    std::uint64_t allocated_bytes = 0;  // size of the blocks; never above the capacity
};

// Vertices in consecutive pages of one block.
struct VertexRange {
    std::uint32_t buffer = 0;  // GL name
    std::int32_t first = 0;    // in vertices of the entry's stride
    std::int32_t count = 0;
};

struct VertexEntry : VertexFacts {
    std::vector<VertexRange> ranges;
    std::uint32_t stride() const { return format.stride(); }
};

// Bytes of a buffer object.
struct BufferRange {
    std::uint32_t buffer = 0;  // GL name
    std::uint64_t offset = 0;  // a multiple of 256, as shader storage bindings need
    std::uint64_t bytes = 0;
};

// Consecutive points. Each column of them lies in one range, the column's stride in bytes per point.
struct ColumnPiece {
    std::uint32_t first = 0;  // point; a multiple of 256
    std::uint32_t count = 0;
    std::vector<BufferRange> columns;
};

struct ColumnEntry {
    std::uint32_t points = 0;
    Vec3i origin{};                      // origin of the chunk, grid coordinates
    std::vector<std::uint32_t> strides;  // bytes per point of each column
    std::vector<bool> written;           // columns that are marked
    std::vector<ColumnPiece> pieces;     // all points, in order
};

// One column to upload: `copy` writes the bytes of `count` points from `first` on.
struct ColumnSource {
    std::uint32_t stride = 0;
    std::function<void(std::byte* to, std::size_t first, std::size_t count)> copy;
};

// The columns of one chunk that were changed in video memory.
class ChangedColumns {
public:
    virtual ~ChangedColumns() = default;
    virtual std::uint32_t points() const = 0;
    virtual const std::vector<std::size_t>& columns() const = 0;  // numbers in the entry, ascending
    // Reads one of them: points() * stride bytes. Throws Error(io) when OpenGL fails.
    virtual void read(std::size_t column, std::byte* to) const = 0;
};

// Where an owner's changed columns go. Throws when it cannot store them; they stay in video memory and are offered
// again.
class L1WriteBack {
public:
    virtual ~L1WriteBack() = default;
    virtual void write(NodeId node, const ChangedColumns& changed) = 0;
};

// Whether a client can upload a node that it asked for.
enum class Supply : std::uint8_t {
    ready,
    absent,  // not loaded yet, or not wanted any more: the next one is tried
    stop,    // the request ends here
};
struct Served {
    std::size_t uploaded = 0;
    bool out_of_time = false;  // a node was ready and not uploaded
    bool refused = false;      // a node had no room, which ended the request
};

class L1Cache {
public:
    using Owner = std::uint64_t;

    // 240 * 256: a column whose stride divides 240 fills its pages, with a multiple of 256 points each. A page holds
    // 5120 vertices of positions alone, 3840 with colour, 1920 with all attributes; a block of 1, 2 or 4 MiB has 17
    // pages per MiB.
    static constexpr std::uint32_t page_bytes = 61440;
    static std::uint32_t points_per_page(const VertexFormat& format) { return page_bytes / format.stride(); }
    static constexpr std::uint32_t max_stride = page_bytes / 256;  // limit for a column

    // Throws Error(invalid_argument) for a block size out of range or a capacity below one block.
    explicit L1Cache(const L1Options& options = {});
    // Makes no OpenGL call: objects that release() has not freed live until the context ends. Marked columns that
    // neither flush() nor release() has written back are lost.
    ~L1Cache();
    L1Cache(const L1Cache&) = delete;
    L1Cache& operator=(const L1Cache&) = delete;

    // `write_back` may be null for an owner that never marks a column. Needs no context.
    Owner add_owner(std::shared_ptr<L1WriteBack> write_back = nullptr);
    // Drops the owner's entries and frees their pages. Marked entries, and the write-back, stay until they have been
    // written back; pinned ones until they are unpinned. Needs no context.
    void remove_owner(Owner owner);

    // Begins a frame of this owner: entries that it used in its last frame may be evicted from now on. Entries that
    // other owners used in their latest frames may not, unless these have drawn nothing for
    // gl.memory.protected_frames frames of all owners.
    void begin_frame(Owner owner);
    void begin_frame(const std::vector<Owner>& owners);  // one frame that these share

    // The entry if it is resident, whatever its format; use() also marks it as used in this frame and counts a hit. The
    // pointer is valid until the next upload, remove_owner, set_capacity or release.
    const VertexEntry* use(Owner owner, NodeId node);
    const VertexEntry* find(Owner owner, NodeId node) const;
    const ColumnEntry* use_columns(Owner owner, NodeId node);
    const ColumnEntry* find_columns(Owner owner, NodeId node) const;

    // Uploads a chunk, which takes copying its bytes alone, replaces an entry of the same node, and marks it as used in
    // this frame. Evicts by the policy, never a protected entry. False when that does not free enough, when the driver
    // is out of memory, or when write-backs failed (see write_back_error()); an entry of the same node is kept then.
    // Changes the binding of GL_COPY_WRITE_BUFFER. Throws Error(invalid_argument) for an unknown owner.
    bool upload(Owner owner, NodeId node, const ChunkVertices& vertices);

    // The same for columns to compute on; null when there is no room. `forced`: a computation waits for it. Throws
    // Error(unsupported) for a column of more than max_stride bytes per point.
    const ColumnEntry* upload_columns(Owner owner, NodeId node, std::uint32_t points, const Vec3i& origin,
                                      const std::vector<ColumnSource>& columns, bool forced);
    static std::uint64_t pages_of(std::uint32_t stride, std::uint64_t points);  // pages of a column

    // A column as it is in video memory. Throws Error(invalid_argument) when it is not resident, Error(io) when OpenGL
    // fails.
    std::vector<std::byte> read(Owner owner, NodeId node, std::size_t column) const;

    // Uploads within a time limit: one node after the other, as far as `supply` has them ready, until `milliseconds`
    // are spent; at least one is uploaded. Without a limit all are, for computations that need every node down to a
    // level. `upload` uploads a node and returns false when that was refused. Throws what these two throw.
    Served request(const std::vector<NodeId>& nodes, std::optional<double> milliseconds,
                   const std::function<Supply(NodeId)>& supply, const std::function<bool(NodeId)>& upload);
    static constexpr double default_milliseconds = 3;

    // Keeps an entry where it is until it has been unpinned as many times. Needs no context.
    void pin(Owner owner, NodeId node);
    void unpin(Owner owner, NodeId node);

    // Marks a column that earlier OpenGL commands have changed in video memory; the owner has a write-back. Throws
    // Error(invalid_argument) when it is not resident.
    void mark_written(Owner owner, NodeId node, std::size_t column);
    // Writes back all marked columns of one owner, or of all. Throws the first error after having tried all; columns
    // that failed stay marked.
    void flush(Owner owner);
    void flush();
    // Removes the marks of one owner, or of all: the changes are discarded. Needs no context.
    void discard(Owner owner);
    void discard();
    // Why a write-back failed in the latest upload; null if none did.
    std::exception_ptr write_back_error() const { return write_back_error_; }

    // Pages that the owner, or these together, can count on: all pages but those that other owners' latest frames
    // protect.
    std::uint64_t pages_available(Owner owner) const;
    std::uint64_t pages_available(const std::vector<Owner>& owners) const;

    // Takes effect at once: blocks beyond it are freed and their entries evicted, protected or not. Throws
    // Error(invalid_argument) for less than one block or when pinned entries lie there, and what a write-back threw;
    // nothing is changed then.
    void set_capacity(std::uint64_t bytes);

    // Frees all GL objects; the cache is empty and usable afterwards. Throws what flush() throws, and
    // Error(invalid_argument) while entries are pinned; nothing is freed then.
    void release();

    L1Statistics statistics() const;
    const L1Options& options() const { return options_; }

private:
    class Table;
    struct Hooks;
    struct Payload;
    bool add_block();
    std::uint32_t buffer_of(std::uint32_t page) const { return blocks_[page / pages_per_block_]; }
    void transfer(VertexEntry& entry, const std::vector<std::uint32_t>& pages, const std::vector<std::byte>& vertices);
    void transfer(ColumnEntry& entry, const std::vector<std::uint32_t>& pages,
                  const std::vector<ColumnSource>& columns);
    bool write_back(NodeId node, Payload& payload);
    void flush_owner(const Owner* owner);
    void discard_owner(const Owner* owner);

    L1Options options_;
    std::uint32_t pages_per_block_ = 0;
    std::uint64_t max_blocks_ = 0;
    std::vector<std::uint32_t> blocks_;  // GL names; page p lies in block p / pages_per_block_
    std::unique_ptr<Table> table_;
    std::map<Owner, std::shared_ptr<L1WriteBack>> write_backs_;
    std::exception_ptr write_back_error_;
    std::vector<std::byte> staging_;
    L1Statistics statistics_;  // less what the table counts
};

}  // namespace pcm
