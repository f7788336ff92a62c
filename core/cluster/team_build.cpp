#include "pcm/cluster/team_build.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/build_checkpoint.h"
#include "pcm/build/nodes/data_files.h"
#include "pcm/build/written_tree.h"
#include "pcm/cluster/input_jobs.h"
#include "pcm/cluster/rank_error.h"
#include "pcm/cluster/shared_record.h"
#include "pcm/cluster/stages.h"
#include "pcm/cluster/subtree_jobs.h"
#include "pcm/cluster/team_folder.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/renamed_error.h"
#include "pcm/tree/unfinished_build.h"

#include <optional>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr JobFolder::Key sorted_job{stage::sorted};

class TeamBuild {
public:
    TeamBuild(Team& team, const std::vector<fs::path>& inputs, const fs::path& output, const BuildOptions& options,
              const WorkOnTree& then)
        : team_(team), output_(output), options_(options), then_(then), cloud_(inputs, options.read)
    {
    }

    BuildReport run()
    {
        folder_.emplace(team_, output_, options_.overwrite, identity(), options_.resume);
        note_what_was_found();
        Workspace work(folder_->path(), options_.memory_bytes, options_.chunk_points, options_.threads,
                       options_.progress);
        const TeamWork all{team_, folder_->jobs(), work, options_};
        all.jobs.begin(sorted_job.stage);
        const std::vector<std::byte> sorted = find_or_make(team_, all.jobs, sorted_job, [&] { return sort(all); });
        if (team_.rank() == 0)
            all.jobs.give_up({stage::plan, stage::batches, stage::spools, stage::samples, stage::cuts, stage::spooled,
                              stage::divisions},
                             stage::sorted);
        ByteReader in(sorted.data(), sorted.size(), all.jobs.file(sorted_job));
        found_ = Ingested();
        load_found(found_, cloud_.info().schema, in);
        if (found_.layout.coordinate_bytes == 8)
            make_tree<std::uint64_t>(all, in);
        else
            make_tree<std::uint32_t>(all, in);
        finish(work);
        team_.wait();
        return std::move(report_);
    }

private:
    std::vector<std::byte> identity() const
    {
        std::vector<fs::path> files;
        for (const MergedReader::Source& source : cloud_.sources()) files.push_back(source.path);
        return identity_of_build(files, options_);
    }

    void note_what_was_found()
    {
        if (folder_->found() == TeamFolder::Found::same_work)
            report_.notes.push_back("an interrupted build was resumed");
        if (folder_->found() == TeamFolder::Found::other_work)
            report_.notes.push_back(
                "the remains of an interrupted build of other files or with other options were removed");
    }

    // Collective: reads and sorts the points. Returns, in rank 0, what is known of them then.
    std::vector<std::byte> sort(const TeamWork& all)
    {
        BinRows rows(found_);
        const AnyTop any = read_input(all, cloud_, found_, rows);
        ByteWriter known;
        save_found(found_, known);
        std::visit([&](const auto& top) { sort_bins(all, top, rows, known); }, any);
        if (options_.resume && team_.rank() == 0) sync_folder(all.jobs.file({stage::bins}).parent_path());
        return std::move(known.bytes());
    }

    template <class Coord>
    void sort_bins(const TeamWork& all, const TopTree<Coord>& top, const BinRows& rows, ByteWriter& known) const
    {
        BinFiles<Coord> bins(all, found_, rows.bins());
        bins.sort(rows);
        save_top(top, known);
        bins.save(known);
    }

    // `sorted`: the cuts and the bins, as sort_bins() wrote them.
    template <class Coord>
    void make_tree(const TeamWork& all, ByteReader& sorted)
    {
        const TopTree<Coord> top = load_top<Coord>(sorted);
        BinFiles<Coord> bins(all, found_, sorted);
        const fs::path tree_folder = folder_->path() / "tree";
        DraftStore drafts;
        TeamTree tree;
        std::vector<double> spacings;
        if (found_.observed.points > 0) {
            LevelFiles levels(all, bins.count());
            levels.choose(found_, top, bins);
            spacings = levels.spacings();
            tree = build_nodes(all, found_, top, bins, levels, tree_folder, drafts);
        } else if (team_.rank() == 0) {
            DataFiles none(tree_folder, folder_->path(), 0);
            none.finish();
            tree.data_files = none.bytes();
        }
        if (team_.rank() == 0) write_index(all.work, tree_folder, tree, spacings);
    }

    void write_index(Workspace& work, const fs::path& folder, const TeamTree& tree, const std::vector<double>& spacings)
    {
        work.watch.report("Writing the index", 0.99);
        WrittenTree written;
        written.folder = folder;
        written.output = output_;
        written.root = tree.root;
        written.spacings = spacings;
        written.data_files = tree.data_files;
        for (const MergedReader::Source& source : cloud_.sources())
            written.sources.push_back(source.path.filename().string());
        written.sampling = options_.sampling;
        write_tree(written, found_, report_);
        work.watch.report("Done", 1);
    }

    // Rank 0 gives the tree its name.
    void finish(Workspace& work)
    {
        if (team_.rank() != 0) return;
        report_.scratch_bytes = folder_->jobs().most_bytes();
        report_.outcome.seconds = work.watch.seconds();
        if (then_) run_then(then_, folder_->build().tree(), output_, report_);
        run_last_step(report_.outcome, [this] { folder_->build().publish(); });
        report_.notes.insert(report_.notes.begin(), found_.notes.begin(), found_.notes.end());
        report_.skipped = found_.skipped;
    }

    Team& team_;
    const fs::path output_;
    const BuildOptions& options_;
    const WorkOnTree& then_;
    MergedReader cloud_;
    std::optional<TeamFolder> folder_;
    Ingested found_;
    BuildReport report_;
};

}  // namespace

BuildReport build_tree_by(Team& team, const std::vector<fs::path>& inputs, const fs::path& output,
                          const BuildOptions& options, const WorkOnTree& then)
{
    check_build_options(options);
    output_tree(output);  // refuses what cannot be a tree's name
    return named_by_rank(team, output, [&] {
        try {
            return TeamBuild(team, inputs, output, options, then).run();
        } catch (const Error& error) {
            if (error.is_done()) throw;
            throw renamed(error, build_folder_of(output) / "tree", output);  // users know the tree's name
        }
    });
}

}  // namespace pcm
