#include "plugin/tools/click_tool.h"

#include "plugin/tools/view_camera.h"

namespace pcm::host {

namespace {

constexpr int click_px = 3;  // a click does not move farther

}  // namespace

bool ClickTool::is_kept(const QMouseEvent& event) const
{
    return event.button() == Qt::RightButton && has_right_click();
}

void ClickTool::mousePressEvent(QMouseEvent* event)
{
    // The camera gets the press when the mouse has moved: it does not jump at clicks.
    if (event->button() == Qt::LeftButton || is_kept(*event))
        pressed_ = std::make_unique<QMouseEvent>(*event);
    else
        guarded([&] { view_->give_to_camera(*event); });
}

void ClickTool::mouseMoveEvent(QMouseEvent* event)
{
    guarded([&] {
        if (pressed_) {
            if ((event->pos() - pressed_->pos()).manhattanLength() <= click_px) return;
            if (!is_kept(*pressed_)) view_->give_to_camera(*pressed_);
            pressed_.reset();
        }
        if (!has_right_click() || event->buttons() != Qt::MouseButtons(Qt::RightButton)) view_->give_to_camera(*event);
    });
}

void ClickTool::mouseReleaseEvent(QMouseEvent* event)
{
    const auto pressed = std::move(pressed_);
    guarded([&] {
        if (!pressed || pressed->button() != event->button()) {
            if (!is_kept(*event)) view_->give_to_camera(*event);
        } else if (event->button() == Qt::LeftButton) {
            click(event->pos(), event->modifiers());
        } else {
            right_click();
        }
    });
}

void ClickTool::wheelEvent(QWheelEvent* event)
{
    guarded([&] { view_->give_to_camera(*event); });
    event->accept();
}

}  // namespace pcm::host
