#include "plugin/panels/cancelled.h"

#include "pcm/system/error.h"

#include <QApplication>
#include <QMessageBox>
#include <QTimer>

namespace pcm::host {

namespace {

constexpr int most_tries = 50;
constexpr int next_try_ms = 10;

void change_box(const QString& text, int tries)
{
    auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
    if (!box) {
        if (tries < most_tries) QTimer::singleShot(next_try_ms, qApp, [text, tries] { change_box(text, tries + 1); });
        return;
    }
    box->setWindowTitle("Cancelled");
    box->setIcon(QMessageBox::Information);
    box->setText(text);
    box->setInformativeText({});
}

}  // namespace

std::optional<QString> cancelled_text(const QString& what)
{
    try {
        throw;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::cancelled) return std::nullopt;
        QString reason = QString::fromStdString(error.what());
        const QString path = QString::fromStdString(error.path().string()) + ": ";
        if (reason.startsWith(path)) reason.remove(0, path.size());
        return what + " was cancelled" + (reason == "cancelled" ? "." : ": " + reason + ".");
    } catch (...) {
        return std::nullopt;
    }
}

void say_cancelled(const QString& text)
{
    if (!QApplication::topLevelWidgets().isEmpty()) QTimer::singleShot(0, qApp, [text] { change_box(text, 1); });
}

}  // namespace pcm::host
