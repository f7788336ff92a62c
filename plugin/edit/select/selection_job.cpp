#include "plugin/edit/select/selection_job.h"

#include "pcm/system/error.h"

#include <utility>

namespace pcm::host {

namespace {

constexpr int look_ms = 30;

}  // namespace

SelectionJob::SelectionJob()
{
    timer_.setInterval(look_ms);
    connect(&timer_, &QTimer::timeout, this, &SelectionJob::look);
}

SelectionJob::~SelectionJob()
{
    cancelled_ = true;
    if (thread_.joinable()) thread_.join();
}

void SelectionJob::start(std::vector<SelectionTask> tasks, Done done)
{
    if (is_running())
        throw Error(ErrorCode::invalid_argument, {}, "points are being selected",
                    "wait until it is done, or press Esc");
    tasks_ = std::move(tasks);
    done_ = std::move(done);
    results_.clear();
    failure_ = nullptr;
    cancelled_ = finished_ = false;
    fraction_ = 0;
    stage_.clear();
    thread_ = std::thread([this] { work(); });
    timer_.start();
}

void SelectionJob::work()
{
    try {
        for (std::size_t i = 0; i < tasks_.size(); ++i) {
            SelectionTask& task = tasks_[i];
            task.shown.progress = [&, i](const ProgressUpdate& update) {
                fraction_ = (static_cast<double>(i) + update.fraction) / static_cast<double>(tasks_.size());
                const std::lock_guard<std::mutex> lock(mutex_);
                stage_ = update.stage;
                return !cancelled_;
            };
            PointSet chosen = task.choose(*task.cloud, task.shown);
            if (task.operation != SetOperation::replace) {
                PointSet combined = task.before ? *task.before : PointSet(chosen.shared_tree());
                combined.combine(task.operation, chosen);
                chosen = std::move(combined);
            }
            if (cancelled_) throw Error(ErrorCode::cancelled, {}, "the selection was cancelled");
            results_.push_back(
                {task.mesh_id, chosen.empty() ? nullptr : std::make_shared<const PointSet>(std::move(chosen))});
        }
    } catch (...) {
        failure_ = std::current_exception();
        results_.clear();
    }
    finished_ = true;
}

void SelectionJob::look()
{
    if (!finished_) {
        QString stage;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            stage = QString::fromStdString(stage_);
        }
        emit progressed(fraction_, stage);
        return;
    }
    timer_.stop();
    thread_.join();
    tasks_.clear();
    const Done done = std::exchange(done_, {});
    const auto failure = std::exchange(failure_, nullptr);
    auto results = std::exchange(results_, {});
    if (done) done(std::move(results), failure);
}

}  // namespace pcm::host
