#include "plugin/tools/measure/profile_plot.h"

#include <QFontMetrics>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm::host {

namespace {

const QColor paper(255, 255, 255), grid_line(225, 225, 225), ink(40, 40, 40), span_colour(200, 60, 0);
constexpr double zoom_step = 1.2;  // factor of a notch of the wheel
constexpr int wheel_notch = 120;
constexpr int point_px = 2;                        // side of a point
constexpr int tick_room_x = 90, tick_room_y = 45;  // pixels from tick to tick, at least

}  // namespace

ProfilePlot::ProfilePlot(QWidget* parent) : QWidget(parent)
{
    setMouseTracking(true);
    setCursor(Qt::CrossCursor);
    lay_out();
}

void ProfilePlot::show_points(std::vector<PlotPoint> points, const QString& title, const QString& unit)
{
    points_ = std::move(points);
    title_ = title;
    unit_ = unit;
    span_.reset();
    fit();
}

void ProfilePlot::set_equal_scale(bool equal)
{
    equal_ = equal;
    if (fitted_ || !equal) return fit();
    frame_.make_equal();
    changed();
}

void ProfilePlot::fit()
{
    constexpr double infinite = std::numeric_limits<double>::infinity();
    double x0 = infinite, x1 = -infinite, y0 = infinite, y1 = -infinite;
    for (const PlotPoint& p : points_) {
        x0 = std::min(x0, p.station);
        x1 = std::max(x1, p.station);
        y0 = std::min(y0, p.height);
        y1 = std::max(y1, p.height);
    }
    lay_out();
    if (points_.empty())
        frame_.fit(0, 1, 0, 1, equal_);
    else
        frame_.fit(x0, x1, y0, y1, equal_);
    fitted_ = true;
    changed();
}

void ProfilePlot::lay_out()
{
    const QFontMetrics font(this->font());
    const int line = font.height();
    frame_.x = font.horizontalAdvance("0000000.000") + line;
    frame_.y = line * 2;
    frame_.width = std::max(1, width() - frame_.x - line);
    frame_.height = std::max(1, height() - frame_.y - line * 3);
}

void ProfilePlot::changed()
{
    picture_is_old_ = true;
    update();
}

void ProfilePlot::draw_points()
{
    const double ratio = devicePixelRatioF();
    const int columns = std::max(1, static_cast<int>(frame_.width * ratio));
    const int rows = std::max(1, static_cast<int>(frame_.height * ratio));
    picture_ = QImage(columns, rows, QImage::Format_RGB32);
    picture_.fill(paper);
    picture_.setDevicePixelRatio(ratio);
    const int size = std::max(1, static_cast<int>(std::lround(point_px * ratio)));
    auto* const pixels = reinterpret_cast<QRgb*>(picture_.bits());  // rows of 4-byte pixels have no gaps
    for (const PlotPoint& p : points_) {
        const double x = (frame_.pixel_x(p.station) - frame_.x) * ratio - size / 2.0 + 0.5;
        const double y = (frame_.pixel_y(p.height) - frame_.y) * ratio - size / 2.0 + 0.5;
        if (!(x > -size && x < columns && y > -size && y < rows)) continue;
        const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
        for (int row = std::max(0, top); row < std::min(rows, top + size); ++row)
            for (int column = std::max(0, left); column < std::min(columns, left + size); ++column)
                pixels[static_cast<std::ptrdiff_t>(row) * columns + column] = p.colour | 0xff000000u;
    }
    picture_is_old_ = false;
}

void ProfilePlot::paintEvent(QPaintEvent*)
{
    if (picture_is_old_) draw_points();
    QPainter painter(this);
    painter.fillRect(rect(), paper);
    painter.drawImage(frame_.x, frame_.y, picture_);
    draw_axes(painter);
    draw_pointer(painter);
}

void ProfilePlot::draw_axes(QPainter& painter) const
{
    const QRect area(frame_.x, frame_.y, frame_.width, frame_.height);
    const int line = painter.fontMetrics().height();
    const QString unit = unit_.isEmpty() ? QString() : " (" + unit_ + ")";
    painter.setCompositionMode(QPainter::CompositionMode_Multiply);  // the grid does not cover points
    painter.setPen(grid_line);
    const Ticks across = round_ticks(frame_.left, frame_.right, std::max(2, frame_.width / tick_room_x));
    const Ticks up = round_ticks(frame_.bottom, frame_.top, std::max(2, frame_.height / tick_room_y));
    for (const double value : across.values) {
        const int x = static_cast<int>(std::lround(frame_.pixel_x(value)));
        painter.drawLine(x, area.top(), x, area.bottom());
    }
    for (const double value : up.values) {
        const int y = static_cast<int>(std::lround(frame_.pixel_y(value)));
        painter.drawLine(area.left(), y, area.right(), y);
    }
    painter.setCompositionMode(QPainter::CompositionMode_SourceOver);
    painter.setPen(ink);
    painter.drawRect(area.adjusted(0, 0, -1, -1));
    for (const double value : across.values) {
        const int x = static_cast<int>(std::lround(frame_.pixel_x(value)));
        painter.drawText(QRect(x - tick_room_x, area.bottom() + 2, 2 * tick_room_x, line), Qt::AlignHCenter,
                         across.text(value));
    }
    for (const double value : up.values) {
        const int y = static_cast<int>(std::lround(frame_.pixel_y(value)));
        painter.drawText(QRect(0, y - line / 2, area.left() - 4, line), Qt::AlignRight | Qt::AlignVCenter,
                         up.text(value));
    }
    painter.drawText(QRect(area.left(), area.bottom() + line + 4, area.width(), line), Qt::AlignHCenter,
                     "Along the line" + unit);
    painter.drawText(QRect(4, 2, area.left() + area.width(), line), Qt::AlignLeft, "Height" + unit);
    painter.drawText(QRect(area.left(), 2, area.width(), line), Qt::AlignHCenter, title_);
}

