#include "pcm/update/append.h"

#include "pcm/build/bins/partition.h"
#include "pcm/build/pipeline.h"
#include "pcm/cloud/vector.h"
#include "pcm/io/pipe/system_check.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/update/fitted_reader.h"
#include "pcm/update/given_points.h"
#include "pcm/update/tree_update.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

namespace pcm {
namespace {

namespace fs = std::filesystem;

BuildOptions build_options(const AppendOptions& options, Sampling sampling)
{
    BuildOptions build;
    build.memory_bytes = options.memory_bytes;
    build.threads = options.threads;
    build.chunk_points = options.chunk_points;
    build.sampling = sampling;
    build.progress = options.progress;
    check_build_options(build);
    return build;
}

class Append {
public:
    Append(const fs::path& path, PointReader& cloud, const std::vector<std::string>& sources,
           const AppendOptions& options)
        : cloud_(cloud),
          sources_(sources),
          update_(path),
          tree_(update_.tree()),
          fitted_(cloud, tree_->info(), tree_->folder()),
          options_(build_options(options, tree_->info().sampling)),
          work_(update_.scratch(), options_.memory_bytes, options_.chunk_points, options_.threads, options_.progress)
    {
        part_options_.sampling = options_.sampling;
        part_options_.part = static_cast<std::uint32_t>(tree_->part_roots().size());
        part_options_.generation = update_.generation();
        check_systems(options.ignore_crs);
    }

    AppendReport run()
    {
        AnyBins bins = partition(fitted_, work_, found_, &tree_->info());
        report_.points_added = found_.observed.points;
        const std::uint64_t left_out = cloud_.info().points_left_out;
        report_.points_skipped = fitted_.points_skipped() + left_out;
        // Points without a finite position are left out by the reader for integers, and by the partition for doubles.
        report_.outcome.points_in = found_.points_in + left_out + (tree_->info().wide ? 0 : fitted_.points_skipped());
        // Only now: readers add notes while they read.
        report_.skipped = cloud_.info().skipped;
        report_.notes = cloud_.info().notes;
        report_.notes.insert(report_.notes.end(), system_notes_.begin(), system_notes_.end());
        report_.notes.insert(report_.notes.end(), fitted_.info().notes.begin(), fitted_.info().notes.end());
        if (fitted_.points_skipped())
            report_.notes.push_back(points_text(fitted_.points_skipped()) + " without a finite position left out");
        if (report_.points_added + report_.points_skipped != report_.outcome.points_in)
            throw Error(ErrorCode::corrupt, update_.folder(),
                        grouped(report_.outcome.points_in) + " points were read, " + grouped(report_.points_added) +
                            " are to be added; this is a defect of the program");
        if (report_.points_added)
            std::visit([this](auto& of) { add(of); }, bins);
        else
            report_.outcome.points_out = tree_->info().points;
        report_.outcome.error = std::max(report_.outcome.error, tree_->info().position_error);
        report_.outcome.error_meaning = "largest position error, source units";
        report_.outcome.seconds = work_.watch.seconds();
        return std::move(report_);
    }

private:
    void check_systems(bool ignore_differences)
    {
        SystemCheck check(ignore_differences);
        FileInfo of_tree;
        of_tree.schema = tree_->info().schema;
        of_tree.metadata = tree_->info().metadata;
        check.add(of_tree, update_.folder());
        const bool tree_has_system = check.system().has_value();
        const std::string name = sources_.empty() ? "the new points" : sources_[0];
        const std::string more = sources_.size() > 1 ? " and " + grouped(sources_.size() - 1) + " more" : std::string();
        for (const std::string& note : check.add(cloud_.info(), name + more))
            system_notes_.push_back(name + more + ": " + note);
        if (!check.system()) return;
        if (!tree_has_system) {
            takes_system_ = true;
            system_notes_.push_back("the tree states no coordinate system; it takes over that of the new points, " +
                                    describe(*check.system()));
        } else if (check.is_without_system()) {
            system_notes_.push_back("the new points state no coordinate system; it is taken to be that of the tree, " +
                                    describe(*check.system()));
        }
    }

