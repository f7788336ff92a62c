// A tree is rewritten after appending and deleting.
#include "pcm/update/compact.h"

#include "pcm/build/builder.h"
#include "pcm/ops/shared/target_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/text.h"

namespace pcm::ops {
namespace {

class Compact : public Operation {
public:
    Compact()
    {
        target_.declare_tree(arguments_);
        arguments_.add("output", target_.output)
            .letter('o')
            .as(ValueKind::output_tree)
            .label("Output folder")
            .help("Another tree folder to write")
            .without("the tree itself is changed");
        arguments_.add("overwrite", options_.overwrite)
            .label("Overwrite")
            .help("Replace an existing tree of the output's name");
        work_.memory = options_.memory_bytes;
        work_.declare(arguments_, least_build_memory);
        chunk_points_argument(arguments_, options_.chunk_points);
    }

    Result answer(const Context& context) override
    {
        options_.output = target_.output;
        options_.memory_bytes = work_.memory;
        options_.threads = work_.threads;
        options_.progress = context.progress;
        const CompactReport report = compact_tree(target_.tree, options_);
        Result result;
        target_.describe(result, target_.output.empty() ? target_.tree : target_.output);
        result.outcome = report.build.outcome;
        result.accuracy = exact_answer();
        result.values["bytes_before"] = report.bytes_before;
        result.values["bytes"] = report.build.bytes;
        result.values["nodes"] = report.build.nodes;
        result.values["levels"] = report.build.levels;
        result.print("%s: %s points in %.1f s (%.2f M points/s), %llu nodes on %u levels, %s (%s before)",
                     result.output.c_str(), grouped(result.outcome.points_out).c_str(), result.outcome.seconds,
                     points_per_second(result.outcome) / 1e6, static_cast<unsigned long long>(report.build.nodes),
                     report.build.levels, bytes_text(report.build.bytes).c_str(),
                     bytes_text(report.bytes_before).c_str());
        return result;
    }

private:
    TargetArguments target_;
    WorkArguments work_;
    CompactOptions options_;
};

}  // namespace

Row compact_row()
{
    return {"compact",
            "Compact Point Cloud Tree",
            "Rewrite a tree after appending and deleting: smaller, with evenly spaced levels",
            "Rebuilds a <b>point cloud tree</b> from its points: appended parts are merged, the space of deleted "
            "points is freed, and the levels of detail are even again. The old tree stays valid until the new one is "
            "complete.",
            menu::points,
            nullptr,
            {{"bytes_before", "count", "bytes", "size of the tree before"},
             {"bytes", "count", "bytes", "size of the result"},
             {"nodes", "count", "", "chunks of the result"},
             {"levels", "count", "", "levels of detail of the result"}},
            make<Compact>,
            {},
            always_exact};
}

}  // namespace pcm::ops
