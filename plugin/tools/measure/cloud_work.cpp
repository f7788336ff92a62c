#include "plugin/tools/measure/cloud_work.h"

#include "pcm/system/error.h"
#include "plugin/scene/text.h"

namespace pcm::host {

CloudWork::~CloudWork()
{
    cancelled_ = true;
    if (thread_.joinable()) thread_.join();
}

void CloudWork::start(const std::function<Result(const ProgressFunction& progress)>& work)
{
    if (running_)
        throw Error(ErrorCode::invalid_argument, {}, "another profile or volume is being computed",
                    "Wait for its end, or press Esc.");
    if (thread_.joinable()) thread_.join();
    cancelled_ = false;
    running_ = true;
    // Calls that are queued when this object is destroyed are dropped by Qt.
    thread_ = std::thread([this, work] {
        Result result;
        QString error;
        try {
            result = work([this](const ProgressUpdate& update) {
                const QString stage = QString::fromUtf8(update.stage.data(), static_cast<int>(update.stage.size()));
                QMetaObject::invokeMethod(
                    this, [this, stage, fraction = update.fraction] { emit progressed(stage, fraction); },
                    Qt::QueuedConnection);
                return !cancelled_;
            });
        } catch (...) {
            error = QString::fromStdString(current_error());
        }
        QMetaObject::invokeMethod(
            this, [this, result, error] { finish(result, error); }, Qt::QueuedConnection);
    });
}

void CloudWork::finish(const Result& result, const QString& error)
{
    thread_.join();
    running_ = false;
    QString problem = error;
    if (cancelled_) {
        problem.clear();
    } else if (result) {
        try {
            result();
        } catch (...) {
            problem = QString::fromStdString(current_error());
        }
    }
    emit ended(problem);
}

}  // namespace pcm::host
