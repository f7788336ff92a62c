// A tool whose clicks do something, while drags and the wheel move MeshLab's camera. GUI thread.
#pragma once

#include "plugin/tools/view_tool.h"

#include <QMouseEvent>
#include <QPoint>

#include <memory>

namespace pcm::host {

class ClickTool : public ViewTool {
public:
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

protected:
    using ViewTool::ViewTool;
    // The right button does something too: it is kept from the camera.
    virtual bool has_right_click() const { return false; }
    virtual void right_click() {}
    // The left button was pressed and released at one place of the view.
    virtual void click(const QPoint& place, Qt::KeyboardModifiers modifiers) = 0;
    void forget_press() { pressed_.reset(); }

private:
    bool is_kept(const QMouseEvent& event) const;  // from the camera

    std::unique_ptr<QMouseEvent> pressed_;  // has not moved far enough for a drag
};

}  // namespace pcm::host
