#include "plugin/panels/clouds/clouds_dock.h"

#include "plugin/panels/clouds/bookmark_list.h"
#include "plugin/panels/clouds/layer_list.h"
#include "plugin/panels/clouds/move_fields.h"
#include "plugin/scene/scene_view.h"

#include <QAction>
#include <QLabel>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QScrollArea>
#include <QTimer>
#include <QVBoxLayout>

#include <utility>

namespace pcm::host {

namespace {

const char* const object_name = "PointCloudsDock";
constexpr int look_again_ms = 250;  // MeshLab signals no change of visibility or of the current view

// Does not request more width than the panel of settings next to it: MeshLab refuses to split narrow
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

void CloudsDock::show_for(const SceneView& view, CurrentView current_view)
{
    QMainWindow* const window = view.window();
    if (!window || window->findChild<QDockWidget*>(object_name)) return;
    auto* dock = new CloudsDock(window, std::move(current_view));
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

CloudsDock::CloudsDock(QMainWindow* window, CurrentView current_view)
    : QDockWidget("Point Clouds", window), current_view_(std::move(current_view))
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
    SceneView* const view = current_view_();
    Scene* const scene = view ? &view->scene() : nullptr;
    layers_->refresh(scene);
    move_->refresh(scene);
    bookmarks_->refresh(view);
}

}  // namespace pcm::host
