#include "plugin/panels/window_menu.h"

#include <QAction>
#include <QDesktopServices>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QStandardPaths>
#include <QUrl>

namespace pcm::host {

namespace {

const char* const manual_name = "PointCloudManual";

void open_manual(QMainWindow& window)
{
    const QString page = QStandardPaths::locate(QStandardPaths::GenericDataLocation, "doc/pcmlab/manual/index.html");
    if (page.isEmpty()) {
        QMessageBox::information(
            &window, "Point Clouds",
            "The manual is not installed.\n\nInstall python3-markdown, then, in the folder of the sources:\ncmake "
            "--build "
            "build/release --target manual\nsudo cmake --install build/release --prefix /usr --component manual");
        return;
    }
    if (!QDesktopServices::openUrl(QUrl::fromLocalFile(page)))
        QMessageBox::information(&window, "Point Clouds", "No browser could be started. The manual is\n" + page);
}

}  // namespace

void add_to_menu(QMainWindow& window, const QString& title, QAction* action, bool after_separator)
{
    for (QMenu* menu : window.menuBar()->findChildren<QMenu*>(QString(), Qt::FindDirectChildrenOnly)) {
        if (menu->title().remove('&') != title) continue;
        if (after_separator) menu->addSeparator();
        menu->addAction(action);
        return;
    }
}

void add_manual_to_help(QMainWindow& window)
{
    if (window.findChild<QAction*>(manual_name)) return;
    auto* action = new QAction("Point Clouds", &window);
    action->setObjectName(manual_name);
    action->setToolTip("Opens the manual of the point cloud tools in a browser");
    QObject::connect(action, &QAction::triggered, &window, [&window] { open_manual(window); });
    add_to_menu(window, "Help", action, true);
}

}  // namespace pcm::host
