#include "tree/builder.h"

#include "cloud/error.h"
#include "io/merged_reader.h"
#include "tree/about.h"
#include "tree/build_folder.h"
#include "tree/build_state.h"
#include "tree/data_files.h"
#include "tree/draft_index.h"
#include "tree/level_sampler.h"
#include "tree/morton_sort.h"
#include "tree/node_jobs.h"
#include "tree/partition.h"
#include "tree/sorted_bins.h"

#include <atomic>

namespace pcm {
namespace {

namespace fs = std::filesystem;

class TreeBuild {
public:
    // `like`: of the tree whose points these are; null when there is none.
    TreeBuild(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& output, const BuildOptions& options,
              const TreeInfo* like = nullptr)
        : cloud_(cloud), sources_(sources), output_(output), folder_(output, options.overwrite), state_(options, folder_.path())
    {
        state_.like = like;
    }

    BuildReport run()
    {
        AnyBins bins = partition(cloud_, state_);
        // Now they are complete: readers find out on the way what they drop.
        const FileInfo& info = cloud_.info();
        state_.notes.insert(state_.notes.begin(), info.notes.begin(), info.notes.end());
        state_.metadata = info.metadata;
        std::visit([&](auto& of) { make_nodes(of); }, bins);
        folder_.publish();
        report_.scratch_bytes = state_.space.peak();
        report_.notes = state_.notes;
        report_.outcome.seconds = state_.watch.seconds();
        return report_;
    }

private:
    // Sort each bin, choose the points' levels, make the nodes.
    template <class Coord>
    void make_nodes(Bins<Coord>& bins)
    {
        DataFiles files(state_.folder);
        DraftStore drafts;
        Draft* root = nullptr;
        if (state_.observed.points > 0) {
            const unsigned threads = state_.bin_threads();
            SortedBins<Coord> sorted(state_.folder, state_.nodes.layout, state_.nodes.schema, state_.space);
            sort_bins(bins, sorted, threads);
            LevelSampler<Coord> levels(sorted.points(), state_.nodes.lattice, state_.options.sampling,
                                       state_.folder / "levels.tmp");
            levels.run(threads, [&](double fraction) { state_.watch.report("Choosing levels", 0.5 + 0.2 * fraction); });
            state_.space.take(levels.bytes());
            state_.nodes.spacings = levels.spacings();
            state_.nodes.chunk_points = state_.options.chunk_points;
            NodeJobs<Coord> jobs(bins.top, sorted, levels, state_.nodes, drafts, files);
            root = jobs.run(threads, [&](std::uint64_t done) {
                state_.watch.report("Building chunks",
                                    0.7 + 0.28 * static_cast<double>(done) / static_cast<double>(state_.observed.points));
            });
        }
        write_index(root, files);
    }

    // Each bin's rows into Morton order.
    template <class Coord>
    void sort_bins(Bins<Coord>& bins, SortedBins<Coord>& sorted, unsigned threads)
    {
        Scratch& scratch = *bins.scratch;
        sorted.resize(scratch.bins());
        std::atomic<std::size_t> next{0};
        Signal signal;
        Crew crew(signal);
        for (unsigned t = 0; t < threads; ++t)
            crew.add([&] {
                for (std::size_t bin; !signal.stopped && (bin = next++) < scratch.bins();) {
                    const std::size_t count = scratch.rows(bin);
                    if (count == 0) continue;
                    const std::vector<std::byte> rows = scratch.read(bin);
                    const NodeBuilderOptions& nodes = state_.nodes;
                    sorted.put(bin, rows, morton_order<Coord>(rows.data(), count, nodes.layout, nodes.lattice.finer));
                    scratch.give_back(bin);
                }
            });
        crew.join([&] {
            state_.watch.report("Sorting points", 0.4 + 0.1 * static_cast<double>(std::min(next.load(), scratch.bins())) /
                                                            static_cast<double>(scratch.bins()));
        });
        scratch.remove();
    }

