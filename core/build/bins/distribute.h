// Moves rows of points to the bins that they belong to.
#pragma once

#include "pcm/build/bins/row.h"
#include "pcm/build/bins/scratch.h"
#include "pcm/build/bins/top_tree.h"
#include "pcm/build/bins/workspace.h"
#include "pcm/threads/crew.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// Moves rows, read piece by piece, into bins [first, first + bins) of `to`, on all threads. `put(thread, row,
// writer)` adds a row to its bin; `done(piece)` is called when a piece has been moved.
template <class Read, class Done, class Put>
void distribute(Workspace& work, std::size_t pieces, const Read& read, const Done& done, std::size_t row_bytes,
                Scratch& to, std::size_t first, std::size_t bins, const Put& put)
{
    std::atomic<std::size_t> next{0};
    Signal signal;
    Crew crew(signal);
    for (unsigned t = 0; t < work.threads; ++t)
        crew.add([&, t] {
            Scratch::Writer writer(to, first, bins, work.writer_bytes());
            std::vector<std::byte> rows;
            for (std::size_t piece; !signal.stopped && (piece = next++) < pieces;) {
                rows.clear();
                read(piece, rows);
                for (std::size_t at = 0; at < rows.size(); at += row_bytes) put(t, rows.data() + at, writer);
                done(piece);
            }
            if (!signal.stopped) writer.flush();
        });
    crew.join([&] { work.watch.report("Sorting points into bins", 0.3); });
}

// Adds rows to the bins that their positions are in, many at a time.
template <class Coord>
void add_to_bins(const TopTree<Coord>& top, const std::byte* rows, std::size_t count, std::size_t row_bytes,
                 Scratch::Writer& writer)
{
    std::array<std::uint32_t, 512> bin_of;
    for (std::size_t first = 0; first < count; first += bin_of.size()) {
        const std::size_t some = std::min(bin_of.size(), count - first);
        const std::byte* const from = rows + first * row_bytes;
        for (std::size_t i = 0; i < some; ++i)
            bin_of[i] = static_cast<std::uint32_t>(top.bin_of(coordinates_of<Coord>(from + i * row_bytes)));
        writer.add(bin_of.data(), from, some);
    }
}

}  // namespace pcm
