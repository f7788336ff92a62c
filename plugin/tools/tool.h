// The base of all tools: what works in a view while it is on, with the events of the view and what it draws over it.
// The program that shows the view starts and ends it, and passes on what happens.
#pragma once

#include "plugin/scene/scene_view.h"

#include <QObject>

class QKeyEvent;
class QMouseEvent;
class QPainter;
class QWheelEvent;

namespace pcm::host {

// GUI thread. A tool works in one view, from start() to end(); it may be started again, in the same view. No exception
// may leave its functions: Qt does not allow them in event handlers.
class Tool : public QObject {
public:
    // False, with a message: the tool does not start.
    virtual bool start(SceneView& view) = 0;
    virtual void end() = 0;

    // Between start() and end().
    virtual void mousePressEvent(QMouseEvent*) {}
    virtual void mouseMoveEvent(QMouseEvent*) {}
    virtual void mouseReleaseEvent(QMouseEvent*) {}
    virtual void wheelEvent(QWheelEvent*) {}
    virtual void keyPressEvent(QKeyEvent*) {}
    virtual void keyReleaseEvent(QKeyEvent*) {}
    // In each paint event of the view; there may be no painter.
    virtual void draw(QPainter*) {}

protected:
    SceneView* view_ = nullptr;  // while the tool is on
};

}  // namespace pcm::host
