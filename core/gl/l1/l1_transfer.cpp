// Converts chunks to bytes in the pages of L1.
#include "pcm/gl/l1/l1_cache.h"
#include "pcm/view/point_shapes.h"

#include <GL/glew.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace pcm {
namespace {

// Vertices of `count` points from `first` on. The product is computed in double: a relative grid position may not be
// exact in float, and must be rounded only once.
template <class T>
void write_vertices(std::byte* to, const std::array<PageVector<T>, 3>& xyz, const Vec3d& scale,
                    const VertexFormat& format, const VertexAttributes& attributes, std::size_t first,
                    std::size_t count)
{
    const std::size_t stride = format.stride();
    const std::size_t radius_place = format.radius_place();
    const std::uint8_t* const colours = format.colour == ColourSource::none ? nullptr : attributes.colours;
    for (std::size_t i = 0; i < count; ++i, to += stride) {
        float position[3];
        for (std::size_t a = 0; a < 3; ++a)
            position[a] = static_cast<float>(static_cast<double>(xyz[a][first + i]) * scale[a]);
        // Positions are not negative: the sign is free (shaders/splat.vert).
        if (attributes.selected && attributes.selected[first + i] != 0) position[0] = -position[0];
        std::memcpy(to, position, 12);
        if (colours) std::memcpy(to + VertexFormat::colour_place, colours + 4 * (first + i), 4);
        if (format.radius) {
            float radius = attributes.radii[first + i];
            if (format.shape) radius = with_shape(radius, attributes.shapes ? attributes.shapes[first + i] : 0);
            std::memcpy(to + radius_place, &radius, 4);
        }
        if (format.normal) std::memcpy(to + VertexFormat::normal_place, attributes.normals + 3 * (first + i), 12);
    }
}

// Points of a column per page.
std::size_t points_per_column_page(std::uint32_t stride) { return L1Cache::page_bytes / stride / 256 * 256; }

}  // namespace

std::uint64_t L1Cache::pages_of(std::uint32_t stride, std::uint64_t points)
{
    const std::uint64_t per_page = points_per_column_page(stride);
    return (points + per_page - 1) / per_page;
}

void L1Cache::transfer(VertexEntry& entry, const std::vector<std::uint32_t>& pages, const ChunkPositions& positions,
                       const Vec3d& scale, const VertexAttributes& attributes)
{
    const std::size_t stride = entry.stride();
    const std::size_t per_page = points_per_page(entry.format);
    staging_.assign(page_bytes, std::byte{0});  // gaps between a format's members are 0
    std::size_t first = 0;
    for (const std::uint32_t page : pages) {
        // One page at a time: it is still in the processor's cache when the driver copies it.
        const std::size_t count = std::min(per_page, positions.size() - first);
        positions.wide
            ? write_vertices(staging_.data(), positions.wide_xyz, scale, entry.format, attributes, first, count)
            : write_vertices(staging_.data(), positions.narrow_xyz, scale, entry.format, attributes, first, count);
        const std::uint32_t buffer = buffer_of(page);
        const std::uint32_t place = page % pages_per_block_;
        glBindBuffer(GL_COPY_WRITE_BUFFER, buffer);
        glBufferSubData(GL_COPY_WRITE_BUFFER, GLintptr(place) * page_bytes, static_cast<GLsizeiptr>(count * stride),
                        staging_.data());
        first += count;

        const auto vertex = static_cast<std::int32_t>(place * per_page);
        auto& ranges = entry.ranges;
        if (!ranges.empty() && ranges.back().buffer == buffer && ranges.back().first + ranges.back().count == vertex)
            ranges.back().count += static_cast<std::int32_t>(count);
        else
            ranges.push_back({buffer, vertex, static_cast<std::int32_t>(count)});
    }
    statistics_.uploaded_bytes += std::uint64_t(positions.size()) * stride;
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
    std::vector<std::vector<Run>> runs(columns.size());  // of each column, contiguous in a buffer
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
