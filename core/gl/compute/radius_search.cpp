#include "pcm/gl/compute/radius_search.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/gl/tuning.h"
#include "pcm/system/error.h"

#include <GL/glew.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t group_points = 64;                   // the shader's workgroup
constexpr std::size_t heap_bytes = std::size_t(16) << 20;  // the size of a shader storage block that every driver has

std::vector<std::string> defines_of(const RadiusSearch::Options& options, bool finish)
{
    std::vector<std::string> defines;
    if (options.wide) defines.emplace_back("WIDE");
    if (options.normals) defines.emplace_back("NORMALS");
    if (finish) defines.emplace_back("FINISH");
    return defines;
}

// Mesa's gallivm, of llvmpipe and softpipe, counts the iterations of all loops of an invocation together, with those
// that run with it, and ends the loops after LP_MAX_TGSI_LOOP_ITERATIONS, 65535. Each point may take an iteration of
// search() and as many of take() as the heap has levels; half is left for the boxes and for loops that are not
// unrolled.
std::uint32_t piece_points(std::size_t neighbours)
{
    if (!gl_is_software()) return std::numeric_limits<std::int32_t>::max() / 256 * 256;
    std::uint32_t levels = 0;
    while (neighbours >> levels) ++levels;
    return 32768 / (1 + levels) / 256 * 256;
}

void require_storage()
{
    require_compute_shaders();
    if (!glClearBufferSubData)
        throw Error(ErrorCode::unsupported, {}, "computing radii needs OpenGL 4.3, or ARB_clear_buffer_object");
}

void check_errors()
{
    const std::string errors = drain_gl_errors();
    if (!errors.empty())
        throw Error(ErrorCode::io, {}, "computing radii in video memory failed: OpenGL error " + errors);
}

}  // namespace

RadiusSearch::RadiusSearch(const Options& options) : options_(options)
{
    require_storage();
    drain_gl_errors();
    const double largest = std::max({options.scale[0], options.scale[1], options.scale[2]});
    unit_ = std::ldexp(1.0, std::ilogb(largest) + 1);
    const std::size_t key_bytes = options.normals ? sizeof(double) : sizeof(float);
    most_points_ =
        std::max<std::size_t>(1, heap_bytes / (options.neighbours * key_bytes) / group_points) * group_points;
    most_piece_points_ = piece_points(options.neighbours);
    search_ = ShaderProgram::compute("radii.comp", defines_of(options, false));
    finish_ = ShaderProgram::compute("radii.comp", defines_of(options, true));
    glGenBuffers(static_cast<GLsizei>(buffers_.size()), buffers_.data());
}

void RadiusSearch::release()
{
    search_.release();
    finish_.release();
    glDeleteBuffers(static_cast<GLsizei>(buffers_.size()), buffers_.data());
    buffers_ = {};
}

// A new store each time: earlier dispatches keep the one that they read.
void RadiusSearch::store(Buffer buffer, std::size_t bytes, const void* data)
{
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_of(buffer));
    glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_DYNAMIC_COPY);
}

void RadiusSearch::bind(Buffer buffer) const
{
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(buffer), name_of(buffer));
}

void RadiusSearch::begin(const std::vector<std::uint32_t>& positions, const std::vector<double>& normals)
{
    points_ = positions.size() / (options_.wide ? 6 : 3);
    stride_ = (points_ + group_points - 1) / group_points * group_points;
    drain_gl_errors();
    store(Buffer::queries, positions.size() * sizeof(std::uint32_t), positions.data());
    const std::size_t entries = stride_ * options_.neighbours;
    if (options_.normals) {
        store(Buffer::normals, normals.size() * sizeof(double), normals.data());
        store(Buffer::values, entries * sizeof(float), nullptr);
        store(Buffer::keys, entries * sizeof(double), nullptr);
        const std::uint32_t infinite[2] = {0, 0x7ff00000u};
        glClearBufferSubData(GL_SHADER_STORAGE_BUFFER, GL_RG32UI, 0, static_cast<GLsizeiptr>(entries * sizeof(double)),
                             GL_RG_INTEGER, GL_UNSIGNED_INT, infinite);
    } else {
        store(Buffer::keys, entries * sizeof(float), nullptr);
        const float infinite = std::numeric_limits<float>::infinity();
        glClearBufferSubData(GL_SHADER_STORAGE_BUFFER, GL_R32F, 0, static_cast<GLsizeiptr>(entries * sizeof(float)),
                             GL_RED, GL_FLOAT, &infinite);
    }
    const std::string errors = drain_gl_errors();
    if (!errors.empty())
        throw Error(
            ErrorCode::no_space, {},
            "no video memory for the neighbours of " + std::to_string(points_) + " points: OpenGL error " + errors,
            "give the L1 less memory");
}

