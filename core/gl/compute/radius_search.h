// The compute shaders behind gpu_radii.h: radii of a batch of points, which are compared with pieces of chunks in video
// memory one after the other.
//
// GL thread only; every member but the destructor needs the context that was current in the constructor. Changes the
// current program and the bindings of shader storage and copy buffers.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/gl/base/shader_program.h"
#include "pcm/gl/compute/chunk_boxes.h"
#include "pcm/gl/compute/gpu_cursor.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

class RadiusSearch {
public:
    struct Options {
        std::size_t neighbours = 16;  // at least 1
        bool normals = false;         // measure distances from the line along the point's normal
        bool wide = false;            // positions have 64 bits; else the differences of all fit into 31 bits and a sign
        Vec3d scale{1, 1, 1};         // source units per grid step; positive
    };
    // Throws what require_compute_shaders() and ShaderProgram throw.
    explicit RadiusSearch(const Options& options);
    RadiusSearch(const RadiusSearch&) = delete;
    RadiusSearch& operator=(const RadiusSearch&) = delete;
    void release();  // the GL objects

    // Points of a batch, for some 40 MB of video memory at most.
    std::size_t most_points() const { return most_points_; }
    // Points of a piece: a multiple of 256. Software renderers end a shader's loops silently after some iterations.
    std::uint32_t most_piece_points() const { return most_piece_points_; }
    // Starts a batch. Three coordinates per point: grid steps from one origin, of one 32-bit word, or, wide, of two
    // (low word first). With normals: three numbers per point, of length 1 or 0. Throws Error(no_space).
    void begin(const std::vector<std::uint32_t>& positions, const std::vector<double>& normals);

    // At most 64 points of the batch, near each other.
    struct Block {
        std::uint32_t first = 0, count = 0;
        std::uint32_t start = 0;          // box of the piece that is searched first
        std::uint32_t self = not_inside;  // the number of the first point in the piece, modulo 2^32
    };
    static constexpr std::uint32_t not_inside = 0x80000000u;  // larger than any piece
    // Compares points of the batch with the points of a piece whose boxes are given. `shift`: what is to be added to
    // the batch's positions to have them relative to the piece's chunk. Each pair of points must be compared at most
    // once.
    void compare(const GpuPiece& piece, const PieceBoxes& boxes, const Vec3i& shift, const std::vector<Block>& blocks);

    // Of each point, the squared distance of its farthest neighbour so far, source units; infinite while there are
    // fewer than asked for. Exact to 1e-6. Waits for the device. Throws Error(io) when OpenGL has failed.
    std::vector<double> limits();

    // Computes the radii; then they can be copied.
    void finish();
    void copy(std::uint32_t first, std::uint32_t count, const BufferRange& to) const;

    std::uint64_t dispatches() const { return dispatches_; }

private:
    enum class Buffer : std::uint8_t { queries, keys, values, normals, positions, boxes, blocks };  // the bindings
    void store(Buffer buffer, std::size_t bytes, const void* data);
    void bind(Buffer buffer) const;
    std::uint32_t name_of(Buffer buffer) const { return buffers_[static_cast<std::size_t>(buffer)]; }

    Options options_;
    double unit_ = 1;  // the source units of the shaders' lengths
    std::size_t most_points_ = 0;
    std::uint32_t most_piece_points_ = 0;
    std::size_t points_ = 0, stride_ = 0;
    ShaderProgram search_, finish_;
    std::array<std::uint32_t, 7> buffers_{};  // GL names
    std::uint64_t dispatches_ = 0;
};

}  // namespace pcm