    template <class Coord>
    void add(Bins<Coord>& bins)
    {
        const auto old_files = static_cast<std::uint32_t>(tree_->data_files().size());
        DataFiles files(update_.folder(), work_.folder, old_files);
        DraftStore drafts;
        std::optional<GivenLevels<Coord>> given;
        if (tree_->info().points) given = given_levels<Coord>(tree_);
        Checkpoints none;  // an interrupted update is redone
        const Part part = make_part(bins, work_, found_, part_options_, none, drafts, files, std::move(given));
        files.finish();
        update_.adopt(files.bytes());

        std::vector<PartNode> nodes = part_nodes(*tree_);
        const std::size_t before = nodes.size();
        add_drafts(part.root, nodes);
        report_.nodes_added = nodes.size() - before;
        commit(join_parts(nodes, part.spacings, tree_->info().grid.scale), part.spacings);
    }

    // Replaces blocks that could not be decoded.
    void take_system(std::vector<Metadata>& metadata) const
    {
        metadata.erase(std::remove_if(metadata.begin(), metadata.end(), is_crs_block), metadata.end());
        for (const Metadata& block : cloud_.info().metadata)
            if (is_crs_block(block)) metadata.push_back(block);
    }

    void add_drafts(const Draft* draft, std::vector<PartNode>& nodes) const
    {
        if (!draft) return;
        PartNode node;
        node.part = part_options_.part;
        node.path = draft->path;
        node.points = draft->points;
        node.first_level = draft->first_level;
        node.level_points = draft->level_points;
        node.spacing = draft->spacing;
        if (draft->points) node.box = draft->box;
        node.extent = draft->extent;
        nodes.push_back(std::move(node));
        for (const Draft* child : draft->children) add_drafts(child, nodes);
    }

    void commit(NodeVector joined, const std::vector<double>& spacings)
    {
        work_.watch.report("Writing the index", 0.99);
        TreeInfo info = tree_->info();
        Observed all;
        all.points = info.points;
        all.hash = info.content_hash;
        all.extremes = info.extremes;
        all.position_error = info.position_error;
        found_.observed.position_error = fitted_.position_error();
        all.merge(found_.observed);
        const std::uint64_t stored = joined.nodes.empty() ? 0 : joined.nodes[0].subtree_points;
        if (stored != all.points)
            throw Error(ErrorCode::corrupt, update_.folder(),
                        grouped(all.points) + " points were expected, " + grouped(stored) +
                            " were stored; this is a defect of the program");
        info.points = all.points;
        info.content_hash = all.hash;
        info.extremes = all.extremes;
        info.position_error = all.position_error;
        if (const SourceRounding rounding(info); rounding.has_decimals() && !fitted_.keeps_decimals()) {
            set_decimals(info.metadata, {no_decimals, no_decimals, no_decimals});
            info.position_error = std::max(info.position_error, largest_magnitude(info.grid.scale) / 2);
        }
        info.points_skipped += report_.points_skipped;
        info.box = joined.nodes[0].box;
        info.spacings = spacings;
        info.levels = static_cast<std::uint16_t>(info.spacings.size());
        // A tree of floats returns floats, to which doubles must not be rounded.
        if (info.position_type == ScalarType::f32 && cloud_.info().position_type != ScalarType::f32)
            info.position_type = ScalarType::f64;
        if (takes_system_) take_system(info.metadata);
        info.sources.insert(info.sources.end(), sources_.begin(), sources_.end());
        report_.outcome.points_out = info.points;
        report_.outcome.error = info.position_error;
        for (const NodeId root : joined.part_roots) report_.parts += root != no_node;
        work_.watch.report("Done", 1);  // the last chance to cancel
        run_last_step(report_.outcome, [&] { update_.commit(std::move(info), std::move(joined)); });
        report_.bytes_written = update_.bytes_written();
    }

    PointReader& cloud_;
    const std::vector<std::string>& sources_;
    TreeUpdate update_;
    const std::shared_ptr<const Tree> tree_;
    FittedReader fitted_;
    const BuildOptions options_;
    Workspace work_;
    PartOptions part_options_;
    Ingested found_;
    std::vector<std::string> system_notes_;
    bool takes_system_ = false;  // from the new points
    AppendReport report_;
};

}  // namespace

AppendReport append_points(const fs::path& tree, PointReader& cloud, const std::vector<std::string>& sources,
                           const AppendOptions& options)
{
    try {
        AppendReport report = Append(tree, cloud, sources, options).run();
        if (report.points_added) warn_of_scratch(tree, report.outcome);
        return report;
    } catch (const fs::filesystem_error& error) {
        throw Error::from_errno(error.code().value(), error.path1(), "working in the folder");
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::io, tree, "the system has no memory left", "lower the memory of the operation");
    }
}

}  // namespace pcm
