#include "plugin/tools/pick/pick_tool.h"

#include "plugin/panels/tool_dock.h"
#include "plugin/scene/annotations.h"
#include "plugin/scene/text.h"
#include "plugin/tools/view_camera.h"

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

bool PickTool::start(SceneView& view)
{
    if (!take_view(view)) return false;
    if (!panel_) {
        panel_ = new PickPanel(view_->window());
        connect(panel_, &PickPanel::copy_asked, this, &PickTool::copy);
    }
    show_dock(view, *panel_);
    context_ = std::make_unique<QObject>();
    view.widget().installEventFilter(this);
    view.widget().setFocus();
    view.widget().setCursor(Qt::CrossCursor);
    if (shown_) show_point(true);
    say("click a point in the view; Ctrl+C copies what is shown; dragging and the wheel move the camera, Esc switches "
        "between this tool and the trackball");
    return true;
}

void PickTool::end()
{
    context_.reset();
    forget_press();
    view_->widget().removeEventFilter(this);
    view_->scene().part<Annotations>().set(owner, {});
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
        const SceneLayer* const layer = view_->scene().layer(answer.point->layer_id);
        shown_ = answer.point;
        lines_ = lines_of(*answer.point, layer ? layer->label() : QString());
        show_point(answer.final);
        if (answer.final) say(logged_text(lines_));
    } else {
        say(answer.message);
    }
    publish(answer);
}

void PickTool::show_point(bool complete)
{
    Annotation mark;
    mark.marks = {shown_->shown_at};
    mark.label = label_of(*shown_);
    mark.label_at = shown_->shown_at;
    mark.on_top = true;
    view_->scene().part<Annotations>().set(owner, {mark});
    if (panel_) panel_->show_point(lines_, complete);
}

void PickTool::copy()
{
    if (lines_.empty()) return say("nothing to copy: no point was picked");
    QGuiApplication::clipboard()->setText(copied_text(lines_));
    say("copied");
}

void PickTool::keyPressEvent(QKeyEvent* event)
{
    if (!event->matches(QKeySequence::Copy)) return;
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
    view_->widget().setProperty("pcm_pick", state);
}

}  // namespace pcm::host
