// What the tool Measure does with the mouse and keys beyond list_tool.h.
#include "plugin/scene/measure_book.h"
#include "plugin/tools/measure/measure_tool.h"
#include "plugin/tools/view_camera.h"

#include <QMouseEvent>
#include <QPainter>

namespace pcm::host {

void MeasureTool::mouseMoveEvent(QMouseEvent* event)
{
    mouse_ = event->pos();
    ListTool::mouseMoveEvent(event);
}

void MeasureTool::press_key(ListKey key)
{
    using Button = MeasurePanel::Button;
    press(key == ListKey::undo   ? Button::undo
          : key == ListKey::redo ? Button::redo
          : key == ListKey::copy ? Button::copy
                                 : Button::remove);
}

bool MeasureTool::eventFilter(QObject* receiver, QEvent* event)
{
    if (!view_ || receiver != &view_->widget() || view_->is_suspended()) return ListTool::eventFilter(receiver, event);
    if (event->type() == QEvent::MouseMove && static_cast<QMouseEvent*>(event)->buttons() == Qt::NoButton) {
        const bool shown = !draft_.points().empty();
        mouse_ = static_cast<QMouseEvent*>(event)->pos();
        if (shown) view_->update();  // the line to the cursor
        return true;
    }
    if (event->type() == QEvent::MouseButtonDblClick) {
        forget_press();
        guarded([&] { end_draft(); });
        return true;
    }
    return ListTool::eventFilter(receiver, event);
}

// A line from the last point to the cursor. No pick: the cursor's place in space is not known.
void MeasureTool::draw(QPainter* painter)
{
    if (!painter || view_->is_suspended()) return;
    const auto points = draft_.points();
    if (points.empty() || draft_.is_full() || !view_->widget().rect().contains(mouse_)) return;
    guarded([&] {
        const auto map = map_of(*view_);
        const auto from = map ? map->pixel_of(points.back().position) : std::nullopt;
        if (!from) return;
        painter->endNativePainting();
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        painter->setPen(QPen(QColor(90, 220, 255), 1.5, Qt::DashLine));
        painter->drawLine(*from, QPointF(mouse_));
        painter->restore();
        painter->beginNativePainting();
    });
}

}  // namespace pcm::host
