// A selection in several layers: made in the GUI thread, run on a worker.
#pragma once

#include "pcm/point_cloud.h"
#include "pcm/query/point_set.h"
#include "pcm/system/progress.h"

#include <functional>
#include <memory>
#include <vector>

namespace pcm::host {

// For one layer.
struct SelectionTask {
    int layer_id = -1;
    std::shared_ptr<PointCloud> cloud;
    Query shown;                             // what the view shows of the cloud
    std::shared_ptr<const PointSet> before;  // null: nothing was selected
    SetOperation operation = SetOperation::replace;
    // The points that are combined with the former ones; `shown` has the progress function, too.
    std::function<PointSet(PointCloud& cloud, const Query& shown)> choose;
};

struct SelectionResult {
    int layer_id = -1;
    std::shared_ptr<const PointSet> points;  // null: nothing is selected
};

// Any thread. Throws what choosing throws, and Error(cancelled).
std::vector<SelectionResult> run_tasks(const std::vector<SelectionTask>& tasks, const ProgressFunction& progress);

}  // namespace pcm::host
