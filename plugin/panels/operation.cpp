#include "plugin/panels/operation.h"

#include "pcm/system/error.h"

#include <QApplication>
#include <QCoreApplication>
#include <QEvent>
#include <QKeyEvent>
#include <QMessageBox>
#include <QWidget>

#include <algorithm>
#include <csignal>
#include <string>

namespace pcm::host {

namespace {

Operation* current = nullptr;

std::string time_left(double seconds)
{
    if (seconds < 0) return {};
    const auto whole = static_cast<long>(seconds + 0.5);
    return whole >= 90 ? ", " + std::to_string((whole + 30) / 60) + " min left"
                       : ", " + std::to_string(whole) + " s left";
}

}  // namespace

Operation::Operation(ProgressCallback* callback) : callback_(callback)
{
    refuse_second();
    current = this;
    since_events_.start();
    if (QCoreApplication* const application = QCoreApplication::instance()) application->installEventFilter(this);
    ignore_file_size_signal();
}

Operation::~Operation()
{
    if (signal_ignored_) std::signal(SIGXFSZ, SIG_DFL);
    if (QCoreApplication* const application = QCoreApplication::instance()) application->removeEventFilter(this);
    current = nullptr;
}

// Its default ends the process; ignored, the write fails with an error. A handler of the host's stays.
void Operation::ignore_file_size_signal()
{
    struct sigaction action {};
    if (sigaction(SIGXFSZ, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) return;
    signal_ignored_ = std::signal(SIGXFSZ, SIG_IGN) != SIG_ERR;
}

void Operation::refuse_second()
{
    if (current)
        throw Error(ErrorCode::invalid_argument, {}, "another point cloud is being read, built or changed",
                    "wait until it is finished, or press Esc to cancel it");
}

ProgressFunction Operation::progress()
{
    return [this](const ProgressUpdate& update) { return report(update); };
}

bool Operation::report(const ProgressUpdate& update)
{
    // meshlabserver has no window and prints each text on a line of its own.
    const QWidgetList windows = QApplication::topLevelWidgets();  // the active one may be another program's
    const bool window = std::any_of(windows.begin(), windows.end(), [](const QWidget* w) { return w->isVisible(); });
    const bool done = update.fraction >= 1;  // nothing is left to wait for or to cancel
    const std::string text = std::string(update.stage) + (done ? std::string() : time_left(update.seconds_left)) +
                             (window ? done ? "" : " (Esc cancels)" : "\n");
    if (callback_) callback_(static_cast<int>(std::clamp(update.fraction, 0.0, 1.0) * 100), text.c_str());
    // MeshLab's callback processes events only when the percentage changes, which may take minutes.
    if (QCoreApplication::instance() && since_events_.elapsed() > 200) {
        QCoreApplication::processEvents(QEventLoop::AllEvents, 50);
        since_events_.start();
    }
    return !cancelled_;
}

bool Operation::ask(QWidget* window, const std::string& question)
{
    asking_ = true;
    const auto answer = QMessageBox::warning(window, "Point cloud", QString::fromStdString(question),
                                             QMessageBox::Yes | QMessageBox::No, QMessageBox::No);
    asking_ = false;
    return answer == QMessageBox::Yes;
}

bool Operation::eventFilter(QObject* receiver, QEvent* event)
{
    // The dialog is modal: Qt itself keeps input from the other windows.
    if (asking_) return QObject::eventFilter(receiver, event);
    switch (event->type()) {
        case QEvent::KeyPress:
            if (static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) cancelled_ = true;
            return true;
        case QEvent::Close:
            event->ignore();  // an accepted event would close the window
            return true;
        case QEvent::KeyRelease:
        case QEvent::Shortcut:
        case QEvent::ShortcutOverride:
        case QEvent::MouseButtonPress:
        case QEvent::MouseButtonRelease:
        case QEvent::MouseButtonDblClick:
        case QEvent::Wheel:
        case QEvent::ContextMenu:
        case QEvent::Drop:
        case QEvent::DragEnter:
        case QEvent::TouchBegin:
        case QEvent::TabletPress:
            return true;
        default:
            return QObject::eventFilter(receiver, event);
    }
}

}  // namespace pcm::host
