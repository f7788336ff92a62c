// Copies chunks into the pages of L1.
#include "pcm/gl/l1/l1_cache.h"

#include <GL/glew.h>

#include <algorithm>
#include <utility>

namespace pcm {
namespace {

// Points of a column per page.
std::size_t points_per_column_page(std::uint32_t stride) { return L1Cache::page_bytes / stride / 256 * 256; }

}  // namespace

std::uint64_t L1Cache::pages_of(std::uint32_t stride, std::uint64_t points)
{
    const std::uint64_t per_page = points_per_column_page(stride);
    return (points + per_page - 1) / per_page;
}

void L1Cache::transfer(VertexEntry& entry, const std::vector<std::uint32_t>& pages,
                       const std::vector<std::byte>& vertices)
{
    const std::size_t stride = entry.stride();
    const std::size_t per_page = points_per_page(entry.format);
    std::size_t first = 0;
    for (const std::uint32_t page : pages) {
        const std::size_t count = std::min(per_page, entry.points - first);
        const std::uint32_t buffer = buffer_of(page);
        const std::uint32_t place = page % pages_per_block_;
        glBindBuffer(GL_COPY_WRITE_BUFFER, buffer);
        glBufferSubData(GL_COPY_WRITE_BUFFER, GLintptr(place) * page_bytes, static_cast<GLsizeiptr>(count * stride),
                        vertices.data() + first * stride);
        first += count;

        const auto vertex = static_cast<std::int32_t>(place * per_page);
        auto& ranges = entry.ranges;
        if (!ranges.empty() && ranges.back().buffer == buffer && ranges.back().first + ranges.back().count == vertex)
            ranges.back().count += static_cast<std::int32_t>(count);
        else
            ranges.push_back({buffer, vertex, static_cast<std::int32_t>(count)});
    }
    statistics_.uploaded_bytes += vertices.size();
}

void L1Cache::transfer(ColumnEntry& entry, const std::vector<std::uint32_t>& pages,
                       const std::vector<ColumnSource>& columns)
{
    staging_.resize(page_bytes);
    struct Run {
        std::size_t first, end;  // points
        std::uint32_t buffer;
        std::uint64_t offset;
    };
    std::vector<std::vector<Run>> runs(columns.size());  // for each column, contiguous in a buffer
    std::vector<std::size_t> borders{0, entry.points};
    auto page = pages.begin();
    for (std::size_t k = 0; k < columns.size(); ++k) {
        const std::uint32_t stride = columns[k].stride;
        const std::size_t per_page = points_per_column_page(stride);
        for (std::size_t first = 0; first < entry.points; ++page) {
            const std::size_t end = std::min<std::size_t>(first + per_page, entry.points);
            columns[k].copy(staging_.data(), first, end - first);
            const std::uint32_t buffer = buffer_of(*page);
            const std::uint64_t offset = std::uint64_t(*page % pages_per_block_) * page_bytes;
            glBindBuffer(GL_COPY_WRITE_BUFFER, buffer);
            glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(offset),
                            static_cast<GLsizeiptr>((end - first) * stride), staging_.data());
            Run* const last = runs[k].empty() ? nullptr : &runs[k].back();
            if (last && last->buffer == buffer && last->offset + (last->end - last->first) * stride == offset)
                last->end = end;
            else
                runs[k].push_back({first, end, buffer, offset});
            if (runs[k].back().first == first) borders.push_back(first);
            first = end;
        }
        statistics_.uploaded_bytes += std::uint64_t(entry.points) * stride;
    }
    std::sort(borders.begin(), borders.end());
    borders.erase(std::unique(borders.begin(), borders.end()), borders.end());

    std::vector<std::size_t> at(columns.size(), 0);
    for (std::size_t b = 0; b + 1 < borders.size(); ++b) {
        ColumnPiece piece;
        piece.first = static_cast<std::uint32_t>(borders[b]);
        piece.count = static_cast<std::uint32_t>(borders[b + 1] - borders[b]);
        for (std::size_t k = 0; k < columns.size(); ++k) {
            if (runs[k][at[k]].end <= piece.first) ++at[k];
            const Run& run = runs[k][at[k]];
            const std::uint32_t stride = columns[k].stride;
            piece.columns.push_back(
                {run.buffer, run.offset + (piece.first - run.first) * stride, std::uint64_t(piece.count) * stride});
        }
        entry.pieces.push_back(std::move(piece));
    }
}

}  // namespace pcm