void RadiusSearch::compare(const GpuPiece& piece, const PieceBoxes& piece_boxes, const Vec3i& shift,
                           const std::vector<Block>& block_list)
{
    if (block_list.empty()) return;
    store(Buffer::boxes, piece_boxes.words.size() * sizeof(std::uint32_t), piece_boxes.words.data());
    store(Buffer::blocks, block_list.size() * sizeof(Block), block_list.data());
    for (const Buffer buffer : {Buffer::queries, Buffer::keys, Buffer::boxes, Buffer::blocks}) bind(buffer);
    if (options_.normals)
        for (const Buffer buffer : {Buffer::values, Buffer::normals}) bind(buffer);
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(Buffer::positions), piece.positions.buffer,
                      static_cast<GLintptr>(piece.positions.offset), static_cast<GLsizeiptr>(piece.positions.bytes));
    glUseProgram(search_.id());
    std::array<std::uint32_t, 6> words{};
    for (std::size_t a = 0; a < 3; ++a) {
        const auto steps = static_cast<std::uint64_t>(shift[a]);
        words[options_.wide ? 2 * a : a] = static_cast<std::uint32_t>(steps);
        if (options_.wide) words[2 * a + 1] = static_cast<std::uint32_t>(steps >> 32);
    }
    options_.wide ? glUniform2uiv(search_.uniform("shift"), 3, words.data())
                  : glUniform1uiv(search_.uniform("shift"), 3, words.data());
    const Vec3d scale = options_.scale / unit_;
    glUniform3f(search_.uniform("scale"), static_cast<float>(scale[0]), static_cast<float>(scale[1]),
                static_cast<float>(scale[2]));
    if (options_.normals) glUniform3d(search_.uniform("exact_scale"), scale[0], scale[1], scale[2]);
    glUniform1ui(search_.uniform("neighbours"), static_cast<GLuint>(options_.neighbours));
    glUniform1ui(search_.uniform("stride"), static_cast<GLuint>(stride_));
    glUniform1ui(search_.uniform("groups"), piece_boxes.groups);
    glUniform1ui(search_.uniform("group_size"), piece_boxes.group_blocks);
    const auto most_pairs = std::uint64_t(gl_tuning().radii.dispatch_pairs) << 20;
    const std::size_t most =
        std::clamp<std::size_t>(most_pairs / (std::uint64_t(group_points) * piece.count), 1, 65535);
    for (std::size_t first = 0; first < block_list.size(); first += most) {
        glUniform1ui(search_.uniform("first_block"), static_cast<GLuint>(first));
        glDispatchCompute(static_cast<GLuint>(std::min(most, block_list.size() - first)), 1, 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
        ++dispatches_;
    }
    glFlush();
}

std::vector<double> RadiusSearch::limits()
{
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_of(Buffer::keys));
    std::vector<double> squares(points_);
    if (options_.normals) {
        glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(points_ * sizeof(double)),
                           squares.data());
    } else {
        std::vector<float> tops(points_);
        glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(points_ * sizeof(float)), tops.data());
        std::copy(tops.begin(), tops.end(), squares.begin());
    }
    check_errors();
    for (double& square : squares) square *= unit_ * unit_;
    return squares;
}

void RadiusSearch::finish()
{
    store(Buffer::queries, points_ * sizeof(float), nullptr);  // the positions are not needed any more
    for (const Buffer buffer : {Buffer::queries, Buffer::keys}) bind(buffer);
    if (options_.normals) bind(Buffer::values);
    glUseProgram(finish_.id());
    glUniform1ui(finish_.uniform("neighbours"), static_cast<GLuint>(options_.neighbours));
    glUniform1ui(finish_.uniform("stride"), static_cast<GLuint>(stride_));
    glUniform1f(finish_.uniform("unit"), static_cast<float>(unit_));
    glUniform1ui(finish_.uniform("points"), static_cast<GLuint>(points_));
    glDispatchCompute(static_cast<GLuint>(stride_ / group_points), 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    ++dispatches_;
    check_errors();
}

void RadiusSearch::copy(std::uint32_t first, std::uint32_t count, const BufferRange& to) const
{
    glBindBuffer(GL_COPY_READ_BUFFER, name_of(Buffer::queries));
    glBindBuffer(GL_COPY_WRITE_BUFFER, to.buffer);
    glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(std::uint64_t(first) * 4),
                        static_cast<GLintptr>(to.offset), static_cast<GLsizeiptr>(std::uint64_t(count) * 4));
}

}  // namespace pcm
