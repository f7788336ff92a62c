#include "pcm/build/pipeline.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/levels/morton_sort.h"
#include "pcm/build/levels/sorted_bins.h"
#include "pcm/build/nodes/node_jobs.h"
#include "pcm/system/error.h"
#include "pcm/threads/ordered.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace pcm {
namespace {

constexpr std::uint64_t checkpoint_bytes = std::uint64_t(64) << 20;  // size of chunks that is worth a checkpoint

template <class Coord>
class Pipeline {
public:
    Pipeline(Bins<Coord>& bins, Workspace& work, const Ingested& cloud, const PartOptions& options,
             Checkpoints& checkpoints)
        : bins_(bins),
          work_(work),
          cloud_(cloud),
          sampling_(options.sampling),
          checkpoints_(checkpoints),
          threads_(work.bin_threads(cloud.layout, cloud.observed.points)),
          resumed_(options.resumed)
    {
        nodes_.grid = cloud.grid;
        nodes_.lattice = Lattice(cloud.grid);
        nodes_.schema = cloud.schema;
        nodes_.layout = cloud.layout;
        nodes_.chunk_points = work.chunk_points;
        nodes_.part = options.part;
        nodes_.generation = options.generation;
    }

    Part run(DraftStore& drafts, DataFiles& files, std::optional<GivenLevels<Coord>> given)
    {
        Part part;
        if (cloud_.observed.points > 0) {
            const auto sorted = sort_bins();
            const auto levels = choose_levels(*sorted, std::move(given));
            nodes_.spacings = levels->spacings();
            part.root = build_nodes(*sorted, *levels, drafts, files);
            part.spacings = nodes_.spacings;
        }
        part.resumed = resumed_;
        return part;
    }

private:
    using Stage = Resumed::Stage;

    // Each bin's rows into Morton order.
    std::shared_ptr<SortedBins<Coord>> sort_bins()
    {
        Scratch& scratch = *bins_.scratch;
        std::vector<bool> is_sorted(scratch.bins());
        std::shared_ptr<SortedBins<Coord>> sorted;
        if (resumed_.stage == Stage::nothing) {
            sorted = make_sorted_bins(false);
        } else {
            sorted = find_sorted_bins(is_sorted);
            work_.watch.report("Resuming an interrupted build", 0.4, true);
        }
        std::vector<std::size_t> todo;
        std::uint64_t rows_todo = 0;
        for (std::size_t bin = 0; bin < scratch.bins(); ++bin)
            if (scratch.rows(bin) > 0 && !is_sorted[bin]) {
                todo.push_back(bin);
                rows_todo += scratch.rows(bin);
            }
        // Sorted bins that are in no checkpoint yet: their unsorted rows are still on disk.
        std::vector<std::size_t> pending;
        std::uint64_t rows_pending = 0;
        in_turn(
            todo.size(), threads_, [&](std::size_t i) { return sort_bin(todo[i], *sorted); },
            [&](std::size_t i, std::uint64_t rows) {
                pending.push_back(todo[i]);
                rows_pending += rows;
                if (checkpoints_.on() && !checkpoints_.due() && rows_pending * 16 < rows_todo) return;
                checkpoint_sorted(sorted, std::exchange(pending, {}));
                rows_pending = 0;
            },
            [&](std::size_t done) {
                work_.watch.report(
                    "Sorting points",
                    0.4 + 0.1 * static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(1, todo.size())));
            });
        if (!pending.empty()) checkpoint_sorted(sorted, std::move(pending));
        checkpoints_.post([from = bins_.scratch] { from->clear(); });
        return sorted;
    }

    std::uint64_t sort_bin(std::size_t bin, SortedBins<Coord>& sorted) const
    {
        const std::size_t count = bins_.scratch->rows(bin);
        const std::vector<std::byte> rows = bins_.scratch->read(bin);
        sorted.put(bin, rows, morton_order<Coord>(rows.data(), count, cloud_.layout, nodes_.lattice.finer));
        return count;
    }

