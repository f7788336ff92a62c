#include "pcm/build/builder.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/bins/partition.h"
#include "pcm/build/build_checkpoint.h"
#include "pcm/build/build_folder.h"
#include "pcm/build/build_then.h"
#include "pcm/build/checkpoints.h"
#include "pcm/build/nodes/draft_index.h"
#include "pcm/build/pipeline.h"
#include "pcm/io/pipe/merged_reader.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/renamed_error.h"
#include "pcm/tree/about.h"
#include "pcm/tree/unfinished_build.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

// What became of the remains of an interrupted build.
enum class Remains { none, of_another_build, without_checkpoint, damaged, resumed };

// For the report; empty where nothing is to be reported.
std::string describe(Remains remains, const Resumed& resumed)
{
    const std::string done = std::to_string(resumed.done), all = std::to_string(resumed.all);
    switch (remains) {
        case Remains::none:
            return {};
        case Remains::of_another_build:
            return "the remains of an interrupted build of other files or with other options were removed";
        case Remains::without_checkpoint:
            return "an interrupted build was restarted: it had no valid checkpoint";
        case Remains::damaged:
            return "an interrupted build was restarted: its files were damaged";
        case Remains::resumed:
            break;
    }
    const std::string note = "an interrupted build was resumed: ";
    switch (resumed.stage) {
        case Resumed::Stage::sorted:
            return note + done + " of " + all + " bins had been sorted";
        case Resumed::Stage::levelled:
            return note + "its levels had been chosen";
        case Resumed::Stage::committed:
            return note + "chunks of " + done + " of " + all + " parts had been written";
        default:
            return note + "its points had been read";
    }
}

class TreeBuild {
public:
    // `identity`: see identity_of_build(); absent for a build that makes no checkpoints. `like`: the tree whose points
    // these are, if any. `then`: see build_tree_then(); may be empty.
    TreeBuild(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& output,
              const BuildOptions& options, const std::optional<std::vector<std::byte>>& identity, const TreeInfo* like,
              const WorkOnTree& then)
        : cloud_(cloud),
          sources_(sources),
          output_(output),
          options_(options),
          like_(like),
          then_(then),
          identity_(identity),
          folder_(output, options.overwrite),
          state_(std::make_unique<State>(options, folder_.work()))
    {
    }

    BuildReport run()
    {
        const Remains remains = folder_.left_over() ? resume() : Remains::none;
        if (remains != Remains::resumed) {
            if (remains != Remains::none) discard_remains();
            start();
        }
        checkpoints().wait();
        if (then_) do_then();
        run_last_step(report_.outcome, [this] { folder_.publish(); });
        report_.scratch_bytes = work().space.peak();
        report_.notes = cloud_found().notes;
        report_.skipped = cloud_found().skipped;
        if (std::string note = folder_.note(); !note.empty()) report_.notes.push_back(std::move(note));
        if (std::string note = describe(remains, resumed_); !note.empty()) report_.notes.push_back(std::move(note));
        if (!then_) report_.outcome.seconds = work().watch.seconds();
        return std::move(report_);
    }

private:
    // Replaced by a restart. The checkpoints are destroyed first: their tasks use the rest.
    struct State {
        State(const BuildOptions& options, const fs::path& folder)
            : work(folder, options.memory_bytes, options.chunk_points, options.threads, options.progress)
        {
        }
        Workspace work;
        Ingested cloud;
        std::unique_ptr<Checkpoints> checkpoints = std::make_unique<Checkpoints>();
    };
    Workspace& work() { return state_->work; }
    Ingested& cloud_found() { return state_->cloud; }
    Checkpoints& checkpoints() { return *state_->checkpoints; }

    void open_checkpoints()
    {
        if (!identity_) return;
        state_->checkpoints =
            std::make_unique<Checkpoints>(work().folder / "journal", *identity_, options_.checkpoint_seconds);
    }

