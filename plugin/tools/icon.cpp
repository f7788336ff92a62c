#include "plugin/tools/icon.h"

#include <QPainter>
#include <QPainterPath>
#include <QPixmap>
#include <QPolygonF>

#include <functional>

namespace pcm::host {

namespace {

constexpr int size = 64;

// Points on a wavy ground, in the colour of whether they are in the polygon.
void draw_points(QPainter& painter, const QPolygonF& polygon, const QColor& in, const QColor& out)
{
    painter.setPen(Qt::NoPen);
    for (int x = 4; x < size; x += 9)
        for (int y = 6; y < size; y += 9) {
            const QPointF at(x + y % 5, y + x % 7 / 2.0);
            painter.setBrush(polygon.containsPoint(at, Qt::OddEvenFill) ? in : out);
            painter.drawEllipse(at, 2.6, 2.6);
        }
}

QIcon painted(const std::function<void(QPainter& painter)>& paint)
{
    QPixmap picture(size, size);
    picture.fill(Qt::transparent);
    QPainter painter(&picture);
    painter.setRenderHint(QPainter::Antialiasing);
    paint(painter);
    return QIcon(picture);
}

}  // namespace

QIcon first_person_icon()
{
    return painted([](QPainter& painter) {
        painter.setPen(QPen(QColor(40, 40, 40), 3));
        painter.setBrush(Qt::white);
        QPainterPath eye(QPointF(4, 22));
        eye.quadTo(QPointF(32, -6), QPointF(60, 22));
        eye.quadTo(QPointF(32, 48), QPointF(4, 22));
        painter.drawPath(eye);
        painter.setPen(Qt::NoPen);
        painter.setBrush(QColor(60, 110, 190));
        painter.drawEllipse(QPointF(32, 21), 11, 11);
        painter.setBrush(Qt::black);
        painter.drawEllipse(QPointF(32, 21), 5, 5);
        painter.setBrush(QColor(200, 90, 30));
        painter.drawPolygon(QPolygonF({{32, 40}, {40, 49}, {24, 49}}));  // ahead
        painter.drawPolygon(QPolygonF({{32, 63}, {40, 54}, {24, 54}}));
        painter.drawPolygon(QPolygonF({{8, 51}, {19, 44}, {19, 59}}));
        painter.drawPolygon(QPolygonF({{56, 51}, {45, 44}, {45, 59}}));
    });
}

QIcon clip_box_icon()
{
    return painted([](QPainter& painter) {
        const QPolygonF front({{8, 24}, {42, 24}, {42, 58}, {8, 58}}), back = front.translated(14, -16);
        draw_points(painter, front, QColor(60, 110, 190), QColor(200, 200, 200));
        painter.setBrush(Qt::NoBrush);
        painter.setPen(QPen(QColor(220, 130, 0), 3));
        painter.drawPolygon(front);
        painter.drawPolygon(back);
        for (int i = 0; i < 4; ++i) painter.drawLine(front[i], back[i]);
    });
}

QIcon select_points_icon()
{
    return painted([](QPainter& painter) {
        const QPolygonF lasso({{12, 14}, {44, 8}, {56, 30}, {40, 54}, {16, 46}});
        draw_points(painter, lasso, QColor(220, 60, 30), QColor(130, 150, 170));
        painter.setBrush(Qt::NoBrush);
        painter.setPen(QPen(QColor(40, 40, 40), 3, Qt::DashLine));
        painter.drawPolygon(lasso);
    });
}

QIcon align_icon()
{
    return painted([](QPainter& painter) {
        const QPointF moving[] = {{10, 50}, {20, 30}, {34, 54}}, fixed[] = {{28, 22}, {40, 6}, {56, 30}};
        painter.setPen(QPen(QColor(90, 90, 90), 2, Qt::DashLine));
        for (int i = 0; i < 3; ++i) painter.drawLine(moving[i], fixed[i]);
        painter.setPen(QPen(QColor(40, 40, 40), 2));
        for (int i = 0; i < 3; ++i) {
            painter.setBrush(QColor(255, 140, 0));
            painter.drawEllipse(moving[i], 7, 7);
            painter.setBrush(QColor(0, 170, 255));
            painter.drawEllipse(fixed[i], 7, 7);
        }
    });
}

QIcon measure_icon()
{
    return painted([](QPainter& painter) {
        painter.setPen(QPen(QColor(40, 40, 40), 2));
        painter.setBrush(QColor(250, 215, 110));
        painter.drawRect(QRectF(3, 40, 58, 20));
        for (int i = 1; i < 9; ++i) painter.drawLine(3 + i * 58 / 9, 40, 3 + i * 58 / 9, i % 3 == 0 ? 52 : 47);
        painter.setPen(QPen(QColor(200, 90, 30), 4));
        painter.drawLine(10, 26, 54, 10);
        painter.setPen(QPen(QColor(40, 40, 40), 3));
        for (const QPoint& end : {QPoint(10, 26), QPoint(54, 10)}) {
            painter.drawLine(end - QPoint(7, 0), end + QPoint(7, 0));
            painter.drawLine(end - QPoint(0, 7), end + QPoint(0, 7));
        }
    });
}

QIcon fit_icon()
{
    return painted([](QPainter& painter) {
        const QPolygonF pipe({{18, 14}, {46, 14}, {46, 52}, {18, 52}});
        draw_points(painter, pipe, QColor(220, 60, 30), QColor(190, 200, 210));
        painter.setBrush(Qt::NoBrush);
        painter.setPen(QPen(QColor(40, 40, 40), 3));
        painter.drawLine(16, 12, 16, 52);
        painter.drawLine(48, 12, 48, 52);
        painter.drawArc(QRectF(16, 46, 32, 12), 180 * 16, 180 * 16);
        painter.setBrush(QColor(250, 215, 110));
        painter.drawEllipse(QRectF(16, 6, 32, 12));
    });
}

QIcon pick_point_icon()
{
    return painted([](QPainter& painter) {
        painter.setPen(Qt::NoPen);
        painter.setBrush(QColor(60, 110, 190));
        for (const QPointF& place :
             {QPointF(10, 14), QPointF(52, 12), QPointF(14, 52), QPointF(54, 50), QPointF(31, 58)})
            painter.drawEllipse(place, 4, 4);
        painter.setBrush(QColor(200, 90, 30));
        painter.drawEllipse(QPointF(32, 32), 6, 6);
        painter.setPen(QPen(QColor(40, 40, 40), 3));
        for (const QPoint& way : {QPoint(1, 0), QPoint(-1, 0), QPoint(0, 1), QPoint(0, -1)})
            painter.drawLine(QPoint(32, 32) + 11 * way, QPoint(32, 32) + 24 * way);
    });
}

}  // namespace pcm::host
