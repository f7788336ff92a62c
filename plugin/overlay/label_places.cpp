#include "plugin/overlay/label_places.h"

#include <QFontMetrics>
#include <QGuiApplication>
#include <QPainter>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr int label_distance = 8;  // from its anchor, pixels of the screen
constexpr int label_rows = 6;      // places that are tried above and below each other
constexpr int label_margin = 4;    // within its box, Qt's pixels

}  // namespace

std::vector<PlacedLabel> place_labels(const std::vector<std::pair<QString, QPointF>>& anchors,
                                      const std::map<QString, QSize>& sizes, const QSize& view)
{
    std::vector<PlacedLabel> placed;
    for (const auto& [text, anchor] : anchors) {
        const auto found = sizes.find(text);
        if (found == sizes.end() || anchor.x() < 0 || anchor.y() < 0 || anchor.x() > view.width() ||
            anchor.y() > view.height())
            continue;
        const QSize size = found->second;
        const int x = static_cast<int>(anchor.x()), y = static_cast<int>(anchor.y());
        const int right = x + label_distance, left = x - label_distance - size.width();
        const int above = y + label_distance, below = y - label_distance - size.height();
        std::vector<QRect> sides;
        for (int row = 0; row < label_rows; ++row)
            for (const QPoint& corner :
                 {QPoint(right, above + row * size.height()), QPoint(right, below - row * size.height()),
                  QPoint(left, above + row * size.height()), QPoint(left, below - row * size.height())})
                sides.emplace_back(std::clamp(corner.x(), 0, std::max(0, view.width() - size.width())),
                                   std::clamp(corner.y(), 0, std::max(0, view.height() - size.height())), size.width(),
                                   size.height());
        const auto is_free = [&, &others = placed](const QRect& side) {
            return std::none_of(others.begin(), others.end(),
                                [&](const PlacedLabel& other) { return other.place.intersects(side); });
        };
        const auto side = std::find_if(sides.begin(), sides.end(), is_free);
        placed.push_back({text, side == sides.end() ? sides.front() : *side});
    }
    return placed;
}

QImage label_image(const QString& text, double ratio)
{
    const QFont font = QGuiApplication::font();
    const QFontMetrics metrics(font);
    const QSize size = metrics.size(0, text) + QSize(2 * label_margin, 2 * label_margin);
    QImage image(static_cast<int>(std::ceil(size.width() * ratio)), static_cast<int>(std::ceil(size.height() * ratio)),
                 QImage::Format_RGBA8888);
    image.fill(QColor(0, 0, 0, 160));
    QPainter painter(&image);
    painter.scale(ratio, ratio);
    painter.setFont(font);
    painter.setPen(Qt::white);
    painter.drawText(QRect(QPoint(label_margin, label_margin), metrics.size(0, text)), Qt::AlignLeft | Qt::AlignVCenter,
                     text);
    return image;
}

}  // namespace pcm::host
