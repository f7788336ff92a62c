// Work on a thread of its own, so that the window stays usable. GUI thread.
#pragma once

#include "pcm/system/progress.h"

#include <QObject>
#include <QString>
#include <QTimer>

#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace pcm::host {

// One piece of work at a time. Destroying the worker cancels it and waits until it has ended.
class Worker : public QObject {
    Q_OBJECT

public:
    // On the thread; it passes the progress function on, through which it is cancelled.
    using Work = std::function<void(const ProgressFunction& progress)>;
    // In the GUI thread, never at once: what the work has thrown, or null.
    using Done = std::function<void(std::exception_ptr failure)>;

    // `busy` is what the error says that a second start() throws: "points are being selected".
    explicit Worker(const char* busy);
    ~Worker() override;

    bool is_running() const { return thread_.joinable(); }
    // Throws Error(invalid_argument) while it works.
    void start(Work work, Done done);
    // Its failure is Error(cancelled) then, unless it ends before it notices.
    void cancel() { cancelled_ = true; }
    // Results of the last work.
    bool is_cancelled() const { return cancelled_; }

signals:
    void progressed(double fraction, const QString& stage);

private:
    void look();

    const char* const busy_;
    Done done_;
    std::thread thread_;
    QTimer timer_;  // while it works
    std::atomic<bool> cancelled_{false}, finished_{false};
    std::atomic<double> fraction_{0};
    std::mutex mutex_;  // guards stage_
    std::string stage_;
    std::exception_ptr failure_;  // belongs to the thread until it has finished
};

}  // namespace pcm::host