    void write_index(Draft* root, DataFiles& files)
    {
        state_.watch.report("Writing the index", 0.99);
        files.finish();
        TreeIndex index = index_of_drafts(root);
        TreeInfo& info = index.info;
        info.sampling = state_.options.sampling;
        info.spacings = state_.nodes.spacings;
        info.levels = static_cast<std::uint16_t>(info.spacings.size());
        info.points = state_.observed.points;
        const std::uint64_t stored = index.nodes.empty() ? 0 : index.nodes[0].subtree_points;
        if (stored != info.points || state_.points_in != stored + state_.points_skipped)
            throw Error(ErrorCode::corrupt, output_,
                        std::to_string(state_.points_in) + " points went in, " + std::to_string(stored) +
                            " came out; this is a defect of the program");
        info.points_skipped = state_.points_skipped;
        info.content_hash = state_.observed.hash;
        info.grid = state_.nodes.grid;
        info.position_type = state_.position_type;
        info.wide = state_.nodes.layout.coordinate_bytes == 8;
        info.schema = state_.nodes.schema;
        if (!index.nodes.empty()) info.box = index.nodes[0].box;
        info.extremes = state_.observed.extremes;
        info.position_error = state_.observed.position_error;
        info.metadata = state_.metadata;
        info.sources = sources_;
        if (state_.like) take_over(*state_.like, info);
        for (const std::uint64_t data_bytes : files.bytes()) index.data_files.push_back({data_bytes, info.generation});
        write_commit(state_.folder, index);
        write_about(state_.folder, info);
        const std::vector<std::byte> bytes = encode_index(index);
        replace_file(state_.folder / index_file_name, bytes.data(), bytes.size());

        report_.outcome.points_in = state_.points_in;
        report_.outcome.points_out = info.points;
        report_.outcome.error = info.position_error;
        report_.outcome.error_meaning = "largest position error, source units";
        report_.points_skipped = state_.points_skipped;
        report_.nodes = index.nodes.size();
        report_.levels = info.levels;
        report_.bytes = bytes.size();
        for (const DataFile& file : index.data_files) report_.bytes += file.bytes;
        state_.watch.report("Done", 1);
    }

    void take_over(const TreeInfo& like, TreeInfo& info) const
    {
        if (info.points != like.points || info.content_hash != like.content_hash)
            throw Error(ErrorCode::corrupt, output_, "the points that were read are not those that the tree had",
                        "check it with 'pcm verify'");
        info.points_skipped = like.points_skipped;
        info.position_type = like.position_type;
        info.position_error = like.position_error;
        info.metadata = like.metadata;
    }

    PointReader& cloud_;
    const std::vector<std::string>& sources_;
    const fs::path output_;
    BuildFolder folder_;
    BuildState state_;
    BuildReport report_;
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

BuildReport run_build(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& output, const BuildOptions& options,
                      const TreeInfo* like)
{
    const fs::path folder = check(output, options);
    try {
        return TreeBuild(cloud, sources, folder, options, like).run();
    } catch (const fs::filesystem_error& error) {
        throw Error::from_errno(error.code().value(), error.path1(), "working in the folder");
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::io, folder, "the system has no memory left", "lower the memory of the build");
    }
}

}  // namespace

void check_build_options(const BuildOptions& options)
{
    if (options.memory_bytes < (std::uint64_t(64) << 20))
        throw Error(ErrorCode::invalid_argument, {}, "a build needs at least 64 MiB of memory");
    if (options.chunk_points < 1000 || options.chunk_points > 10000000)
        throw Error(ErrorCode::invalid_argument, {}, "points a chunk must be between 1000 and 10000000, not " +
                                                         std::to_string(options.chunk_points));
    if (options.threads > 1024) throw Error(ErrorCode::invalid_argument, {}, "more than 1024 threads");
}

BuildReport build_tree(const std::vector<fs::path>& inputs, const fs::path& output, const BuildOptions& options)
{
    check(output, options);  // before all files are looked at
    MergedReader cloud(inputs, options.read);
    std::vector<std::string> sources;
    for (const MergedReader::Source& source : cloud.sources()) sources.push_back(source.path.filename().string());
    return build_tree(cloud, sources, output, options);
}

BuildReport build_tree(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& output,
                       const BuildOptions& options)
{
    return run_build(cloud, sources, output, options, nullptr);
}

BuildReport rebuild_tree(PointReader& cloud, const TreeInfo& like, const fs::path& output, const BuildOptions& options)
{
    return run_build(cloud, like.sources, output, options, &like);
}

}  // namespace pcm
