#include "plugin/tools/view_tool.h"

#include "plugin/scene/scene_bounds.h"
#include "plugin/scene/text.h"

#include <QKeyEvent>
#include <QWidget>

namespace pcm::host {

bool ViewTool::take_view(SceneView& view)
{
    view_ = &view;
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
    const bool works = view_ && receiver == &view_->widget() && !view_->is_suspended();
    return works && event->type() == QEvent::ShortcutOverride ? static_cast<QKeyEvent*>(event) : nullptr;
}

void ViewTool::say(const QString& text)
{
    say_in_panel(text);
    if (view_ && !text.isEmpty()) view_->scene().log(LogLevel::system, QString("%1: %2").arg(name_, text));
}

}  // namespace pcm::host
