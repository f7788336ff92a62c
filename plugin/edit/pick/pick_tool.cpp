#include "plugin/edit/pick/pick_tool.h"

#include "pcm/system/text.h"
#include "plugin/edit/tool_dock.h"
#include "plugin/edit/view_events.h"
#include "plugin/host/annotations.h"
#include "plugin/host/text.h"

#include <meshlab/glarea.h>

#include <QClipboard>
#include <QGuiApplication>
#include <QKeyEvent>
#include <QMainWindow>
#include <QVariantMap>

namespace pcm::host {

namespace {

const char* const owner = "pick";

}  // namespace

PickTool::~PickTool() { delete panel_; }

bool PickTool::StartEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext*)
{
    if (!take_view(*view)) return false;
    if (!panel_) {
        panel_ = new PickPanel(window_of(*view));
        connect(panel_, &PickPanel::copy_asked, this, &PickTool::copy);
    }
    show_dock(*view, *panel_);
    context_ = std::make_unique<QObject>();
    view->installEventFilter(this);
    view->setFocus();
    view->setCursor(Qt::CrossCursor);
    keep_unmodified(document);
    if (shown_) show_point(true);
    say("click a point in the view; Ctrl+C copies what is shown; dragging and the wheel move the camera, Esc switches "
        "between this tool and the trackball");
    return true;
}

void PickTool::EndEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext*)
{
    if (view != view_) return;
    context_.reset();
    forget_press();
    view->removeEventFilter(this);
    Annotations::of(document).set(owner, {});
    if (panel_) panel_->hide();
    view_ = nullptr;
}

void PickTool::click(const QPoint& place, Qt::KeyboardModifiers)
{
    if (panel_) panel_->say("searching ...");
    pick(*view_, place, *context_, [this](const PickAnswer& answer) { guarded([&] { take(answer); }); });
}

void PickTool::take(const PickAnswer& answer)
{
    if (!view_) return;
    if (answer.point) {
        const MeshModel* const layer = view_->md()->getMesh(answer.point->mesh_id);
        shown_ = answer.point;
        lines_ = lines_of(*answer.point, layer ? layer->label() : QString());
        show_point(answer.final);
        if (answer.final)
            say(QString("%1, %2").arg(QString::fromStdString(exact(answer.point->position)), lines_.front().value));
    } else {
        say(answer.message);
    }
    publish(answer);
}

void PickTool::show_point(bool complete)
{
    Annotation mark;
    mark.marks = {shown_->shown_at};
    mark.on_top = true;
    Annotations::of(*view_->md()).set(owner, {mark});
    if (panel_) panel_->show_point(lines_, complete);
}

void PickTool::copy()
{
    if (lines_.empty()) return say("nothing to copy: no point was picked");
    QGuiApplication::clipboard()->setText(copied_text(lines_));
    say("copied");
}

void PickTool::keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_ || !event->matches(QKeySequence::Copy)) return;
    event->accept();
    guarded([&] { copy(); });
}

bool PickTool::eventFilter(QObject* receiver, QEvent* event)
{
    QKeyEvent* const key = shortcut_of(receiver, event);
    if (!key || !key->matches(QKeySequence::Copy)) return QObject::eventFilter(receiver, event);
    event->accept();
    return true;
}

void PickTool::publish(const PickAnswer& answer)
{
    QVariantMap state;
    state["answers"] = ++answers_;
    state["final"] = answer.final;
    state["message"] = answer.message;
    if (answer.point) {
        QVariantMap values;
        for (const PickedLine& line : lines_) values[line.name] = line.value;
        state["point"] = values;
        state["node"] = static_cast<qulonglong>(answer.point->node);
        state["index"] = static_cast<qulonglong>(answer.point->point);
    }
    view_->setProperty("pcm_pick", state);
}

}  // namespace pcm::host