    Remains resume()
    {
        open_checkpoints();
        if (!checkpoints().same_build()) return Remains::of_another_build;
        std::optional<AnyBins> bins = find_bins();
        if (!bins) return Remains::without_checkpoint;
        try {
            make_tree(*bins, {Resumed::Stage::partitioned, 0, 0});
            return Remains::resumed;
        } catch (const Error& error) {
            // The files do not match the journal. This is found late, but a restart loses nothing.
            const bool damaged = error.code() == ErrorCode::corrupt || error.code() == ErrorCode::truncated;
            if (!damaged || error.path().parent_path() != work().folder) throw;
            return Remains::damaged;
        }
    }

    void discard_remains()
    {
        state_->checkpoints = std::make_unique<Checkpoints>();
        folder_.clear();
        state_ = std::make_unique<State>(options_, folder_.work());
    }

    void start()
    {
        open_checkpoints();
        AnyBins bins = partition(cloud_, work(), cloud_found(), like_);
        // Readers learn while they read what they leave out, so notes and metadata are complete only now.
        const FileInfo& info = cloud_.info();
        cloud_found().notes.insert(cloud_found().notes.begin(), info.notes.begin(), info.notes.end());
        cloud_found().metadata = info.metadata;
        cloud_found().skipped = info.skipped;
        set_decimals(cloud_found().metadata, cloud_found().decimals);
        // Points that the reader was asked to leave out were read as well.
        cloud_found().points_in += info.points_left_out;
        cloud_found().points_skipped += info.points_left_out;
        checkpoint_bins(bins);
        make_tree(bins, {});
    }

    void do_then()
    {
        report_.outcome.seconds = work().watch.seconds();
        then_(folder_.tree(), report_);
        for (std::string& warning : report_.outcome.warnings) warning = renamed(warning, folder_.tree(), output_);
    }

    // The bins of an interrupted build, if there are any that match the files.
    std::optional<AnyBins> find_bins()
    {
        const auto found = checkpoints().found(Checkpoints::partitioned);
        if (found.empty()) return std::nullopt;
        try {
            ByteReader in(found[0]->data(), found[0]->size(), work().folder);
            return load_bins(cloud_found(), work(), cloud_.info().schema, in);
        } catch (const Error&) {
            return std::nullopt;
        }
    }

    // A build that takes little time to repeat makes no checkpoints.
    void checkpoint_bins(const AnyBins& bins)
    {
        if (!checkpoints().on()) return;
        if (cloud_found().observed.points == 0 || work().watch.seconds() < checkpoints().seconds())
            return checkpoints().off();
        ByteWriter record;
        save_bins(cloud_found(), bins, record);
        std::shared_ptr<Scratch> scratch = std::visit([](const auto& of) { return of.scratch; }, bins);
        checkpoints().post([scratch] { scratch->sync(); }, Checkpoints::partitioned, std::move(record.bytes()));
    }

    void make_tree(AnyBins& bins, const Resumed& resumed)
    {
        PartOptions part_options;
        part_options.sampling = options_.sampling;
        part_options.resumed = resumed;
        DraftStore drafts;
        DataFiles files(folder_.tree(), work().folder, 0);
        const Part part = std::visit(
            [&](auto& of) { return make_part(of, work(), cloud_found(), part_options, checkpoints(), drafts, files); },
            bins);
        resumed_ = part.resumed;
        work().watch.report("Writing the index", 0.99);
        files.finish();
        write_tree(part, files);
    }

    void write_tree(const Part& part, const DataFiles& files)
    {
        TreeIndex index = index_of_drafts(part.root);
        index.info.spacings = part.spacings;
        fill_info(index);
        const TreeInfo& info = index.info;
        for (const std::uint64_t data_bytes : files.bytes()) index.data_files.push_back({data_bytes, info.generation});
        write_commit(folder_.tree(), index);
        write_about(folder_.tree(), info);
        const std::vector<std::byte> bytes = encode_index(index);
        replace_file(folder_.tree() / index_file_name, bytes.data(), bytes.size());
        remove_strays(index.data_files.size());

        report_.outcome.points_in = cloud_found().points_in;
        report_.outcome.points_out = info.points;
        report_.outcome.error = info.position_error;
        report_.outcome.error_meaning = "largest position error, source units";
        report_.points_skipped = cloud_found().points_skipped;
        report_.nodes = index.nodes.size();
        report_.levels = info.levels;
        report_.bytes = bytes.size();
        for (const DataFile& file : index.data_files) report_.bytes += file.bytes;
        work().watch.report("Done", 1);
    }

