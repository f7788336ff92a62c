// What the tools with a panel have in common. GUI thread.
#pragma once

#include "plugin/tools/tool.h"

#include <QObject>
#include <QString>

#include <functional>

class QKeyEvent;

namespace pcm::host {

class ViewTool : public Tool {
protected:
    explicit ViewTool(const char* name) : name_(name) {}
    // Takes the view. False, with a message, where it shows no cloud: the tool does not start.
    bool take_view(SceneView& view);
    // Qt does not allow exceptions in event handlers: what the work throws is shown as a message.
    void guarded(const std::function<void()>& work);
    // In the panel and in the scene's log; an empty text empties the panel's line alone.
    void say(const QString& text);
    // For an event filter of the view: the key that the window is about to take as a shortcut, while the tool works;
    // accept() leaves it to the view. Null: it is another event.
    QKeyEvent* shortcut_of(QObject* receiver, QEvent* event) const;
    virtual void say_in_panel(const QString& text) = 0;

private:
    const char* const name_;
};

}  // namespace pcm::host
