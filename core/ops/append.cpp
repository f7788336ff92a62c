// The points of files are added to a tree.
#include "pcm/update/append.h"

#include "pcm/convert/open_cloud.h"
#include "pcm/ops/shared/reading_arguments.h"
#include "pcm/ops/shared/target_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

namespace pcm::ops {
namespace {

class Append : public Operation {
public:
    Append()
    {
        target_.declare_tree(arguments_);
        arguments_.add("input", inputs_)
            .as(ValueKind::inputs)
            .positional()
            .required()
            .script("Inputs")
            .label("Input files")
            .help(
                "Files, folders with their sub-folders, or trees to add. Their points must lie on the tree's grid, and "
                "the tree must have all their attributes. Formats: " +
                readable_text());
        target_.declare_copy(arguments_);
        work_.memory = options_.memory_bytes;
        work_.declare(arguments_, least_build_memory);
        chunk_points_argument(arguments_, options_.chunk_points);
        reading_.declare(arguments_);
        reading_.declare_ignore_crs(arguments_);
    }

    Result answer(const Context& context) override
    {
        CloudOptions reading;
        reading.read = reading_.get(work_.threads);
        CloudSources sources({inputs_.begin(), inputs_.end()}, reading);
        if (sources.has(tree_folder_of(target_.tree)))
            throw Error(ErrorCode::invalid_argument, target_.tree,
                        "this tree is among the inputs: its points would be there twice", "name other inputs");
        const std::unique_ptr<PointReader> cloud = sources.open();
        options_.memory_bytes = work_.memory;
        options_.threads = work_.threads;
        options_.ignore_crs = reading.read.ignore_crs;
        options_.progress = context.progress;
        UpdateTarget target(target_.tree, target_.choice(context.face, arguments_));
        const AppendReport report = target.update([&](const std::filesystem::path& folder) {
            return append_points(folder, *cloud, sources.names(), options_);
        });
        Result result;
        target_.describe(result, target.path().string());
        result.input.insert(result.input.end(), inputs_.begin(), inputs_.end());
        result.notes = sources.notes();
        result.notes.insert(result.notes.end(), report.notes.begin(), report.notes.end());
        describe(result, report);
        return result;
    }

private:
    static void describe(Result& result, const AppendReport& report)
    {
        result.outcome = report.outcome;
        result.accuracy = rounded_positions(report.outcome.error);
        result.values["points_added"] = report.points_added;
        result.values["points_skipped"] = report.points_skipped;
        result.values["nodes_added"] = report.nodes_added;
        result.values["bytes_written"] = report.bytes_written;
        result.values["parts"] = report.parts;
        result.values["position_error"] = report.outcome.error;
        put_skipped(result, report.skipped);
        result.print(
            "%s: %s points added in %.1f s (%.2f M points/s), %s nodes, %s; now %s points in %u parts",
            result.output.c_str(), grouped(report.points_added).c_str(), report.outcome.seconds,
            report.outcome.seconds > 0 ? static_cast<double>(report.points_added) / report.outcome.seconds / 1e6 : 0.0,
            grouped(report.nodes_added).c_str(), bytes_text(report.bytes_written).c_str(),
            grouped(report.outcome.points_out).c_str(), report.parts);
    }

    TargetArguments target_;
    std::vector<std::string> inputs_;
    ReadingArguments reading_;
    WorkArguments work_;
    AppendOptions options_;
};

}  // namespace

Row append_row()
{
    return {"append",
            "Append to Point Cloud Tree",
            "Add the points of files to a tree",
            "Adds the points of one or more files to a <b>point cloud tree</b>, either in place or in a copy that "
            "shares the data of the original. Existing points are not rewritten, so the time depends on the number of "
            "new points only. Every level of detail stays as even as before.",
            menu::points,
            "-more.pct",
            with_skipped_keys(
                {{"points_added", "count", "points", "points of the inputs"},
                 {"points_skipped", "count", "points", "without a finite position, or beyond the largest coordinate"},
                 {"nodes_added", "count", "", "chunks written"},
                 {"bytes_written", "count", "bytes", "their size"},
                 {"parts", "count", "", "parts of the tree afterwards"},
                 {"position_error", "number", "source units", "largest position error of the tree"}}),
            make<Append>,
            {},
            only_rounds};
}

}  // namespace pcm::ops