    // What interrupted work on the tree of an earlier run has left in it, which build_tree_then() does again.
    void remove_strays(std::size_t data_files)
    {
        std::vector<fs::path> strays{folder_.tree() / update_scratch_name, folder_.tree() / lock_file_name};
        const auto file = [&] { return folder_.tree() / data_file_name(static_cast<std::uint32_t>(data_files)); };
        for (; fs::exists(file()); ++data_files) strays.push_back(file());
        for (const fs::path& stray : strays) fs::remove_all(stray);
    }

    // Throws Error(corrupt) when points were lost on the way.
    void fill_info(TreeIndex& index)
    {
        const Ingested& cloud = cloud_found();
        TreeInfo& info = index.info;
        info.sampling = options_.sampling;
        info.levels = static_cast<std::uint16_t>(info.spacings.size());
        info.points = cloud.observed.points;
        const std::uint64_t stored = index.nodes.empty() ? 0 : index.nodes[0].subtree_points;
        if (stored != info.points || cloud.points_in != stored + cloud.points_skipped)
            throw Error(ErrorCode::corrupt, output_,
                        std::to_string(cloud.points_in) + " points went in, " + std::to_string(stored) +
                            " came out; this is a defect of the program");
        info.points_skipped = cloud.points_skipped;
        info.content_hash = cloud.observed.hash;
        info.grid = cloud.grid;
        info.position_type = cloud.position_type;
        info.wide = cloud.layout.coordinate_bytes == 8;
        info.schema = cloud.schema;
        if (!index.nodes.empty()) info.box = index.nodes[0].box;
        info.extremes = cloud.observed.extremes;
        info.position_error = cloud.observed.position_error;
        info.metadata = cloud.metadata;
        info.sources = sources_;
        if (like_) take_over(*like_, info);
    }

    void take_over(const TreeInfo& like, TreeInfo& info) const
    {
        if (info.points != like.points || info.content_hash != like.content_hash)
            throw Error(ErrorCode::corrupt, output_, "the points that were read differ from those that the tree had",
                        "check it with 'pcmlab verify'");
        info.points_skipped = like.points_skipped;
        info.position_type = like.position_type;
        info.position_error = like.position_error;
        info.metadata = like.metadata;
    }

    PointReader& cloud_;
    const std::vector<std::string>& sources_;
    const fs::path output_;
    const BuildOptions& options_;
    const TreeInfo* const like_;
    const WorkOnTree& then_;
    const std::optional<std::vector<std::byte>> identity_;
    BuildFolder folder_;
    std::unique_ptr<State> state_;
    Resumed resumed_;
    BuildReport report_;
};

// Throws for options out of range; the folder that `output` names.
fs::path check(const fs::path& output, const BuildOptions& options)
{
    check_build_options(options);
    output_tree(output);  // refuses what cannot be a tree's name
    return output;
}

BuildReport build(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& folder,
                  const BuildOptions& options, const std::optional<std::vector<std::byte>>& identity,
                  const TreeInfo* like = nullptr, const WorkOnTree& then = {})
{
    try {
        return TreeBuild(cloud, sources, folder, options, identity, like, then).run();
    } catch (const Error& error) {
        if (error.is_done()) throw;
        throw renamed(error, build_folder_of(folder) / "tree", folder);  // users know the tree's name
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
    return build_tree_then(inputs, output, options, {});
}

BuildReport build_tree_then(const std::vector<fs::path>& inputs, const fs::path& output, const BuildOptions& options,
                            const WorkOnTree& then)
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
    return build(cloud, sources, folder, options, identity, nullptr, then);
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
