#include "plugin/tools/list_tool.h"

#include <QKeyEvent>

namespace pcm::host {

void ListTool::keyPressEvent(QKeyEvent* event)
{
    event->accept();
    guarded([&] {
        if (event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter) {
            accept();
        } else if (event->key() == Qt::Key_Backspace) {
            take_back();
        } else if (event->matches(QKeySequence::Undo)) {
            if (!take_back()) press_key(ListKey::undo);
        } else if (event->matches(QKeySequence::Redo)) {
            press_key(ListKey::redo);
        } else if (event->matches(QKeySequence::Copy)) {
            press_key(ListKey::copy);
        } else if (event->key() == Qt::Key_Delete) {
            press_key(ListKey::remove);
        } else if (event->key() != Qt::Key_Escape) {  // taken as a shortcut; MeshLab's window would suspend the tool
            event->ignore();
        }
    });
}

bool ListTool::eventFilter(QObject* receiver, QEvent* event)
{
    QKeyEvent* const key = shortcut_of(receiver, event);
    if (!key) return ClickTool::eventFilter(receiver, event);
    bool ours = key->matches(QKeySequence::Undo) || key->matches(QKeySequence::Redo) ||
                key->matches(QKeySequence::Copy) || key->key() == Qt::Key_Delete;
    if (key->key() == Qt::Key_Escape) guarded([&] { ours = cancel(); });
    if (!ours) return ClickTool::eventFilter(receiver, event);
    event->accept();
    return true;
}

}  // namespace pcm::host
