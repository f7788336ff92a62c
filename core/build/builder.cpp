#include "pcm/build/builder.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/bins/partition.h"
#include "pcm/build/build_checkpoint.h"
#include "pcm/build/build_folder.h"
#include "pcm/build/build_state.h"
#include "pcm/build/checkpoints.h"
#include "pcm/build/levels/level_sampler.h"
#include "pcm/build/levels/morton_sort.h"
#include "pcm/build/levels/sorted_bins.h"
#include "pcm/build/nodes/data_files.h"
#include "pcm/build/nodes/draft_index.h"
#include "pcm/build/nodes/node_jobs.h"
#include "pcm/io/pipe/merged_reader.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

namespace pcm {
namespace {

namespace fs = std::filesystem;

class TreeBuild {
public:
    // `identity`: see identity_of_build(); absent for a build that makes no checkpoints. `like`: of the tree whose
    // points these are; null when there is none.
    TreeBuild(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& output,
              const BuildOptions& options, const std::optional<std::vector<std::byte>>& identity, const TreeInfo* like)
        : cloud_(cloud),
          sources_(sources),
          output_(output),
          folder_(output, options.overwrite),
          state_(std::make_unique<BuildState>(options, folder_.work())),
          identity_(identity)
    {
        state().like = like;
    }

    BuildReport run()
    {
        std::optional<AnyBins> bins;
        std::string note;
        if (folder_.left_over()) {
            if (identity_) open_checkpoints();
            note = checkpoints().same_build()
                       ? "an interrupted build was begun afresh: it had no checkpoint that holds"
                       : "what an interrupted build of other files or with other options had left was removed";
            bins = find_bins();
        }
        if (bins) {
            try {
                std::visit([&](auto& of) { make_nodes(of); }, *bins);
                note = "went on with an interrupted build: " + went_on_;
            } catch (const Unfit&) {
                bins.reset();
            } catch (const Error& error) {
                // What was left does not hold what the journal says: found late, but there is nothing to lose.
                const bool damaged = error.code() == ErrorCode::corrupt || error.code() == ErrorCode::truncated;
                if (!damaged || error.path().parent_path() != state().folder) throw;
                bins.reset();
            }
            if (!bins) note = "an interrupted build was begun afresh: what it had left was damaged";
        }
        if (!bins) {
            if (folder_.left_over()) begin_afresh();
            if (identity_) open_checkpoints();
            bins = partition(cloud_, state());
            // Now they are complete: readers find out on the way what they drop.
            const FileInfo& info = cloud_.info();
            state().notes.insert(state().notes.begin(), info.notes.begin(), info.notes.end());
            state().metadata = info.metadata;
            checkpoint_bins(*bins);
            std::visit([&](auto& of) { make_nodes(of); }, *bins);
        }
        checkpoints().wait();
        folder_.publish();
        report_.scratch_bytes = state().space.peak();
        report_.notes = state().notes;
        if (!note.empty()) report_.notes.push_back(note);
        report_.outcome.seconds = state().watch.seconds();
        return report_;
    }

private:
    struct Unfit {};  // a checkpoint does not go together with what is on disk

    BuildState& state() { return *state_; }
    Checkpoints& checkpoints() { return *checkpoints_; }
    void open_checkpoints()
    {
        checkpoints_ =
            std::make_unique<Checkpoints>(state().folder / "journal", *identity_, state().options.checkpoint_seconds);
    }
    void begin_afresh()
    {
        checkpoints_ = std::make_unique<Checkpoints>();
        folder_.clear();
        went_on_.clear();
        const TreeInfo* like = state().like;
        state_ = std::make_unique<BuildState>(state().options, state().folder);
        state().like = like;
    }

    // The bins of an interrupted build, if this is the same one and they are there.
    std::optional<AnyBins> find_bins()
    {
        const auto found = checkpoints().found(Checkpoints::partitioned);
        if (found.empty()) return std::nullopt;
        try {
            ByteReader in(found[0]->data(), found[0]->size(), state().folder);
            AnyBins bins = load_bins(state(), cloud_.info().schema, in);
            went_on_ = "its points had been read";
            return bins;
        } catch (const Error&) {
            return std::nullopt;
        }
    }

    // Builds that are quickly begun again make no checkpoints.
    void checkpoint_bins(const AnyBins& bins)
    {
        if (!checkpoints().on()) return;
        if (state().observed.points == 0 || state().watch.seconds() < checkpoints().seconds())
            return checkpoints().off();
        ByteWriter record;
        save_bins(state(), bins, record);
        std::shared_ptr<Scratch> scratch = std::visit([](const auto& of) { return of.scratch; }, bins);
        checkpoints().post([scratch] { scratch->sync(); }, Checkpoints::partitioned, std::move(record.bytes()));
    }

