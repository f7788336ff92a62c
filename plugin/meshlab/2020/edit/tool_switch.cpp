#include "plugin/meshlab/2020/edit/tool_switch.h"

#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/meshlab.h"

#include <QAction>
#include <QApplication>
#include <QMainWindow>
#include <QMdiArea>
#include <QMdiSubWindow>
#include <QToolBar>

namespace pcm::host {

namespace {

const char* const bar_name = "PointCloudToolBar";

// The view that MeshLab's menus are for, and its window; null: there is none.
struct CurrentView {
    QMainWindow* window = nullptr;
    GLArea* view = nullptr;
};

CurrentView current_view()
{
    for (QWidget* top : QApplication::topLevelWidgets()) {
        auto* const window = qobject_cast<QMainWindow*>(top);
        const auto* const projects = window ? window->findChild<QMdiArea*>() : nullptr;
        const QMdiSubWindow* const project = projects ? projects->currentSubWindow() : nullptr;
        if (!project) continue;
        for (QWidget* widget : project->findChildren<QWidget*>()) {
            if (!widget->inherits("GLArea")) continue;
            auto* const view = static_cast<GLArea*>(widget);
            if (view->isCurrent()) return {window, view};
        }
    }
    return {};
}

void end_other(const QAction& wanted)
{
    const auto [window, view] = current_view();
    if (!view || !view->getCurrentEditAction() || view->getCurrentEditAction() == &wanted) return;
    view->suspendedEditor = false;  // MeshLab would start the next tool suspended
    QMetaObject::invokeMethod(window, "endEdit", Qt::DirectConnection);
}

void keep_enabled(QAction& tool)
{
    if (tool.isEnabled()) return;
    const GLArea* const view = current_view().view;
    if (view && const_cast<GLArea*>(view)->getCurrentEditAction()) tool.setEnabled(true);
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
