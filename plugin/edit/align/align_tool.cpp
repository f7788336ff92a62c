#include "plugin/edit/align/align_tool.h"

#include "plugin/edit/align/align_marks.h"
#include "plugin/edit/tool_dock.h"
#include "plugin/edit/view_events.h"

#include <meshlab/glarea.h>

#include <QKeyEvent>

namespace pcm::host {

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
    forget_press();
    view_->unsetCursor();
    view_ = nullptr;
}

void AlignTool::keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_ || !view->md()) return;
    const bool undo = event->matches(QKeySequence::Undo);
    if (undo || event->matches(QKeySequence::Redo)) {
        event->accept();
        if (panel_) panel_->step(!undo);
        return;
    }
    if (event->key() != Qt::Key_Delete) return;
    event->accept();
    AlignSession& session = AlignSession::of(*view->md());
    session.remove(session.selected() >= 0 ? session.selected() : int(session.pairs().size()) - 1);
}

void AlignTool::click(const QPoint& place, Qt::KeyboardModifiers)
{
    pick(*view_, place, *this, [this](const PickAnswer& answer) {
        if (!view_ || !view_->md() || !panel_ || !answer.final) return;
        guarded(
            [&] { panel_->say(answer.point ? AlignSession::of(*view_->md()).take(*answer.point) : answer.message); });
    });
}

}  // namespace pcm::host
