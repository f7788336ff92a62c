// Where the chunks of a file begin, in bounded memory for any number of chunks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

struct ChunkPlace {
    std::uint64_t number = 0;       // chunk number in the file, from 0
    std::uint64_t first_point = 0;  // index of its first point in the file
    std::uint64_t offset = 0;       // file offset of its first byte
};

// Knows every chunk while there are at most `most_places`, then every second, every fourth, and so on.
class ChunkIndex {
public:
    static constexpr std::size_t most_places = std::size_t{1} << 20;  // 100 billion points in chunks of 100,000

    explicit ChunkIndex(std::uint64_t first_offset = 0) { end_.offset = first_offset; }

    void add(std::uint64_t points, std::uint64_t bytes)
    {
        if (end_.number % stride_ == 0) {
            if (places_.size() == most_places) thin_out();
            if (end_.number % stride_ == 0) places_.push_back(end_);
        }
        ++end_.number;
        end_.first_point += points;
        end_.offset += bytes;
    }

    // Bytes after the last chunk that belong to no chunk.
    void skip(std::uint64_t bytes) { end_.offset += bytes; }

    // The place after the last chunk: the number of chunks, their points, and where their bytes end.
    const ChunkPlace& end() const { return end_; }
    bool knows_every_chunk() const { return stride_ == 1; }

    // The last known chunk that begins at or before the point (which must exist).
    const ChunkPlace& before(std::uint64_t point) const
    {
        const auto after =
            std::upper_bound(places_.begin(), places_.end(), point,
                             [](std::uint64_t p, const ChunkPlace& place) { return p < place.first_point; });
        return *(after - 1);
    }
    // The place of a chunk, or of the end; none where it is not known.
    std::optional<ChunkPlace> at(std::uint64_t number) const
    {
        if (number == end_.number) return end_;
        if (number > end_.number || number % stride_ != 0) return std::nullopt;
        return places_[static_cast<std::size_t>(number / stride_)];
    }

private:
    void thin_out()
    {
        for (std::size_t i = 0; 2 * i < places_.size(); ++i) places_[i] = places_[2 * i];
        places_.resize((places_.size() + 1) / 2);
        stride_ *= 2;
    }

    std::vector<ChunkPlace> places_;
    std::uint64_t stride_ = 1;
    ChunkPlace end_;
};

}  // namespace pcm
