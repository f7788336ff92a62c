// A tree is built from files.
#include "pcm/build/build_then.h"
#include "pcm/cluster/team_build.h"
#include "pcm/cluster/team_folder.h"
#include "pcm/ops/shared/attribute_report.h"
#include "pcm/ops/shared/bucket_output.h"
#include "pcm/ops/shared/reading_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/text.h"
#include "pcm/system/url.h"

namespace pcm::ops {
namespace {

class Build : public Operation {
public:
    Build()
    {
        arguments_.add("input", inputs_)
            .as(ValueKind::inputs)
            .positional()
            .required()
            .script("Inputs")
            .label("Input files")
            .help("Files, and folders with their sub-folders, merged into one cloud. Formats: " + readable_text());
        arguments_.add("output", output_)
            .letter('o')
            .as(ValueKind::output_tree)
            .label("Output folder")
            .help(
                "Tree folder to write; or where in a bucket, s3://BUCKET/NAME.pct: it is built next to the first "
                "input, and sent")
            .without("the first input's name with .pct");
        work_.memory = options_.memory_bytes;
        work_.declare(arguments_, least_build_memory);
        chunk_points_argument(arguments_, options_.chunk_points);
        arguments_.add("fast", fast_)
            .label("Fast levels")
            .help(
                "Sample the levels on a grid: about twice as fast, but less evenly spaced. All points are kept in any "
                "case");
        arguments_.add("normals", normals_)
            .between(1, most_neighbours)
            .label("Neighbours of normals")
            .help(
                "Then compute normals and radii of this number of nearest neighbours, e.g. 16: what "
                "perspective-accurate discs are drawn with (the operation normals has more choices)")
            .without("no normals");
        arguments_.add("overwrite", options_.overwrite)
            .label("Overwrite")
            .help("Replace an existing tree of this name. Only a tree is ever replaced");
        arguments_.add("resume", options_.resume)
            .label("Resume")
            .advanced()
            .help("Resuming an interrupted build of these files, and writing checkpoints");
        arguments_.add("checkpoint_seconds", options_.checkpoint_seconds)
            .not_negative()
            .unit("s")
            .label("Time between checkpoints")
            .advanced()
            .help("Time between checkpoints, from which an interrupted build resumes");
        reading_.declare(arguments_);
        reading_.declare_ignore_crs(arguments_);
        arguments_.add("open", open_)
            .only(Face::dialog)  // the command has no layers
            .label("Open when done")
            .help("Add a layer that shows the new tree");
    }

    Result answer(const Context& context) override
    {
        const std::string output = place().string();
        if (context.team && is_url(output))
            throw Error(ErrorCode::unsupported, output, "several processes build trees in folders, not in buckets",
                        "send the tree there afterwards, by 'pcmlab convert'");
        const BucketOutput bucket(output, inputs_, options_.overwrite);
        options_.overwrite = bucket.may_replace();
        const ProgressFunction building = part_of(context.progress, 0, 0.8), sent = part_of(context.progress, 0.8, 1);
        const ProgressFunction& progress = bucket.is_address() ? building : context.progress;
        options_.memory_bytes = work_.memory;
        options_.threads = work_.threads;
        options_.read = reading_.get(work_.threads);
        options_.sampling = fast_ ? Sampling::grid : Sampling::poisson;
        options_.progress = normals_ ? part_of(progress, 0, 0.5) : progress;
        WantedValues wanted;
        wanted.normal = wanted.radius = wanted.confidence = true;
        wanted.radius_neighbours = usual_radius_neighbours;
        NeighbourAttributeReport computed;
        WorkOnTree then;
        if (normals_)
            then = [&](const std::filesystem::path& tree, BuildReport& built) {
                computed = compute_normals(tree, wanted, progress);
                std::vector<std::string>& warnings = computed.outcome.warnings;
                built.outcome.warnings.insert(built.outcome.warnings.end(), warnings.begin(), warnings.end());
                warnings.clear();
            };
        const BuildReport report = build(context, bucket.place(), then);
        bucket.send(sent);
        Result result;
        result.input = inputs_;
        result.output = output;
        result.makes = open_ ? Makes::cloud : Makes::file;
        describe(result, report);
        result.values["normals"] = nullptr;
        if (normals_) add_normals(result, wanted, computed);
        return result;
    }

private:
    // By all processes where there are some; by this one alone also where some had begun.
    BuildReport build(const Context& context, const std::filesystem::path& output, const WorkOnTree& then) const
    {
        const std::vector<std::filesystem::path> inputs(inputs_.begin(), inputs_.end());
        if (context.team) return build_tree_by(*context.team, inputs, output, options_, then);
        if (!options_.resume || !was_begun_by_team(output)) return build_tree_then(inputs, output, options_, then);
        SoloTeam alone;
        return build_tree_by(alone, inputs, output, options_, then);
    }

