#include "pcm/cluster/team_build.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/build_checkpoint.h"
#include "pcm/build/build_folder.h"
#include "pcm/build/nodes/data_files.h"
#include "pcm/build/written_tree.h"
#include "pcm/cluster/input_jobs.h"
#include "pcm/cluster/rank_error.h"
#include "pcm/cluster/subtree_jobs.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/renamed_error.h"
#include "pcm/tree/unfinished_build.h"

#include <optional>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr const char* jobs_name = "jobs";     // in the folder of the build
constexpr JobFolder::Key build_job{"build"};  // its record: the build's identity

class TeamBuild {
public:
    TeamBuild(Team& team, const std::vector<fs::path>& inputs, const fs::path& output, const BuildOptions& options,
              const WorkOnTree& then)
        : team_(team), output_(output), options_(options), then_(then), cloud_(inputs, options.read)
    {
    }

    BuildReport run()
    {
        const std::vector<std::byte> identity = common_identity();
        open_folder(identity);
        const JobFolder jobs(part_ / jobs_name, team_.rank(), options_.resume);
        Workspace work(part_, options_.memory_bytes, options_.chunk_points, options_.threads, options_.progress);
        const TeamWork all{team_, jobs, work, options_};
        BinRows rows(found_);
        const AnyTop top = read_input(all, cloud_, found_, rows);
        std::visit([&](const auto& of) { make_tree(all, of, rows); }, top);
        finish(work);
        team_.wait();
        return std::move(report_);
    }

private:
    // Throws where another rank sees other files.
    std::vector<std::byte> common_identity()
    {
        std::vector<fs::path> files;
        for (const MergedReader::Source& source : cloud_.sources()) files.push_back(source.path);
        std::vector<std::byte> mine = identity_of_build(files, options_);
        if (team_.broadcast(0, mine) != mine)
            throw Error(ErrorCode::invalid_argument, {},
                        "rank " + std::to_string(team_.rank()) +
                            " sees other input files, or has other options, than rank 0: paths, sizes, times and "
                            "options have to be the same everywhere",
                        "give paths of a folder that all machines share");
        return mine;
    }

    // Rank 0 takes the folder, and removes the work of another build.
    void open_folder(const std::vector<std::byte>& identity)
    {
        std::string name;
        if (team_.rank() == 0) {
            folder_.emplace(output_, options_.overwrite, Builders::a_team);
            part_ = folder_->work();
            const JobFolder jobs(part_ / jobs_name, 0, options_.resume);
            if (folder_->left_over()) {
                const bool same = options_.resume && jobs.is_done(build_job) && jobs.record(build_job) == identity;
                if (same) {
                    report_.notes.push_back("an interrupted build was resumed");
                    jobs.remove_unfinished();
                } else {
                    report_.notes.push_back(
                        "the remains of an interrupted build of other files or with other options were removed");
                    folder_->clear();
                }
            }
            jobs.begin(build_job.stage);
            if (!jobs.is_done(build_job)) jobs.write(build_job, {}, identity);
            name = part_.string();
        }
        ByteWriter out;
        out.put_string(name);
        const Team::Bytes bytes = team_.broadcast(0, std::move(out.bytes()));
        ByteReader in(bytes.data(), bytes.size(), output_);
        part_ = in.get_string();
    }

    template <class Coord>
    void make_tree(const TeamWork& all, const TopTree<Coord>& top, const BinRows& rows)
    {
        const fs::path tree_folder = part_ / "tree";
        DraftStore drafts;
        TeamTree tree;
        std::vector<double> spacings;
        if (found_.observed.points > 0) {
            BinFiles<Coord> bins(all, found_, rows.bins());
            bins.sort(rows);
            LevelFiles levels(all, rows.bins());
            levels.choose(found_, top, bins);
            spacings = levels.spacings();
            tree = build_nodes(all, found_, top, bins, levels, tree_folder, drafts);
        } else if (team_.rank() == 0) {
            DataFiles none(tree_folder, part_, 0);
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

    // Collective: rank 0 gives the tree its name.
    void finish(Workspace& work)
    {
        ByteWriter peak;
        peak.put(work.space.peak());
        const std::vector<Team::Bytes> peaks = team_.gather(std::move(peak.bytes()));
        if (team_.rank() != 0) return;
        for (const Team::Bytes& bytes : peaks)
            report_.scratch_bytes += ByteReader(bytes.data(), bytes.size(), output_).get<std::uint64_t>();
        report_.outcome.seconds = work.watch.seconds();
        if (then_) run_then(then_, folder_->tree(), output_, report_);
        run_last_step(report_.outcome, [this] { folder_->publish(); });
        report_.notes.insert(report_.notes.begin(), found_.notes.begin(), found_.notes.end());
        report_.skipped = found_.skipped;
    }

    Team& team_;
    const fs::path output_;
    const BuildOptions& options_;
    const WorkOnTree& then_;
    MergedReader cloud_;
    std::optional<BuildFolder> folder_;  // rank 0's
    fs::path part_;
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

bool was_built_by_team(const fs::path& output)
{
    std::error_code error;
    return fs::exists(build_folder_of(output_tree(output)) / jobs_name, error);
}

}  // namespace pcm
