#include "plugin/scene/worker.h"

#include "pcm/system/error.h"

#include <utility>

namespace pcm::host {

namespace {

constexpr int look_ms = 30;

}  // namespace

Worker::Worker(const char* busy) : busy_(busy)
{
    timer_.setInterval(look_ms);
    connect(&timer_, &QTimer::timeout, this, &Worker::look);
}

Worker::~Worker()
{
    cancelled_ = true;
    if (thread_.joinable()) thread_.join();
}

void Worker::start(Work work, Done done)
{
    if (is_running()) throw Error(ErrorCode::invalid_argument, {}, busy_, "wait until it is done, or press Esc");
    done_ = std::move(done);
    failure_ = nullptr;
    cancelled_ = finished_ = false;
    fraction_ = 0;
    stage_.clear();
    thread_ = std::thread([this, work = std::move(work)] {
        try {
            work([this](const ProgressUpdate& update) {
                fraction_ = update.fraction;
                const std::lock_guard<std::mutex> lock(mutex_);
                stage_ = update.stage;
                return !cancelled_;
            });
        } catch (...) {
            failure_ = std::current_exception();
        }
        finished_ = true;
    });
    timer_.start();
}

void Worker::look()
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
    const Done done = std::exchange(done_, {});
    const auto failure = std::exchange(failure_, nullptr);
    if (done) done(failure);
}

}  // namespace pcm::host
