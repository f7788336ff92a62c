// Finds points on a thread of its own, so that the window stays usable. GUI thread.
#pragma once

#include "pcm/point_cloud.h"
#include "pcm/query/point_set.h"

#include <QObject>
#include <QString>
#include <QTimer>

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace pcm::host {

// For one layer. The members are made in the GUI thread; `choose` is called on the worker.
struct SelectionTask {
    int mesh_id = -1;
    std::shared_ptr<PointCloud> cloud;
    Query shown;                             // what the view shows of the cloud
    std::shared_ptr<const PointSet> before;  // null: nothing was selected
    SetOperation operation = SetOperation::replace;
    // The points that are combined with the former ones; `shown` has the progress function, too.
    std::function<PointSet(PointCloud& cloud, const Query& shown)> choose;
};

struct SelectionResult {
    int mesh_id = -1;
    std::shared_ptr<const PointSet> points;  // null: nothing is selected
};

// One job at a time. Destroying it cancels it and waits for the worker's next call of the progress function.
class SelectionJob : public QObject {
    Q_OBJECT

public:
    // What came of it: the sets of all layers, or why there are none (also Error(cancelled)).
    using Done = std::function<void(std::vector<SelectionResult> results, std::exception_ptr failure)>;

    SelectionJob();
    ~SelectionJob() override;

    bool is_running() const { return thread_.joinable(); }
    // Throws Error(invalid_argument) while a job is running. `done` is called in the GUI thread, never at once.
    void start(std::vector<SelectionTask> tasks, Done done);
    void cancel() { cancelled_ = true; }

signals:
    void progressed(double fraction, const QString& stage);

private:
    void work();
    void look();

    std::vector<SelectionTask> tasks_;
    Done done_;
    std::thread thread_;
    QTimer timer_;  // while the worker runs
    std::atomic<bool> cancelled_{false}, finished_{false};
    std::atomic<double> fraction_{0};
    std::mutex mutex_;  // of stage_
    std::string stage_;
    std::vector<SelectionResult> results_;  // of the worker until it has finished
    std::exception_ptr failure_;
};

}  // namespace pcm::host