    // Gives up the unsorted rows of these bins once the sorted ones are on disk.
    void checkpoint_sorted(const std::shared_ptr<SortedBins<Coord>>& sorted, std::vector<std::size_t> sorted_now)
    {
        ByteWriter record;
        record.put(static_cast<std::uint64_t>(sorted_now.size()));
        for (const std::size_t bin : sorted_now) {
            record.put(static_cast<std::uint64_t>(bin));
            sorted->save(bin, record);
        }
        checkpoints_.post([sorted] { sorted->sync(); }, Checkpoints::sorted, std::move(record.bytes()),
                          [from = bins_.scratch, done = std::move(sorted_now)] {
                              for (const std::size_t bin : done) from->give_back(bin);
                          });
    }

    std::shared_ptr<SortedBins<Coord>> make_sorted_bins(bool reopen) const
    {
        auto sorted =
            std::make_shared<SortedBins<Coord>>(work_.folder, cloud_.layout, cloud_.schema, work_.space, reopen);
        sorted->resize(bins_.scratch->bins());
        return sorted;
    }

    // The bins that an interrupted build had sorted; sets their places in `is_sorted`.
    std::shared_ptr<SortedBins<Coord>> find_sorted_bins(std::vector<bool>& is_sorted)
    {
        try {
            return load_sorted_bins(is_sorted);
        } catch (const Error& error) {
            throw Error(ErrorCode::corrupt, work_.folder / "journal",
                        std::string("the checkpoints of the sorted bins do not match the files: ") + error.what());
        }
    }

    std::shared_ptr<SortedBins<Coord>> load_sorted_bins(std::vector<bool>& is_sorted)
    {
        Scratch& scratch = *bins_.scratch;
        const auto found = checkpoints_.found(Checkpoints::sorted);
        auto sorted = make_sorted_bins(!found.empty());
        std::size_t count = 0;
        for (const std::vector<std::byte>* record : found) {
            ByteReader in(record->data(), record->size(), work_.folder);
            for (auto left = in.get<std::uint64_t>(); left > 0; --left, ++count) {
                const auto bin = in.get<std::uint64_t>();
                if (bin >= scratch.bins() || is_sorted[bin])
                    throw Error(ErrorCode::corrupt, work_.folder,
                                "bin " + std::to_string(bin) + " is sorted twice, or there is no such bin");
                sorted->load(bin, in);
                if (sorted->rows(bin) != scratch.rows(bin))
                    throw Error(ErrorCode::corrupt, work_.folder,
                                "bin " + std::to_string(bin) + " has " + std::to_string(sorted->rows(bin)) +
                                    " sorted rows, " + std::to_string(scratch.rows(bin)) + " were expected");
                is_sorted[bin] = true;
                scratch.give_back(bin);
            }
        }
        for (std::size_t bin = 0; bin < scratch.bins(); ++bin)
            if (!is_sorted[bin] && !scratch.can_hold(bin))
                throw Error(ErrorCode::truncated, work_.folder, "bin " + std::to_string(bin) + " is missing");
        if (count) resumed_ = {Stage::sorted, count, scratch.bins()};
        return sorted;
    }

    std::shared_ptr<LevelSampler<Coord>> choose_levels(const SortedBins<Coord>& sorted,
                                                       std::optional<GivenLevels<Coord>> given)
    {
        if (auto found = find_levels(sorted)) return found;
        auto levels = make_sampler(sorted, File::Mode::create_or_truncate);
        if (given) levels->add_to(std::move(*given));
        levels->run(threads_, [&](double fraction) { work_.watch.report("Choosing levels", 0.5 + 0.2 * fraction); });
        work_.space.take(levels->bytes());
        if (checkpoints_.on()) {
            ByteWriter record;
            levels->save(record);
            checkpoints_.post([levels] { levels->sync(); }, Checkpoints::levelled, std::move(record.bytes()));
        }
        return levels;
    }

