#include "plugin/edit/icon.h"

#include <QPainter>
#include <QPainterPath>
#include <QPixmap>
#include <QPolygonF>

namespace pcm::host {

QIcon first_person_icon()
{
    constexpr int size = 64;
    QPixmap picture(size, size);
    picture.fill(Qt::transparent);
    QPainter painter(&picture);
    painter.setRenderHint(QPainter::Antialiasing);
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
    return QIcon(picture);
}

}  // namespace pcm::host
