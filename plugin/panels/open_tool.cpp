#include "plugin/panels/open_tool.h"

#include "plugin/scene/scene_view.h"

#include <QAction>
#include <QMainWindow>
#include <QMenu>
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

void open_tool(Scene& scene, const QString& name)
{
    if (scene.views().empty()) return;
    QTimer::singleShot(tool_wait_ms, &scene, [&scene, name] {
        if (scene.is_busy()) return open_tool(scene, name);
        const auto views = scene.views();
        for (const SceneView* view : views)
            if (view->tool()) return;
        const QMainWindow* const window = views.empty() ? nullptr : views.front()->window();
        QAction* const action = window ? action_of(*window, name) : nullptr;
        if (action && action->isEnabled() && !action->isChecked()) action->trigger();
    });
}

}  // namespace pcm::host
