// Points of a cloud in buffer objects, chunk after chunk, for compute shaders or any other use of OpenGL:
//
//     pcm::Query query;
//     query.attributes = {"height"};
//     pcm::GpuCursor cursor(cloud, l1, query);
//     pcm::GpuView view;
//     while (cursor.getNextDataGPU(view)) {
//         for (const pcm::GpuPiece& piece : view.pieces()) { bind piece.positions and piece.attributes[0]; dispatch
//         piece.count points } view.mark_written(0);
//     }
//     cloud->flush();
//
// Chunks pass through the cloud's L2 into the L1, and changed columns go back the same way, so memory stays within the
// capacities of both caches. GL thread only: a context of the L1's share group must be current in members that may
// upload or read back.
#pragma once

#include "pcm/gl/l1/l1_cache.h"
#include "pcm/point_cloud.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

// How positions are laid out in a buffer, interleaved and without padding (a vec3 of std430 has some, so shaders read
// an array of scalars). All are relative to the chunk's origin, in grid steps or source units.
enum class GpuPositions : std::uint8_t {
    none,
    f32,  // float[3], source units: the exact position rounded once to single precision
    u32,  // uint[3], grid steps, exact; not for clouds with TreeInfo::wide
    u64,  // uvec2[3], low word first, grid steps, exact
};

struct GpuOptions {
    GpuPositions positions = GpuPositions::f32;
    // For debugging: reads every column back when the cursor advances, and throws when one was changed without
    // mark_written(). Costs more than most computations.
    bool check_marks = false;
};

// Consecutive points of a chunk. Each column of them lies in one range of one buffer, `bytes` / `count` bytes per
// point. Offsets are multiples of 256, so that every range can be bound as shader storage.
struct GpuPiece {
    std::uint32_t first = 0;  // in the chunk
    std::uint32_t count = 0;
    BufferRange positions;                // empty without positions
    std::vector<BufferRange> attributes;  // in the query's order: raw values, components interleaved
};

// One chunk in video memory, which stays there while a copy of the view lives. May outlive its cursor. Only read()
// calls OpenGL.
class GpuView {
public:
    GpuView() = default;
    explicit operator bool() const { return hold_ != nullptr; }
    NodeId node() const { return node_; }
    // Points down to the query's level: the first ones of the chunk.
    std::size_t size() const { return size_; }
    const std::vector<GpuPiece>& pieces() const { return pieces_; }
    // Grid coordinates that positions are relative to. Source coordinates in double: grid().to_source(origin() +
    // relative position in grid steps).
    const Vec3i& origin() const { return origin_; }
    const Grid& grid() const;

    // Marks attribute number `attribute` of the query as changed by earlier OpenGL commands: it is written back before
    // the chunk leaves video memory. Sets the memory barrier after which later shaders and reads see the change. Throws
    // Error(invalid_argument) for an unknown attribute and for a cloud opened read-only.
    void mark_written(std::size_t attribute);

    // Reads an attribute's raw values of the first size() points.
    std::vector<std::byte> read(std::size_t attribute) const;

private:
    friend class GpuCursor;
    struct Hold;
    std::shared_ptr<Hold> hold_;
    NodeId node_ = no_node;
    std::size_t size_ = 0;
    Vec3i origin_{};
    std::vector<GpuPiece> pieces_;
};

// Keeps the cloud and the L1 alive. Its chunks stay in the L1 while it lives and there is room: changes that others
// make to the cloud meanwhile are not seen in chunks that were uploaded before.
class GpuCursor {
public:
    // Visits whole chunks whose boxes intersect the query's box and region, down to its level: single points are not
    // tested. Throws Error(invalid_argument) for an unknown attribute or a query with conditions, Error(unsupported)
    // for a form of positions that the cloud does not fit into or an attribute of more than L1Cache::max_stride bytes.
    // Needs no context.
    GpuCursor(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1, const Query& query,
              const GpuOptions& options = {});
    GpuCursor(GpuCursor&&) noexcept;
    GpuCursor& operator=(GpuCursor&&) noexcept;
    // Needs no context: marked columns that no flush() has written back stay in the L1, until its own flush(),
    // release() or evictions write them back.
    ~GpuCursor();

    // Moves to the next chunk with points; false at the end, when all marked columns have been written back to L2.
    // Throws what reading throws, what a needed write-back throws, Error(no_space) when the L1 has no room beside
    // chunks that views hold, Error(cancelled) when the query's progress function returns false. After an error the
    // next call tries the same chunk again.
    bool getNextDataGPU(GpuView& view);
    void rewind();  // the next chunk is the first one again

    // Any node of nodes(). The same errors.
    GpuView get(NodeId node);
    // All of nodes() at once. Throws Error(no_space), before anything is uploaded, when they do not fit.
    std::vector<GpuView> load_all();

    // Writes all marked columns back to L2; PointCloud::flush() writes them to disk. Throws the first error after
    // having tried all.
    void flush();
    // Removes the marks: the changes are not written back, and are lost with their chunks.
    void discard();

    const std::vector<NodeId>& nodes() const;  // with points, parents first

private:
    friend class GpuView;
    struct State;
    void check_last();
    std::shared_ptr<State> state_;
    std::size_t next_ = 0;
    std::size_t prefetched_ = 0;
    // With check_marks: the node in view and its columns before the view's user had them.
    NodeId last_ = no_node;
    std::vector<std::vector<std::byte>> last_columns_;
};

// Throws Error(unsupported), with a hint, when the current context cannot run compute shaders on these buffers: that
// takes OpenGL 4.3, or ARB_compute_shader and ARB_shader_storage_buffer_object.
void require_compute_shaders();

}  // namespace pcm
