// Moves rows of points to the bins that they belong to.
#pragma once

#include "pcm/build/bins/scratch.h"
#include "pcm/build/bins/workspace.h"
#include "pcm/threads/crew.h"

#include <atomic>
#include <cstddef>
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

}  // namespace pcm
