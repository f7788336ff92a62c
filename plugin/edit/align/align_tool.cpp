#include "plugin/edit/align/align_tool.h"

#include "plugin/edit/align/align_marks.h"
#include "plugin/edit/tool_dock.h"
#include "plugin/edit/view_events.h"
#include "plugin/host/text.h"

#include <meshlab/glarea.h>

#include <QKeyEvent>
#include <QMouseEvent>

namespace pcm::host {

namespace {

constexpr int click_px = 4;  // a longer way of the mouse is no click

}  // namespace

bool AlignTool::StartEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext*)
{
    view_ = view;
    setParent(view);  // the view does not delete its tools otherwise
    AlignSession& session = AlignSession::of(document);
    session.choose_first();
    panel_ = &AlignPanel::of(*view);
    panel_->show_session(&session);
    show_dock(*view, *panel_);
    show_marks(session, true);
    view->setFocus();
    view->setCursor(Qt::CrossCursor);
    keep_unmodified(document);
    return true;
}

void AlignTool::EndEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext*)
{
    if (view != view_) return;
    show_marks(AlignSession::of(document), false);
    if (panel_) panel_->hide();
    view_->unsetCursor();
    view_ = nullptr;
}

void AlignTool::mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    if (event->button() == Qt::LeftButton) {
        pressed_ = true;
        dragged_ = false;
        pressed_at_ = event->pos();
    }
    give_to_camera(*view, *event);
}

void AlignTool::mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    if (pressed_ && (event->pos() - pressed_at_).manhattanLength() > click_px) dragged_ = true;
    // The camera stays where it is while the button may still be released as a click.
    if (!pressed_ || dragged_) give_to_camera(*view, *event);
}

void AlignTool::mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    give_to_camera(*view, *event);
    if (event->button() != Qt::LeftButton || !pressed_) return;
    pressed_ = false;
    if (!dragged_) pick_at(pressed_at_);
}

void AlignTool::wheelEvent(QWheelEvent* event, MeshModel&, GLArea* view)
{
    if (view == view_) give_to_camera(*view, *event);
}

void AlignTool::keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_ || !view->md() || event->key() != Qt::Key_Delete) return;
    event->accept();
    AlignSession& session = AlignSession::of(*view->md());
    session.remove(session.selected() >= 0 ? session.selected() : int(session.pairs().size()) - 1);
}

void AlignTool::pick_at(const QPoint& place)
{
    try {
        pick(*view_, place, *this, [this](const PickAnswer& answer) {
            if (!view_ || !view_->md() || !panel_ || !answer.final) return;
            panel_->say(answer.point ? AlignSession::of(*view_->md()).take(*answer.point) : answer.message);
        });
    } catch (...) {  // Qt does not allow exceptions in event handlers
        if (panel_) panel_->say(QString::fromStdString(current_error()));
    }
}

}  // namespace pcm::host