    std::shared_ptr<LevelSampler<Coord>> make_sampler(const SortedBins<Coord>& sorted, File::Mode mode) const
    {
        return std::make_shared<LevelSampler<Coord>>(sorted.points(), nodes_.lattice, sampling_,
                                                     work_.folder / "levels.tmp", mode);
    }

    // The levels that an interrupted build had chosen; null when there are none that match the files.
    std::shared_ptr<LevelSampler<Coord>> find_levels(const SortedBins<Coord>& sorted)
    {
        const auto found = checkpoints_.found(Checkpoints::levelled);
        if (found.empty()) return nullptr;
        try {
            auto levels = make_sampler(sorted, File::Mode::change);
            ByteReader in(found[0]->data(), found[0]->size(), work_.folder / "levels.tmp");
            levels->load(in);
            work_.space.take(levels->bytes());
            resumed_ = {Stage::levelled, 0, 0};
            return levels;
        } catch (const Error&) {
            checkpoints_.cut(Checkpoints::levelled);
            return nullptr;
        }
    }

    Draft* build_nodes(const SortedBins<Coord>& sorted, const LevelSampler<Coord>& levels, DraftStore& drafts,
                       DataFiles& files)
    {
        const auto make_jobs = [&] {
            return std::make_unique<NodeJobs<Coord>>(bins_.top, sorted, levels, nodes_, drafts, files);
        };
        auto jobs = make_jobs();
        if (const auto found = checkpoints_.found(Checkpoints::committed); !found.empty()) {
            const DataFiles nothing_written = files;
            try {
                jobs->resume(found);
                resumed_ = {Stage::committed, jobs->restored(), jobs->size()};
            } catch (const Error&) {
                checkpoints_.cut(Checkpoints::committed);
                files = nothing_written;
                jobs = make_jobs();
            }
        }
        checkpoints_.forget_found();
        std::size_t saved = jobs->restored();
        std::uint64_t bytes_saved = 0;
        const auto checkpoint_nodes = [&](std::size_t committed) {
            if (!checkpoints_.on() || !(checkpoints_.due() || files.appended() - bytes_saved >= checkpoint_bytes))
                return;
            ByteWriter record;
            jobs->save(saved, committed, record);
            checkpoints_.post(files.syncer(), Checkpoints::committed, std::move(record.bytes()));
            saved = committed;
            bytes_saved = files.appended();
        };
        return jobs->run(
            threads_,
            [&](std::uint64_t done) {
                work_.watch.report("Building chunks", 0.7 + 0.28 * static_cast<double>(done) /
                                                                static_cast<double>(cloud_.observed.points));
            },
            checkpoint_nodes);
    }

    Bins<Coord>& bins_;
    Workspace& work_;
    const Ingested& cloud_;
    const Sampling sampling_;
    Checkpoints& checkpoints_;
    const unsigned threads_;
    Resumed resumed_;
    NodeBuilderOptions nodes_;
};

}  // namespace

template <class Coord>
Part make_part(Bins<Coord>& bins, Workspace& work, const Ingested& cloud, const PartOptions& options,
               Checkpoints& checkpoints, DraftStore& drafts, DataFiles& files, std::optional<GivenLevels<Coord>> given)
{
    return Pipeline<Coord>(bins, work, cloud, options, checkpoints).run(drafts, files, std::move(given));
}

template Part make_part(Bins<std::uint32_t>&, Workspace&, const Ingested&, const PartOptions&, Checkpoints&,
                        DraftStore&, DataFiles&, std::optional<GivenLevels<std::uint32_t>>);
template Part make_part(Bins<std::uint64_t>&, Workspace&, const Ingested&, const PartOptions&, Checkpoints&,
                        DraftStore&, DataFiles&, std::optional<GivenLevels<std::uint64_t>>);

}  // namespace pcm
