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
// Chunks come through the cloud's L2 into the L1, and changed columns go back the same way, so memory of either kind
// stays within the caches' capacities. GL thread only: a context of the L1's share group must be current wherever a
// member may upload or read back.
#pragma once

#include "pcm/gl/l1_cache.h"
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
    // For the search of errors: reads every column back when the cursor moves on, and throws when one was changed
    // without mark_written(). Costs more than most computations.
    bool check_marks = false;
};

// Consecutive points of a chunk, each of whose columns lies in one range of one buffer, `bytes` / `count` bytes a
// point. Offsets are multiples of 256, so that every range can be bound as shader storage.
struct GpuPiece {
    std::uint32_t first = 0;  // in the chunk
    std::uint32_t count = 0;
    BufferRange positions;                // empty without positions
    std::vector<BufferRange> attributes;  // of the query's list: raw values, components interleaved
};

// One chunk in video memory, which stays there while a copy of the view lives. May outlive its cursor. Touches OpenGL
// in read() alone.
class GpuView {
public:
    GpuView() = default;
    explicit operator bool() const { return hold_ != nullptr; }
    NodeId node() const { return node_; }
    // Points of the level asked for: the first ones of the chunk.
    std::size_t size() const { return size_; }
    const std::vector<GpuPiece>& pieces() const { return pieces_; }
    // Grid coordinates of what positions are relative to; with the grid, the source coordinates of a point in double:
    // grid().to_source(origin() + relative position in grid steps).
    const Vec3i& origin() const { return origin_; }
    const Grid& grid() const;

    // What was sent to OpenGL before has changed attribute number `attribute` of the query's list: it is written back
    // when the chunk leaves video memory. Sets the memory barrier after which later shaders and reads see it. Throws
    // Error(invalid_argument) for an unknown attribute and for a cloud that was opened for reading alone.
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

// Keeps the cloud and the L1 alive. Chunks that it has uploaded stay in the L1 as long as it lives and there is room,
// so what others change in the cloud meanwhile is not seen where it had been uploaded before.
class GpuCursor {
public:
    // Chunks whose box the query's box and region touch, down to its level, as a whole: points are not tested one by
    // one. Throws Error(invalid_argument) for an unknown attribute or a query with conditions, Error(unsupported) for
    // positions that the cloud does not have or an attribute of more than L1Cache::max_stride bytes. Needs no context.
    GpuCursor(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1, const Query& query,
              const GpuOptions& options = {});
    GpuCursor(GpuCursor&&) noexcept;
    GpuCursor& operator=(GpuCursor&&) noexcept;
    // Needs no context: marks that no flush() has written back stay in the L1, until its own flush(), release() or
    // evictions write them back.
    ~GpuCursor();

    // Moves to the next chunk with points; false at the end, when all that is marked has been handed to L2. Throws what
    // reading throws, what a write-back threw that there was need for, Error(no_space) when the L1 has no room beside
    // what is held, Error(cancelled) when the query's progress function says so. After an error the same chunk is asked
    // for again.
    bool getNextDataGPU(GpuView& view);
    void rewind();  // the next chunk is the first one again

    // Any node of nodes(). The same errors.
    GpuView get(NodeId node);
    // All of nodes() at once, whatever it takes. Throws Error(no_space), before anything is uploaded, when they do not
    // fit.
    std::vector<GpuView> load_all();

    // Hands all that is marked to L2; PointCloud::flush() brings it to the disk. Throws the first error after having
    // tried all.
    void flush();
    // Takes the marks off: what they were for is not written back, and goes with its chunks.
    void discard();

    const std::vector<NodeId>& nodes() const;  // with points, parents first

private:
    friend class GpuView;
    struct State;
    void check_last();
    std::shared_ptr<State> state_;
    std::size_t next_ = 0;
    std::size_t prefetched_ = 0;
    // With check_marks: the node in view and its columns as they were.
    NodeId last_ = no_node;
    std::vector<std::vector<std::byte>> last_columns_;
};

// Throws Error(unsupported) that says what to do when the current context cannot run compute shaders on these buffers:
// OpenGL 4.3, or ARB_compute_shader and ARB_shader_storage_buffer_object.
void require_compute_shaders();

}  // namespace pcm
