// Mouse and keys of the tool Measure.
#include "plugin/edit/measure/measure_book.h"
#include "plugin/edit/measure/measure_tool.h"
#include "plugin/edit/view_events.h"

#include <meshlab/glarea.h>

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>

namespace pcm::host {

namespace {

constexpr int click_px = 3;  // a click does not move farther

}  // namespace

void MeasureTool::mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    // The camera gets the press when the mouse has moved: it does not jump at clicks.
    if (event->button() == Qt::LeftButton || event->button() == Qt::RightButton)
        pressed_ = std::make_unique<QMouseEvent>(*event);
    else
        guarded([&] { give_to_camera(*view, *event); });
}

void MeasureTool::mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    mouse_ = event->pos();
    guarded([&] {
        if (pressed_) {
            if ((event->pos() - pressed_->pos()).manhattanLength() <= click_px) return;
            if (pressed_->button() == Qt::LeftButton) give_to_camera(*view, *pressed_);
            pressed_.reset();
        }
        if ((event->buttons() & ~Qt::MouseButtons(Qt::RightButton)) != 0 || event->buttons() == Qt::NoButton)
            give_to_camera(*view, *event);
    });
}

void MeasureTool::mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    const auto pressed = std::move(pressed_);
    guarded([&] {
        if (!pressed || pressed->button() != event->button()) {
            if (event->button() != Qt::RightButton) give_to_camera(*view, *event);
        } else if (event->button() == Qt::LeftButton) {
            click(event->pos());
        } else {
            end();
        }
    });
}

void MeasureTool::wheelEvent(QWheelEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    guarded([&] { give_to_camera(*view, *event); });
    event->accept();
}

void MeasureTool::keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    using Button = MeasurePanel::Button;
    guarded([&] {
        if (event->key() == Qt::Key_Escape) {  // taken as an override; MeshLab's window would suspend the tool
            event->accept();
        } else if (event->matches(QKeySequence::Undo)) {
            event->accept();
            if (!take_back()) press(Button::undo);
        } else if (event->matches(QKeySequence::Redo)) {
            event->accept();
            press(Button::redo);
        } else if (event->matches(QKeySequence::Copy)) {
            event->accept();
            press(Button::copy);
        } else if (event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter) {
            event->accept();
            end();
        } else if (event->key() == Qt::Key_Backspace) {
            event->accept();
            take_back();
        } else if (event->key() == Qt::Key_Delete) {
            event->accept();
            press(Button::remove);
        }
    });
}

bool MeasureTool::eventFilter(QObject* receiver, QEvent* event)
{
    if (receiver != view_ || !view_ || view_->suspendedEditor) return QObject::eventFilter(receiver, event);
    if (event->type() == QEvent::MouseMove && static_cast<QMouseEvent*>(event)->buttons() == Qt::NoButton) {
        const bool shown = !draft_.points().empty();
        mouse_ = static_cast<QMouseEvent*>(event)->pos();
        if (shown) view_->update();  // the line to the cursor
        return true;
    }
    if (event->type() == QEvent::MouseButtonDblClick) {
        pressed_.reset();
        guarded([&] { end(); });
        return true;
    }
    if (event->type() == QEvent::ShortcutOverride) {
        auto* key = static_cast<QKeyEvent*>(event);
        bool did = false;
        if (key->key() == Qt::Key_Escape) guarded([&] { did = cancel(); });
        // MeshLab's shortcuts do not take these from the view.
        const bool ours = key->matches(QKeySequence::Undo) || key->matches(QKeySequence::Redo) ||
                          key->matches(QKeySequence::Copy) || key->key() == Qt::Key_Delete;
        if (did) say("cancelled");
        if (did || ours) {
            event->accept();
            return true;
        }
    }
    return QObject::eventFilter(receiver, event);
}

// A line from the last point to the cursor. No pick: the cursor's place in space is not known.
void MeasureTool::Decorate(MeshModel&, GLArea* view, QPainter* painter)
{
    if (view != view_ || !painter || view->suspendedEditor) return;
    const auto points = draft_.points();
    if (points.empty() || draft_.is_full() || !view->rect().contains(mouse_)) return;
    guarded([&] {
        const auto map = map_of(*view);
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
