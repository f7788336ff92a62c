#include "plugin/meshlab/2020/open_tool.h"

#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/meshlab/2020/registry.h"

#include <QAction>
#include <QMainWindow>
#include <QMenu>
#include <QPointer>
#include <QTimer>

namespace pcm::host {

namespace {

constexpr int tool_wait_ms = 20;

// An action of a menu: it belongs to the plugin.
QAction* action_of(const QMainWindow& window, const QString& text)
{
    for (const QMenu* menu : window.findChildren<QMenu*>())
        for (QAction* action : menu->actions())
            if (action->text().remove('&') == text && action->isCheckable()) return action;
    return nullptr;
}

}  // namespace

void open_tool(MeshDocument& document, const QString& name)
{
    if (views_of(document).empty()) return;
    QTimer::singleShot(tool_wait_ms, &document, [alive = QPointer<MeshDocument>(&document), name] {
        if (!alive) return;
        if (alive->isBusy()) return open_tool(*alive, name);
        const auto views = views_of(*alive);
        for (GLArea* view : views)
            if (view->getCurrentEditAction()) return;
        const QMainWindow* const window = views.empty() ? nullptr : window_of(*views.front());
        QAction* const action = window ? action_of(*window, name) : nullptr;
        if (action && action->isEnabled() && !action->isChecked()) action->trigger();
    });
}

}  // namespace pcm::host
