#include "plugin/meshlab/edit/tool_switch.h"

#include "plugin/meshlab/document_scene.h"

#include <QAction>
#include <QApplication>
#include <QMainWindow>
#include <QMdiArea>
#include <QToolBar>

namespace pcm::host {

namespace {

const char* const bar_name = "PointCloudToolBar";

// The view that MeshLab's menus are for; null: there is none.
SceneView* current_view()
{
    for (QWidget* top : QApplication::topLevelWidgets())
        if (const auto* const window = qobject_cast<QMainWindow*>(top))
            if (SceneView* const view = host::current_view(*window))
                for (SceneView* same : view->scene().views())
                    if (same->is_current()) return same;
    return nullptr;
}

void end_other(const QAction& wanted)
{
    SceneView* const view = current_view();
    if (view && view->tool() && view->tool() != &wanted) view->end_tool();
}

void keep_enabled(QAction& tool)
{
    if (tool.isEnabled()) return;
    const SceneView* const view = current_view();
    if (view && view->tool()) tool.setEnabled(true);
}

}  // namespace

void show_tool_bar(const QList<QAction*>& tools)
{
    constexpr int icon_px = 24;
    for (QWidget* top : QApplication::topLevelWidgets()) {
        auto* const window = qobject_cast<QMainWindow*>(top);
        const bool is_meshlab = window && window->findChild<QMdiArea*>();
        if (!is_meshlab || window->findChild<QToolBar*>(bar_name)) continue;
        auto* const bar = new QToolBar("Point Cloud Tools", window);
        bar->setObjectName(bar_name);
        bar->setIconSize({icon_px, icon_px});
        bar->addActions(tools);
        window->addToolBar(Qt::LeftToolBarArea, bar);
    }
}

void make_switchable(QAction& tool)
{
    // Slots are called in the order in which they were connected: this one before MeshLab's.
    QObject::connect(&tool, &QAction::triggered, &tool, [&tool] { end_other(tool); });
    QObject::connect(&tool, &QAction::changed, &tool, [&tool] { keep_enabled(tool); });
}

}  // namespace pcm::host