    // Sort each bin, choose the points' levels, make the nodes.
    template <class Coord>
    void make_nodes(Bins<Coord>& bins)
    {
        DraftStore drafts;
        if (state().observed.points == 0) {
            DataFiles files(folder_.tree(), state().folder, 0);
            files.finish();
            return write_index(nullptr, files);
        }
        const unsigned threads = state().bin_threads();
        const auto sorted = sort_bins(bins, threads);
        const auto levels = choose_levels(*sorted, threads);
        state().nodes.spacings = levels->spacings();
        state().nodes.chunk_points = state().options.chunk_points;

        auto files = std::make_unique<DataFiles>(folder_.tree(), state().folder, 0);
        auto jobs = std::make_unique<NodeJobs<Coord>>(bins.top, *sorted, *levels, state().nodes, drafts, *files);
        if (const auto found = checkpoints().found(Checkpoints::committed); !found.empty()) {
            try {
                jobs->go_on(found);
                went_on_ = "chunks of " + std::to_string(jobs->restored()) + " of " + std::to_string(jobs->size()) +
                           " parts had been written";
            } catch (const Error&) {
                checkpoints().cut(Checkpoints::committed);
                files = std::make_unique<DataFiles>(folder_.tree(), state().folder, 0);
                jobs = std::make_unique<NodeJobs<Coord>>(bins.top, *sorted, *levels, state().nodes, drafts, *files);
            }
        }
        checkpoints().forget_found();
        Draft* root = jobs->run(threads, checkpoints(), [&](std::uint64_t done) {
            state().watch.report("Building chunks",
                                 0.7 + 0.28 * static_cast<double>(done) / static_cast<double>(state().observed.points));
        });
        state().watch.report("Writing the index", 0.99);
        files->finish();
        write_index(root, *files);
    }

    // Each bin's rows into Morton order.
    template <class Coord>
    std::shared_ptr<SortedBins<Coord>> sort_bins(Bins<Coord>& bins, unsigned threads)
    {
        Scratch& scratch = *bins.scratch;
        std::vector<bool> is_sorted(scratch.bins());
        std::shared_ptr<SortedBins<Coord>> sorted;
        if (went_on_.empty()) {
            sorted = make_sorted_bins<Coord>(scratch, false);
        } else {
            try {
                sorted = find_sorted_bins(bins, is_sorted);
            } catch (const Error&) {
                throw Unfit();
            }
            state().watch.report("Going on with an interrupted build", 0.4, true);
        }
        std::vector<std::size_t> todo;
        std::uint64_t rows_todo = 0;
        for (std::size_t bin = 0; bin < scratch.bins(); ++bin)
            if (scratch.rows(bin) > 0 && !is_sorted[bin]) {
                todo.push_back(bin);
                rows_todo += scratch.rows(bin);
            }
        // Sorted bins that are in no checkpoint yet: what they were sorted from is still there.
        std::mutex mutex;
        std::vector<std::size_t> pending;
        std::uint64_t rows_pending = 0;
        const auto checkpoint = [&](bool last) {
            if (pending.empty()) return;
            if (!last && checkpoints().on() && !checkpoints().due() && rows_pending * 16 < rows_todo) return;
            ByteWriter record;
            record.put(static_cast<std::uint64_t>(pending.size()));
            for (const std::size_t bin : pending) {
                record.put(static_cast<std::uint64_t>(bin));
                sorted->save(bin, record);
            }
            checkpoints().post([sorted] { sorted->sync(); }, Checkpoints::sorted, std::move(record.bytes()),
                               [from = bins.scratch, done = pending] {
                                   for (const std::size_t bin : done) from->give_back(bin);
                               });
            pending.clear();
            rows_pending = 0;
        };
        std::atomic<std::size_t> next{0};
        Signal signal;
        Crew crew(signal);
        for (unsigned t = 0; t < threads; ++t)
            crew.add([&] {
                for (std::size_t i; !signal.stopped && (i = next++) < todo.size();) {
                    const std::size_t bin = todo[i], count = scratch.rows(bin);
                    const std::vector<std::byte> rows = scratch.read(bin);
                    const NodeBuilderOptions& nodes = state().nodes;
                    sorted->put(bin, rows, morton_order<Coord>(rows.data(), count, nodes.layout, nodes.lattice.finer));
                    const std::lock_guard lock(mutex);
                    pending.push_back(bin);
                    rows_pending += count;
                    checkpoint(false);
                }
            });
        crew.join([&] {
            state().watch.report("Sorting points",
                                 0.4 + 0.1 * static_cast<double>(std::min(next.load(), todo.size())) /
                                           static_cast<double>(std::max<std::size_t>(1, todo.size())));
        });
        checkpoint(true);
        checkpoints().post([from = bins.scratch] { from->clear(); });
        return sorted;
    }