void ProfilePlot::draw_pointer(QPainter& painter) const
{
    const QRect area(frame_.x, frame_.y, frame_.width, frame_.height);
    painter.setClipRect(area);
    if (mouse_ && area.contains(mouse_->toPoint())) {
        painter.setPen(QPen(QColor(120, 120, 120), 1, Qt::DashLine));
        painter.drawLine(QPointF(mouse_->x(), area.top()), QPointF(mouse_->x(), area.bottom()));
        painter.drawLine(QPointF(area.left(), mouse_->y()), QPointF(area.right(), mouse_->y()));
    }
    if (!span_) return;
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(QPen(span_colour, 2));
    const QPointF from(frame_.pixel_x(span_->station0), frame_.pixel_y(span_->height0));
    const QPointF to(frame_.pixel_x(span_->station1), frame_.pixel_y(span_->height1));
    painter.drawLine(from, to);
    QRectF box = painter.boundingRect(QRectF(), Qt::AlignLeft, text_of_span()).adjusted(-4, -2, 4, 2);
    box.moveTopLeft((from + to) / 2 + QPointF(8, 8));
    box.moveRight(std::min(box.right(), double(area.right())));
    box.moveBottom(std::min(box.bottom(), double(area.bottom())));
    painter.fillRect(box, QColor(255, 255, 255, 225));
    painter.drawText(box, Qt::AlignCenter, text_of_span());
}

QString ProfilePlot::number(double value, double per_pixel) const
{
    const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(per_pixel))), 0, 12);
    return QString::number(value, 'f', decimals);
}

QString ProfilePlot::text_at(const QPointF& pixel) const
{
    const double x_step = (frame_.right - frame_.left) / frame_.width;
    const double y_step = (frame_.top - frame_.bottom) / frame_.height;
    return QString("along %1, height %2%3")
        .arg(number(frame_.value_x(pixel.x()), x_step), number(frame_.value_y(pixel.y()), y_step),
             unit_.isEmpty() ? "" : " " + unit_);
}

QString ProfilePlot::text_of_span() const
{
    if (!span_) return {};
    const double along = span_->station1 - span_->station0, up = span_->height1 - span_->height0;
    const double step =
        std::min((frame_.right - frame_.left) / frame_.width, (frame_.top - frame_.bottom) / frame_.height);
    const QString unit = unit_.isEmpty() ? "" : " " + unit_;
    return QString("%1%4 (along %2%4, up %3%4)")
        .arg(number(std::hypot(along, up), step), number(along, step), number(up, step), unit);
}

void ProfilePlot::resizeEvent(QResizeEvent*)
{
    if (fitted_) return fit();
    lay_out();
    if (equal_) frame_.make_equal();
    changed();
}

void ProfilePlot::mousePressEvent(QMouseEvent* event)
{
    pressed_ = event->localPos();
    measuring_ = event->button() == Qt::RightButton || (event->modifiers() & Qt::ShiftModifier) != 0;
    if (!measuring_) return;
    const double station = frame_.value_x(pressed_->x()), height = frame_.value_y(pressed_->y());
    span_ = Span{station, height, station, height};
    update();
}

void ProfilePlot::mouseMoveEvent(QMouseEvent* event)
{
    const QPointF at = event->localPos();
    if (pressed_ && event->buttons() != Qt::NoButton) {
        if (measuring_) {
            span_->station1 = frame_.value_x(at.x());
            span_->height1 = frame_.value_y(at.y());
        } else {
            frame_.move(at.x() - pressed_->x(), at.y() - pressed_->y());
            pressed_ = at;
            fitted_ = false;
            changed();
        }
    }
    mouse_ = at;
    emit pointed(span_ && measuring_ && pressed_ ? text_of_span() : text_at(at));
    update();
}

void ProfilePlot::mouseReleaseEvent(QMouseEvent*)
{
    pressed_.reset();
    // A press without a movement takes the line away.
    if (measuring_ && span_ && span_->station0 == span_->station1 && span_->height0 == span_->height1) span_.reset();
    measuring_ = false;
    update();
}

void ProfilePlot::mouseDoubleClickEvent(QMouseEvent*) { fit(); }

void ProfilePlot::wheelEvent(QWheelEvent* event)
{
    const QPoint turned = event->angleDelta();
    const double factor = std::pow(zoom_step, double(turned.y() != 0 ? turned.y() : turned.x()) / wheel_notch);
    // Without equal scales, Shift stretches the heights alone and Ctrl the line.
    const bool heights = !equal_ && (event->modifiers() & Qt::ShiftModifier) != 0;
    const bool along = !equal_ && (event->modifiers() & Qt::ControlModifier) != 0;
    frame_.zoom(event->position().x(), event->position().y(), heights ? 1 : factor, along ? 1 : factor);
    fitted_ = false;
    changed();
    event->accept();
}

void ProfilePlot::leaveEvent(QEvent*)
{
    mouse_.reset();
    emit pointed({});
    update();
}

}  // namespace pcm::host
