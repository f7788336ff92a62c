#include "plugin/tools/align/align_tool.h"

#include "plugin/panels/tool_dock.h"
#include "plugin/tools/align/align_marks.h"
#include "plugin/tools/view_camera.h"

#include <QKeyEvent>

namespace pcm::host {

bool AlignTool::start(SceneView& view)
{
    view_ = &view;
    AlignSession& session = view.scene().part<AlignSession>();
    session.choose_first();
    panel_ = &AlignPanel::of(view);
    panel_->show_session(&session);
    show_dock(view, *panel_);
    show_marks(session, true);
    view.widget().setFocus();
    view.widget().setCursor(Qt::CrossCursor);
    return true;
}

void AlignTool::end()
{
    show_marks(view_->scene().part<AlignSession>(), false);
    if (panel_) panel_->hide();
    forget_press();
    view_->widget().unsetCursor();
    view_ = nullptr;
}

void AlignTool::keyPressEvent(QKeyEvent* event)
{
    const bool undo = event->matches(QKeySequence::Undo);
    if (undo || event->matches(QKeySequence::Redo)) {
        event->accept();
        if (panel_) panel_->step(!undo);
        return;
    }
    if (event->key() != Qt::Key_Delete) return;
    event->accept();
    AlignSession& session = view_->scene().part<AlignSession>();
    session.remove(session.selected() >= 0 ? session.selected() : int(session.pairs().size()) - 1);
}

void AlignTool::click(const QPoint& place, Qt::KeyboardModifiers)
{
    pick(*view_, place, *this, [this](const PickAnswer& answer) {
        if (!view_ || !panel_ || !answer.final) return;
        guarded([&] {
            panel_->say(answer.point ? view_->scene().part<AlignSession>().take(*answer.point) : answer.message);
        });
    });
}

}  // namespace pcm::host
