// Reads the changed columns of an L1 entry out of video memory.
#pragma once

#include "pcm/gl/base/gl_state.h"
#include "pcm/gl/l1/l1_cache.h"
#include "pcm/system/error.h"

#include <GL/glew.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

class ReadBack final : public ChangedColumns {
public:
    explicit ReadBack(const ColumnEntry& entry) : entry_(entry)
    {
        for (std::size_t k = 0; k < entry.written.size(); ++k)
            if (entry.written[k]) columns_.push_back(k);
    }
    std::uint32_t points() const override { return entry_.points; }
    const std::vector<std::size_t>& columns() const override { return columns_; }
    void read(std::size_t column, std::byte* to) const override
    {
        drain_gl_errors();
        for (const ColumnPiece& piece : entry_.pieces) {
            const BufferRange& range = piece.columns[column];
            glBindBuffer(GL_COPY_WRITE_BUFFER, range.buffer);
            glGetBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(range.offset),
                               static_cast<GLsizeiptr>(range.bytes), to);
            to += range.bytes;
        }
        const std::string errors = drain_gl_errors();
        if (!errors.empty())
            throw Error(ErrorCode::io, {}, "reading changed points out of video memory failed: OpenGL error " + errors,
                        "a context of the share group that made the cache must be current");
    }
    std::uint64_t bytes() const
    {
        std::uint64_t sum = 0;
        for (const std::size_t k : columns_) sum += std::uint64_t(entry_.points) * entry_.strides[k];
        return sum;
    }

private:
    const ColumnEntry& entry_;
    std::vector<std::size_t> columns_;
};

}  // namespace pcm