    template <class Coord>
    std::shared_ptr<SortedBins<Coord>> make_sorted_bins(const Scratch& scratch, bool go_on)
    {
        auto sorted = std::make_shared<SortedBins<Coord>>(state().folder, state().nodes.layout, state().nodes.schema,
                                                          state().space, go_on);
        sorted->resize(scratch.bins());
        return sorted;
    }

    // With what an interrupted build had sorted; `is_sorted` tells which bins.
    template <class Coord>
    std::shared_ptr<SortedBins<Coord>> find_sorted_bins(const Bins<Coord>& bins, std::vector<bool>& is_sorted)
    {
        const auto found = checkpoints().found(Checkpoints::sorted);
        auto sorted = make_sorted_bins<Coord>(*bins.scratch, !found.empty());
        std::size_t count = 0;
        for (const std::vector<std::byte>* record : found) {
            ByteReader in(record->data(), record->size(), state().folder);
            for (auto left = in.get<std::uint64_t>(); left > 0; --left, ++count) {
                const auto bin = in.get<std::uint64_t>();
                if (bin >= bins.scratch->bins() || is_sorted[bin])
                    throw Error(ErrorCode::corrupt, state().folder, "a checkpoint makes no sense");
                sorted->load(bin, in);
                if (sorted->rows(bin) != bins.scratch->rows(bin))
                    throw Error(ErrorCode::corrupt, state().folder, "a checkpoint does not fit the points");
                is_sorted[bin] = true;
                bins.scratch->give_back(bin);
            }
        }
        for (std::size_t bin = 0; bin < bins.scratch->bins(); ++bin)
            if (!is_sorted[bin] && !bins.scratch->can_hold(bin))
                throw Error(ErrorCode::truncated, state().folder, "a bin of an interrupted build is missing");
        if (count)
            went_on_ = std::to_string(count) + " of " + std::to_string(bins.scratch->bins()) + " bins had been sorted";
        return sorted;
    }

    template <class Coord>
    std::shared_ptr<LevelSampler<Coord>> choose_levels(const SortedBins<Coord>& sorted, unsigned threads)
    {
        const fs::path file = state().folder / "levels.tmp";
        const auto make = [&](File::Mode mode) {
            return std::make_shared<LevelSampler<Coord>>(sorted.points(), state().nodes.lattice,
                                                         state().options.sampling, file, mode);
        };
        if (const auto found = checkpoints().found(Checkpoints::levelled); !found.empty()) {
            try {
                auto levels = make(File::Mode::change);
                ByteReader in(found[0]->data(), found[0]->size(), file);
                levels->load(in);
                state().space.take(levels->bytes());
                went_on_ = "its levels had been chosen";
                return levels;
            } catch (const Error&) {
                checkpoints().cut(Checkpoints::levelled);
            }
        }
        auto levels = make(File::Mode::create_or_truncate);
        levels->run(threads, [&](double fraction) { state().watch.report("Choosing levels", 0.5 + 0.2 * fraction); });
        state().space.take(levels->bytes());
        ByteWriter record;
        levels->save(record);
        checkpoints().post([levels] { levels->sync(); }, Checkpoints::levelled, std::move(record.bytes()));
        return levels;
    }

