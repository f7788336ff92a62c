#include "plugin/edit/click_tool.h"

#include "plugin/edit/view_events.h"

#include <meshlab/glarea.h>

namespace pcm::host {

namespace {

constexpr int click_px = 3;  // a click does not move farther

}  // namespace

bool ClickTool::is_kept(const QMouseEvent& event) const
{
    return event.button() == Qt::RightButton && has_right_click();
}

void ClickTool::mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    // The camera gets the press when the mouse has moved: it does not jump at clicks.
    if (event->button() == Qt::LeftButton || is_kept(*event))
        pressed_ = std::make_unique<QMouseEvent>(*event);
    else
        guarded([&] { give_to_camera(*view, *event); });
}

void ClickTool::mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    guarded([&] {
        if (pressed_) {
            if ((event->pos() - pressed_->pos()).manhattanLength() <= click_px) return;
            if (!is_kept(*pressed_)) give_to_camera(*view, *pressed_);
            pressed_.reset();
        }
        if (!has_right_click() || event->buttons() != Qt::MouseButtons(Qt::RightButton)) give_to_camera(*view, *event);
    });
}

void ClickTool::mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    const auto pressed = std::move(pressed_);
    guarded([&] {
        if (!pressed || pressed->button() != event->button()) {
            if (!is_kept(*event)) give_to_camera(*view, *event);
        } else if (event->button() == Qt::LeftButton) {
            click(event->pos(), event->modifiers());
        } else {
            right_click();
        }
    });
}

void ClickTool::wheelEvent(QWheelEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    guarded([&] { give_to_camera(*view, *event); });
    event->accept();
}

}  // namespace pcm::host