    // Next to the first input, with the same name, where none is given.
    std::filesystem::path place() const
    {
        if (!output_.empty()) return output_;
        std::filesystem::path output = inputs_[0];
        if (output.filename().empty()) output = output.parent_path();
        return output.replace_extension(tree_extension);
    }

    // The second step: what discs need in addition to the positions.
    NeighbourAttributeReport compute_normals(const std::filesystem::path& tree, const WantedValues& wanted,
                                             const ProgressFunction& progress) const
    {
        NeighbourAttributeOptions options;
        options.wanted = wanted;
        options.neighbours = *normals_;
        options.radius_limit = usual_radius_limit;
        options.memory_bytes = work_.memory;
        options.threads = work_.threads;
        options.progress = part_of(progress, 0.5, 1);
        return compute_neighbour_attributes(tree, options);
    }

    static void describe(Result& result, const BuildReport& report)
    {
        const Outcome& outcome = result.outcome = report.outcome;
        result.accuracy = rounded_positions(outcome.error);
        result.notes = report.notes;
        result.values["points_skipped"] = report.points_skipped;
        put_skipped(result, report.skipped);
        result.values["bytes"] = report.bytes;
        result.values["scratch_bytes"] = report.scratch_bytes;
        result.values["position_error"] = outcome.error;
        result.values["nodes"] = report.nodes;
        result.values["levels"] = report.levels;
        result.print(
            "%s: %s points in %.1f s (%.2f M points/s), %llu nodes on %u levels, %s (%.2f bytes per point)",
            result.output.c_str(), grouped(outcome.points_out).c_str(), outcome.seconds,
            points_per_second(outcome) / 1e6, static_cast<unsigned long long>(report.nodes), report.levels,
            bytes_text(report.bytes).c_str(),
            outcome.points_out ? static_cast<double>(report.bytes) / static_cast<double>(outcome.points_out) : 0.0);
        result.print("scratch files at most %s", bytes_text(report.scratch_bytes).c_str());
    }

    static void add_normals(Result& result, const WantedValues& wanted, const NeighbourAttributeReport& computed)
    {
        Result second;
        second.output = result.output;
        put_attribute_report(second, wanted, computed);
        second.values["points"] = second.outcome.points_out;
        second.values["seconds"] = second.outcome.seconds;
        result.values["normals"] = std::move(second.values);
        result.notes.insert(result.notes.end(), second.notes.begin(), second.notes.end());
        result.lines.insert(result.lines.end(), second.lines.begin(), second.lines.end());
    }

    std::vector<std::string> inputs_;
    std::string output_;
    WorkArguments work_;
    ReadingArguments reading_;
    bool fast_ = false, open_ = true;
    std::optional<std::uint32_t> normals_;
    BuildOptions options_;
};

}  // namespace

Row build_row()
{
    return {"build",
            "Build Point Cloud Tree",
            "Build a point cloud tree from files",
            "Reads one or more point cloud files of any size and writes a <b>point cloud tree</b>: a folder of chunks "
            "at several levels of detail. MeshLab opens it within seconds and draws it without loading all of it into "
            "memory.<br>All points are kept, with all their attributes. The build uses a bounded amount of memory.",
            menu::points,
            nullptr,
            with_skipped_keys(
                {{"points_skipped", "count", "points", "without a finite position, or beyond the largest coordinate"},
                 {"bytes", "count", "bytes", "size of the tree"},
                 {"scratch_bytes", "count", "bytes", "largest size of the temporary files"},
                 {"position_error", "number", "source units", "largest position error"},
                 {"nodes", "count", "", "chunks"},
                 {"levels", "count", "", "levels of detail"},
                 {"normals", "object?", "", "what the operation normals answers; null: none were computed"}}),
            make<Build>,
            {},
            "It takes neither a time limit nor an error target: every point is read and written, and only coordinates "
            "are rounded, by the grid. --fast samples the levels on a grid: they are less even, and every point of the "
            "cloud still has one of a level nearer than its spacing."};
}

}  // namespace pcm::ops
