#include "plugin/edit/view_tool.h"

#include "plugin/edit/scene_bounds.h"
#include "plugin/host/text.h"

#include <meshlab/glarea.h>

#include <QKeyEvent>

namespace pcm::host {

bool ViewTool::take_view(GLArea& view)
{
    view_ = &view;
    setParent(&view);  // the view does not delete its tools otherwise
    if (!bounds_of_shown(view).empty()) return true;
    say("no layer shows a point cloud");
    view_ = nullptr;
    return false;
}

void ViewTool::guarded(const std::function<void()>& work)
{
    try {
        work();
    } catch (...) {
        say(QString::fromStdString(current_error()));
    }
}

QKeyEvent* ViewTool::shortcut_of(QObject* receiver, QEvent* event) const
{
    const bool works = view_ && receiver == view_ && !view_->suspendedEditor;
    return works && event->type() == QEvent::ShortcutOverride ? static_cast<QKeyEvent*>(event) : nullptr;
}

void ViewTool::say(const QString& text)
{
    say_in_panel(text);
    if (view_ && !text.isEmpty())
        view_->md()->Log.Log(GLLogStream::SYSTEM, qPrintable(QString("%1: %2").arg(name_, text)));
}

}  // namespace pcm::host
