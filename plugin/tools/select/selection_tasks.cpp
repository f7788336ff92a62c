#include "plugin/tools/select/selection_tasks.h"

#include "pcm/system/error.h"

#include <utility>

namespace pcm::host {

std::vector<SelectionResult> run_tasks(const std::vector<SelectionTask>& tasks, const ProgressFunction& progress)
{
    std::vector<SelectionResult> results;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        const SelectionTask& task = tasks[i];
        const auto count = static_cast<double>(tasks.size());
        Query shown = task.shown;
        shown.progress = [&, i](ProgressUpdate update) {
            update.fraction = (static_cast<double>(i) + update.fraction) / count;
            return progress(update);
        };
        PointSet chosen = task.choose(*task.cloud, shown);
        if (task.operation != SetOperation::replace) {
            PointSet combined = task.before ? *task.before : PointSet(chosen.shared_tree());
            combined.combine(task.operation, chosen);
            chosen = std::move(combined);
        }
        ProgressUpdate update;
        update.stage = "Selecting points";
        update.fraction = 1;
        if (!shown.progress(update)) throw Error(ErrorCode::cancelled, {}, "the selection was cancelled");
        results.push_back(
            {task.layer_id, chosen.empty() ? nullptr : std::make_shared<const PointSet>(std::move(chosen))});
    }
    return results;
}

}  // namespace pcm::host
