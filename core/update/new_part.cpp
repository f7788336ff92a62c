#include "pcm/update/new_part.h"

#include "pcm/build/levels/morton_sort.h"
#include "pcm/build/levels/sorted_bins.h"
#include "pcm/build/nodes/node_jobs.h"
#include "pcm/threads/ordered.h"

#include <utility>

namespace pcm {

template <class Coord>
Draft* make_part(Bins<Coord>& bins, BuildState& state, DraftStore& drafts, DataFiles& files,
                 std::optional<GivenLevels<Coord>> given)
{
    Scratch& scratch = *bins.scratch;
    NodeBuilderOptions& nodes = state.nodes;
    const unsigned threads = state.bin_threads();
    SortedBins<Coord> sorted(state.folder, nodes.layout, nodes.schema, state.space, false);
    sorted.resize(scratch.bins());
    in_turn(
        scratch.bins(), threads,
        [&](std::size_t bin) {
            const std::size_t count = scratch.rows(bin);
            if (count == 0) return 0;
            const std::vector<std::byte> rows = scratch.read(bin);
            sorted.put(bin, rows, morton_order<Coord>(rows.data(), count, nodes.layout, nodes.lattice.finer));
            scratch.give_back(bin);
            return 0;
        },
        [](std::size_t, int) {},
        [&](std::size_t done) {
            state.watch.report("Sorting points",
                               0.4 + 0.1 * static_cast<double>(done) / static_cast<double>(scratch.bins()));
        });
    scratch.clear();

    LevelSampler<Coord> levels(sorted.points(), nodes.lattice, state.options.sampling, state.folder / "levels.tmp");
    if (given) levels.add_to(std::move(*given));
    levels.run(threads, [&](double fraction) { state.watch.report("Choosing levels", 0.5 + 0.2 * fraction); });
    state.space.take(levels.bytes());
    nodes.spacings = levels.spacings();
    nodes.chunk_points = state.options.chunk_points;
    NodeJobs<Coord> jobs(bins.top, sorted, levels, nodes, drafts, files);
    const auto all = static_cast<double>(state.observed.points);
    Checkpoints none;  // an update that is cut off is made anew
    return jobs.run(threads, none, [&](std::uint64_t done) {
        state.watch.report("Building chunks", 0.7 + 0.28 * static_cast<double>(done) / all);
    });
}

template Draft* make_part(Bins<std::uint32_t>&, BuildState&, DraftStore&, DataFiles&,
                          std::optional<GivenLevels<std::uint32_t>>);
template Draft* make_part(Bins<std::uint64_t>&, BuildState&, DraftStore&, DataFiles&,
                          std::optional<GivenLevels<std::uint64_t>>);

}  // namespace pcm
