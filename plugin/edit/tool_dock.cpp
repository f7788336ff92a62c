#include "plugin/edit/tool_dock.h"

#include "plugin/host/registry.h"

#include <meshlab/glarea.h>

#include <QAction>
#include <QDockWidget>
#include <QMainWindow>

namespace pcm::host {

void show_dock(const GLArea& view, QDockWidget& dock)
{
    QMainWindow* const window = window_of(view);
    if (!window) return;
    if (window->dockWidgetArea(&dock) == Qt::NoDockWidgetArea) {
        window->addDockWidget(Qt::LeftDockWidgetArea, &dock);
        if (auto* settings = window->findChild<QDockWidget*>("PointCloudDock"))
            if (!settings->isHidden()) window->tabifyDockWidget(settings, &dock);
    }
    dock.toggleViewAction()->setText("Panel of " + dock.windowTitle());  // the tool has the plain name
    dock.show();
    dock.raise();
}

}  // namespace pcm::host
