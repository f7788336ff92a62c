// A computation over a cloud that takes longer than a click: on a thread of its own, so that the view is not blocked.
// GUI thread.
#pragma once

#include "pcm/system/progress.h"

#include <QObject>

#include <atomic>
#include <functional>
#include <thread>

namespace pcm::host {

class CloudWork : public QObject {
    Q_OBJECT

public:
    // What is to be done with the result, in the GUI thread.
    using Result = std::function<void()>;

    CloudWork() = default;
    ~CloudWork() override;  // cancels, and waits for the thread

    bool running() const { return running_; }
    // Runs `work` on a thread; it must hold all that it needs and report to the function that it gets, which stops it
    // when it is cancelled. Throws Error(invalid_argument) while another one runs.
    void start(const std::function<Result(const ProgressFunction& progress)>& work);
    void cancel() { cancelled_ = true; }

signals:
    void progressed(const QString& stage, double fraction);
    void ended(const QString& error);  // after the result was used; empty: all went well, or it was cancelled

private:
    void finish(const Result& result, const QString& error);

    std::thread thread_;
    std::atomic<bool> cancelled_{false};
    bool running_ = false;
};

}  // namespace pcm::host
