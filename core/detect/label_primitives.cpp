#include "pcm/cache/l2_cache.h"
#include "pcm/detect/detect.h"
#include "pcm/detect/point_labels.h"
#include "pcm/filter/result_attributes.h"
#include "pcm/system/error.h"
#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/update/tree_changes.h"

#include <atomic>

namespace pcm {
namespace {

constexpr const char* stage = "Writing the labels";

// A copy has another name; everything else is as when the primitives were detected.
void require_unchanged(const Tree& then, const Tree& now)
{
    if (then.info().generation == now.info().generation && then.info().content_hash == now.info().content_hash &&
        then.info().points == now.info().points && then.nodes().size() == now.nodes().size())
        return;
    throw Error(ErrorCode::invalid_argument, then.folder(), "the tree was changed since its primitives were detected",
                "detect them again");
}

void write(L2Cache& cache, std::size_t place, const PointLabels& labels, const LabelOptions& options, Watch& watch,
           Outcome& outcome)
{
    std::vector<NodeId> nodes;
    for (NodeId id = 0; id < cache.tree().nodes().size(); ++id)
        if (cache.tree().node(id).points > 0) nodes.push_back(id);
    std::atomic<std::uint64_t> changed{0};
    const auto change = [&](std::size_t i) {
        ColumnSet columns;
        columns.positions = false;
        columns.attributes.set(place);
        const std::vector<std::uint32_t> wanted = labels.get(nodes[i]);
        L2Cache::Edit edit = cache.edit(nodes[i], columns);
        const auto* const before = edit.chunk().attributes[place]->as<std::uint32_t>();
        std::uint64_t values = 0;
        for (std::size_t k = 0; k < wanted.size(); ++k) values += before[k] != wanted[k];
        if (values == 0) return;
        std::copy(wanted.begin(), wanted.end(), edit.column(place).as<std::uint32_t>());
        edit.mark_written();
        changed += values;
    };
    for_each_index(nodes.size(), thread_count(options.threads), change, [&](std::size_t begun) {
        watch.report(stage, 0.97 * static_cast<double>(begun) / static_cast<double>(nodes.size() + 1));
    });
    outcome.points_in = cache.tree().info().points;
    outcome.points_out = changed;
}

}  // namespace

void check_label_attribute(const Tree& tree, const LabelOptions& options)
{
    check_may_write(tree, primitive_attribute(options.attribute), options.overwrite);
}

LabelReport label_primitives(const std::shared_ptr<const Tree>& tree, const DetectReport& found,
                             const LabelOptions& options)
{
    Watch watch(options.progress);
    watch.report(stage, 0, true);
    if (!found.labels)
        throw Error(ErrorCode::invalid_argument, tree->folder(), "there are no labels: nothing was detected",
                    "detect primitives first");
    check_label_attribute(*tree, options);
    UpdateTarget target(tree->folder(), options.target);
    LabelReport report = target.update([&](const std::filesystem::path& folder) {
        LabelReport written;
        const auto changes = std::make_shared<TreeChanges>(folder);
        require_unchanged(*tree, *changes->tree());
        const std::size_t place = place_for(*changes, primitive_attribute(options.attribute));
        L2Options capacity;
        capacity.capacity_bytes = options.memory_bytes;
        L2Cache cache(changes, capacity);
        try {
            write(cache, place, *found.labels, options, watch, written.outcome);
            watch.report(stage, 0.98, true);  // the last chance to cancel
            run_last_step(written.outcome, [&] { cache.close(); });
        } catch (...) {
            cache.abandon();
            throw;
        }
        return written;
    });
    report.tree = target.path();
    report.outcome.seconds = watch.seconds();
    watch.finish("Done");
    return report;
}

}  // namespace pcm
