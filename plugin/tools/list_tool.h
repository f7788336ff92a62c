// A tool with a draft and a list of what was made of drafts, which has undo: the keys are the same for all of them.
// GUI thread.
#pragma once

#include "plugin/tools/click_tool.h"

class QKeyEvent;

namespace pcm::host {

class ListTool : public ClickTool {
public:
    void keyPressEvent(QKeyEvent* event) override;

protected:
    using ClickTool::ClickTool;

    enum class ListKey { undo, redo, copy, remove };
    virtual void press_key(ListKey key) = 0;  // Ctrl+Z, Ctrl+Shift+Z, Ctrl+C, Delete: the list's
    virtual void accept() = 0;                // Enter: the draft
    virtual bool take_back() = 0;             // Backspace, and Ctrl+Z first: the draft's last point; false: none
    virtual bool cancel() = 0;                // Esc: what runs, or the draft; false: neither, Esc is MeshLab's

    // These keys, where MeshLab has them as shortcuts.
    bool eventFilter(QObject* receiver, QEvent* event) override;
};

}  // namespace pcm::host
