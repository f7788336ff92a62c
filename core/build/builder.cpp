#include "pcm/build/builder.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/bins/partition.h"
#include "pcm/build/bins/reader_facts.h"
#include "pcm/build/build_checkpoint.h"
#include "pcm/build/build_folder.h"
#include "pcm/build/build_then.h"
#include "pcm/build/checkpoints.h"
#include "pcm/build/nodes/draft_index.h"
#include "pcm/build/pipeline.h"
#include "pcm/build/written_tree.h"
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
        take_reader_facts(cloud_.info(), cloud_found());
        checkpoint_bins(bins);
        make_tree(bins, {});
    }

    void do_then()
    {
        report_.outcome.seconds = work().watch.seconds();
        run_then(then_, folder_.tree(), output_, report_);
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
        WrittenTree tree;
        tree.folder = folder_.tree();
        tree.output = output_;
        tree.root = part.root;
        tree.spacings = part.spacings;
        tree.data_files = files.bytes();
        tree.sources = sources_;
        tree.sampling = options_.sampling;
        tree.like = like_;
        pcm::write_tree(tree, cloud_found(), report_);
        work().watch.report("Done", 1);
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
