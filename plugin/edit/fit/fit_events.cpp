// Keys of the tool Fit Primitives.
#include "plugin/edit/fit/fit_tool.h"

#include <meshlab/glarea.h>

#include <QKeyEvent>

namespace pcm::host {

void FitTool::keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    using Button = FitPanel::Button;
    guarded([&] {
        if (event->key() == Qt::Key_Escape) {  // taken as an override; MeshLab's window would suspend the tool
            event->accept();
        } else if (event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter) {
            event->accept();
            accept();
        } else if (event->key() == Qt::Key_Backspace) {
            event->accept();
            take_back();
        } else if (event->matches(QKeySequence::Undo)) {
            event->accept();
            if (!take_back()) press(Button::undo);
        } else if (event->matches(QKeySequence::Redo)) {
            event->accept();
            press(Button::redo);
        } else if (event->key() == Qt::Key_Delete) {
            event->accept();
            press(Button::remove);
        }
    });
}

bool FitTool::eventFilter(QObject* receiver, QEvent* event)
{
    if (receiver != view_ || !view_ || view_->suspendedEditor) return QObject::eventFilter(receiver, event);
    if (event->type() != QEvent::ShortcutOverride) return QObject::eventFilter(receiver, event);
    auto* key = static_cast<QKeyEvent*>(event);
    bool did = false;
    if (key->key() == Qt::Key_Escape) guarded([&] { did = cancel(); });
    // MeshLab's shortcuts do not take these from the view.
    const bool ours =
        key->matches(QKeySequence::Undo) || key->matches(QKeySequence::Redo) || key->key() == Qt::Key_Delete;
    if (!did && !ours) return QObject::eventFilter(receiver, event);
    event->accept();
    return true;
}

}  // namespace pcm::host