    void write_index(Draft* root, DataFiles& files)
    {
        TreeIndex index = index_of_drafts(root);
        TreeInfo& info = index.info;
        info.sampling = state().options.sampling;
        info.spacings = state().nodes.spacings;
        info.levels = static_cast<std::uint16_t>(info.spacings.size());
        info.points = state().observed.points;
        const std::uint64_t stored = index.nodes.empty() ? 0 : index.nodes[0].subtree_points;
        if (stored != info.points || state().points_in != stored + state().points_skipped)
            throw Error(ErrorCode::corrupt, output_,
                        std::to_string(state().points_in) + " points went in, " + std::to_string(stored) +
                            " came out; this is a defect of the program");
        info.points_skipped = state().points_skipped;
        info.content_hash = state().observed.hash;
        info.grid = state().nodes.grid;
        info.position_type = state().position_type;
        info.wide = state().nodes.layout.coordinate_bytes == 8;
        info.schema = state().nodes.schema;
        if (!index.nodes.empty()) info.box = index.nodes[0].box;
        info.extremes = state().observed.extremes;
        info.position_error = state().observed.position_error;
        info.metadata = state().metadata;
        info.sources = sources_;
        if (state().like) take_over(*state().like, info);
        for (const std::uint64_t data_bytes : files.bytes()) index.data_files.push_back({data_bytes, info.generation});
        write_commit(folder_.tree(), index);
        write_about(folder_.tree(), info);
        const std::vector<std::byte> bytes = encode_index(index);
        replace_file(folder_.tree() / index_file_name, bytes.data(), bytes.size());

        report_.outcome.points_in = state().points_in;
        report_.outcome.points_out = info.points;
        report_.outcome.error = info.position_error;
        report_.outcome.error_meaning = "largest position error, source units";
        report_.points_skipped = state().points_skipped;
        report_.nodes = index.nodes.size();
        report_.levels = info.levels;
        report_.bytes = bytes.size();
        for (const DataFile& file : index.data_files) report_.bytes += file.bytes;
        state().watch.report("Done", 1);
    }

    void take_over(const TreeInfo& like, TreeInfo& info) const
    {
        if (info.points != like.points || info.content_hash != like.content_hash)
            throw Error(ErrorCode::corrupt, output_, "the points that were read are not those that the tree had",
                        "check it with 'pcmlab verify'");
        info.points_skipped = like.points_skipped;
        info.position_type = like.position_type;
        info.position_error = like.position_error;
        info.metadata = like.metadata;
    }

    PointReader& cloud_;
    const std::vector<std::string>& sources_;
    const fs::path output_;
    BuildFolder folder_;
    std::unique_ptr<BuildState> state_;
    const std::optional<std::vector<std::byte>> identity_;
    std::string went_on_;  // what an interrupted build had done
    BuildReport report_;
    std::unique_ptr<Checkpoints> checkpoints_ = std::make_unique<Checkpoints>();
};

// Throws for options out of range; the folder that `output` names.
fs::path check(const fs::path& output, const BuildOptions& options)
{
    check_build_options(options);
    fs::path folder = output;
    if (folder.filename().empty()) folder = folder.parent_path();  // "name.pct/" means name.pct
    if (folder.empty()) throw Error(ErrorCode::invalid_argument, {}, "the tree needs a name");
    return folder;
}

BuildReport build(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& folder,
                  const BuildOptions& options, const std::optional<std::vector<std::byte>>& identity,
                  const TreeInfo* like = nullptr)
{
    try {
        return TreeBuild(cloud, sources, folder, options, identity, like).run();
    } catch (const fs::filesystem_error& error) {
        throw Error::from_errno(error.code().value(), error.path1(), "working in the folder");
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::io, folder, "the system has no memory left", "lower the memory of the build");
    }
}

}  // namespace

void check_build_options(const BuildOptions& options)
{
    if (options.memory_bytes < least_build_memory)
        throw Error(ErrorCode::invalid_argument, {}, "a build needs at least 64 MiB of memory");
    if (options.chunk_points < least_chunk_points || options.chunk_points > most_chunk_points)
        throw Error(ErrorCode::invalid_argument, {},
                    "points a chunk must be between " + std::to_string(least_chunk_points) + " and " +
                        std::to_string(most_chunk_points) + ", not " + std::to_string(options.chunk_points));
    if (options.threads > most_build_threads)
        throw Error(ErrorCode::invalid_argument, {}, "more than " + std::to_string(most_build_threads) + " threads");
}

BuildReport build_tree(const std::vector<fs::path>& inputs, const fs::path& output, const BuildOptions& options)
{
    const fs::path folder = check(output, options);  // before all files are looked at
    MergedReader cloud(inputs, options.read);
    std::vector<std::string> sources;
    std::vector<fs::path> files;
    for (const MergedReader::Source& source : cloud.sources()) {
        sources.push_back(source.path.filename().string());
        files.push_back(source.path);
    }
    std::optional<std::vector<std::byte>> identity;
    if (options.resume) identity = identity_of_build(files, options);
    return build(cloud, sources, folder, options, identity);
}

BuildReport build_tree(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& output,
                       const BuildOptions& options)
{
    return build(cloud, sources, check(output, options), options, std::nullopt);
}

BuildReport rebuild_tree(PointReader& cloud, const TreeInfo& like, const fs::path& output, const BuildOptions& options)
{
    return build(cloud, like.sources, check(output, options), options, std::nullopt, &like);
}

}  // namespace pcm
