#include "plugin/render/clouds/clouds_dock.h"

#include "plugin/host/bookmarks.h"
#include "plugin/host/registry.h"
#include "plugin/render/clouds/bookmark_list.h"
#include "plugin/render/clouds/layer_list.h"
#include "plugin/render/clouds/move_fields.h"

#include <meshlab/glarea.h>

#include <QAction>
#include <QLabel>
#include <QMainWindow>
#include <QMdiArea>
#include <QMdiSubWindow>
#include <QMenu>
#include <QMenuBar>
#include <QScrollArea>
#include <QTimer>
#include <QVBoxLayout>

namespace pcm::host {

namespace {

const char* const object_name = "PointCloudsDock";
constexpr int look_again_ms = 250;  // MeshLab signals no change of visibility or of the current view

// The view of the window's current project that has the focus, or the first one.
GLArea* current_view(const QMainWindow& window)
{
    const auto* area = window.findChild<QMdiArea*>();
    QMdiSubWindow* const project = area ? area->currentSubWindow() : nullptr;
    if (!project) return nullptr;
    GLArea* first = nullptr;
    for (QWidget* widget : project->findChildren<QWidget*>()) {
        if (!widget->inherits("GLArea")) continue;
        auto* view = static_cast<GLArea*>(widget);
        if (view->hasFocus()) return view;
        if (!first) first = view;
    }
    return first;
}

// Does not ask for more width than the panel of settings, beside which it stands: MeshLab refuses to split narrow
// views.
class NarrowScrollArea : public QScrollArea {
public:
    QSize sizeHint() const override { return {200, QScrollArea::sizeHint().height()}; }
};

void add_to_view_menu(QMainWindow& window, QAction* action)
{
    for (QMenu* menu : window.menuBar()->findChildren<QMenu*>(QString(), Qt::FindDirectChildrenOnly))
        if (menu->title().remove('&') == "View") menu->addAction(action);
}

}  // namespace

void CloudsDock::show_for(const GLArea& area)
{
    QMainWindow* const window = window_of(area);
    if (!window || window->findChild<QDockWidget*>(object_name)) return;
    auto* dock = new CloudsDock(window);
    window->addDockWidget(Qt::LeftDockWidgetArea, dock);
    if (auto* settings = window->findChild<QDockWidget*>("PointCloudDock")) {
        dock->setVisible(!settings->isHidden());
        if (!settings->isHidden()) {
            window->tabifyDockWidget(settings, dock);
            settings->raise();
        }
    }
    add_to_view_menu(*window, dock->toggleViewAction());
    connect(dock->toggleViewAction(), &QAction::triggered, dock, [dock](bool shown) {
        if (shown) dock->raise();
    });
}

CloudsDock::CloudsDock(QMainWindow* window) : QDockWidget("Point Clouds", window)
{
    setObjectName(object_name);
    auto* form = new QWidget;
    auto* rows = new QVBoxLayout(form);
    layers_ = new LayerList(form);
    move_ = new MoveFields(form);
    bookmarks_ = new BookmarkList(form);
    rows->addWidget(layers_, 2);
    rows->addWidget(new QLabel("<b>Move the current layer</b>"));
    rows->addWidget(move_);
    rows->addWidget(new QLabel("<b>Camera bookmarks</b>"));
    rows->addWidget(bookmarks_, 1);
    auto* scroll = new NarrowScrollArea;
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setWidget(form);
    setWidget(scroll);
    auto* timer = new QTimer(this);
    connect(timer, &QTimer::timeout, this, &CloudsDock::refresh);
    timer->start(look_again_ms);
    refresh();
}

void CloudsDock::refresh()
{
    GLArea* const view = current_view(*static_cast<QMainWindow*>(parent()));
    MeshDocument* const document = view ? view->md() : nullptr;
    layers_->refresh(document);
    move_->refresh(document);
    bookmarks_->refresh(view);
}

}  // namespace pcm::host
