// How the points of a tree's chunk are divided into segments. The rule is part of the format.
#pragma once

#include "pcm/bpc/chunk_header.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace pcm {

// The largest number of points in a segment. In a chunk of more than 16 million points it is a 4096th of them, rounded
// up to whole blocks of 128.
inline constexpr std::uint32_t most_segment_points = 4096;

// A level is divided into even segments of whole blocks of the codec; the last one has the remaining points.
struct SegmentRule {
    std::uint64_t most;  // points in a segment

    explicit SegmentRule(std::uint32_t chunk_points)
        : most(std::max<std::uint64_t>(most_segment_points,
                                       ((std::uint64_t{chunk_points} + 4095) / 4096 + 127) / 128 * 128))
    {
    }
    std::uint64_t segments(std::uint32_t level_points) const { return (level_points + most - 1) / most; }
    // In each segment of a level but the last.
    std::uint64_t points(std::uint32_t level_points) const
    {
        const std::uint64_t parts = segments(level_points);
        return (level_points + parts * 128 - 1) / (parts * 128) * 128;
    }
};

inline std::uint64_t count_segments(const ChunkIdentity& identity, std::uint32_t chunk_points)
{
    const SegmentRule rule(chunk_points);
    std::uint64_t segments = 0;
    for (const std::uint32_t points : identity.level_points) segments += rule.segments(points);
    return segments;
}

// Without their boxes. The levels' points must add up to chunk_points.
inline std::vector<BpcSegment> segments_of(const ChunkIdentity& identity, std::uint32_t chunk_points)
{
    const SegmentRule rule(chunk_points);
    std::vector<BpcSegment> segments;
    std::uint32_t first = 0;
    for (std::size_t k = 0; k < identity.level_points.size(); ++k) {
        for (std::uint32_t left = identity.level_points[k]; left > 0;) {
            BpcSegment segment;
            segment.first = first;
            segment.count =
                static_cast<std::uint32_t>(std::min<std::uint64_t>(left, rule.points(identity.level_points[k])));
            segment.level = static_cast<std::uint16_t>(identity.first_level + k);
            first += segment.count;
            left -= segment.count;
            segments.push_back(segment);
        }
    }
    return segments;
}

}  // namespace pcm
