#include "plugin/panels/tool_dock.h"

#include "plugin/scene/scene_view.h"

#include <QAction>
#include <QCoreApplication>
#include <QDockWidget>
#include <QKeyEvent>
#include <QLineEdit>
#include <QMainWindow>
#include <QPointer>
#include <QScrollArea>
#include <QScrollBar>

#include <algorithm>

namespace pcm::host {

namespace {

constexpr int usual_width = 300, least_width = 200;  // pixels
constexpr int most_share = 3;  // a panel begins with at most this fraction, one third, of the window's width

// Keys that the view's tool takes, pressed in its panel: a click into the panel takes the focus from the view.
class PanelKeys : public QObject {
public:
    explicit PanelKeys(QDockWidget& dock) : QObject(&dock)
    {
        setObjectName("PointCloudPanelKeys");
        qApp->installEventFilter(this);  // fields of tables come and go
    }
    void set_view(QWidget& view) { view_ = &view; }

protected:
    bool eventFilter(QObject* receiver, QEvent* event) override
    {
        const bool is_key = event->type() == QEvent::ShortcutOverride || event->type() == QEvent::KeyPress;
        if (!is_key || !view_) return false;
        const auto* key = static_cast<QKeyEvent*>(event);
        if (!key->matches(QKeySequence::Undo) && !key->matches(QKeySequence::Redo)) return false;
        auto* const widget = qobject_cast<QWidget*>(receiver);
        if (!widget || !static_cast<QWidget*>(parent())->isAncestorOf(widget)) return false;
        const auto* const field = qobject_cast<QLineEdit*>(widget);
        const bool is_typing =
            field && (key->matches(QKeySequence::Undo) ? field->isUndoAvailable() : field->isRedoAvailable());
        if (is_typing) return false;
        event->accept();
        if (event->type() == QEvent::ShortcutOverride) return true;  // the key itself follows
        QKeyEvent copy(*key);
        QCoreApplication::sendEvent(view_, &copy);
        return true;
    }

private:
    QPointer<QWidget> view_;
};

}  // namespace

void show_dock(SceneView& view, QDockWidget& dock)
{
    QMainWindow* const window = view.window();
    if (!window) return;
    auto* keys = static_cast<PanelKeys*>(dock.findChild<QObject*>("PointCloudPanelKeys", Qt::FindDirectChildrenOnly));
    if (!keys) keys = new PanelKeys(dock);
    keys->set_view(view.widget());
    const bool is_new = window->dockWidgetArea(&dock) == Qt::NoDockWidgetArea;
    auto* const settings = window->findChild<QDockWidget*>("PointCloudDock");
    const bool is_alone = !settings || settings->isHidden();
    if (is_new) {
        window->addDockWidget(Qt::LeftDockWidgetArea, &dock);
        if (!is_alone) window->tabifyDockWidget(settings, &dock);
    }
    dock.toggleViewAction()->setText("Panel of " + dock.windowTitle());  // the tool has the plain name
    dock.show();
    dock.raise();
    if (is_new && !dock.isFloating())
        window->resizeDocks({&dock}, {std::max(least_width, std::min(usual_width, window->width() / most_share))},
                            Qt::Horizontal);
}

void fill_dock(QDockWidget& dock, QWidget* form)
{
    auto* scroll = new QScrollArea;
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setWidget(form);
    const int wanted = form->minimumSizeHint().width() + scroll->verticalScrollBar()->sizeHint().width();
    scroll->setMinimumWidth(std::clamp(wanted, least_width, usual_width));
    dock.setWidget(scroll);
}

void keep_place(QWidget& widget)
{
    QSizePolicy policy = widget.sizePolicy();
    policy.setRetainSizeWhenHidden(true);
    widget.setSizePolicy(policy);
}

}  // namespace pcm::host
