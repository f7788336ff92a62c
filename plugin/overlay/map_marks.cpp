#include "plugin/overlay/map_marks.h"

#include "pcm/cloud/vector.h"
#include "pcm/view/screen_map.h"

#include <QFontMetrics>
#include <QGuiApplication>
#include <QPainter>
#include <QPolygonF>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr double most_tilt = 2 * pi / 180;           // from the vertical, in a plan view
constexpr double least_across = 0.1;                 // share of an arrow to north
constexpr double most_lines = 200;                   // per direction of a grid
constexpr int bar_margin = 6, scale_bar_height = 6;  // Qt's pixels
constexpr double arrow = 44;                         // size of its image, Qt's pixels

// The place at a height on the line of sight through a place of the picture, of a view that looks down.
Vec3d at_height(const ScreenMap& map, double x, double y, double height)
{
    const Vec3d near = map.source_of({x, y, -1}), far = map.source_of({x, y, 1});
    const double t = (height - near[2]) / (far[2] - near[2]);
    return {near[0] + t * (far[0] - near[0]), near[1] + t * (far[1] - near[1]), height};
}

// Where the segment meets the border of the picture: its two ends in there. Nothing if it is outside.
std::optional<std::array<QPointF, 2>> ends_in(const Camera& camera, const ScreenMap& map,
                                              const std::array<Vec3d, 2>& line)
{
    const auto part = map.clipped(map.eye_of(line[0]), map.eye_of(line[1]), 0);
    if (!part) return std::nullopt;
    const Vec3d a = map.window_of(part->first), b = map.window_of(part->second);
    const auto inside = [&](const Vec3d& p) {
        return QPointF(std::clamp(p[0], 0.0, double(camera.width)), std::clamp(p[1], 0.0, double(camera.height)));
    };
    return std::array<QPointF, 2>{inside(a), inside(b)};
}

}  // namespace

double round_length(double most)
{
    double power = std::pow(10, std::floor(std::log10(most)));
    if (10 * power <= most) power *= 10;
    for (const double factor : {5.0, 2.0, 1.0})
        if (factor * power <= most) return factor * power;
    return 0.5 * power;
}

QString step_text(double value, double step)
{
    const int decimals = std::clamp(-static_cast<int>(std::floor(std::log10(step) + 1e-9)), 0, 300);
    const QString text = QString::number(value, 'f', decimals);
    return text.contains(QRegExp("[1-9]")) ? text : QString::number(0.0, 'f', decimals);  // not -0
}

std::optional<ScaleBar> scale_bar(const Camera& camera, double depth, double most_pixels)
{
    const auto map = ScreenMap::of(camera);
    if (!map) return std::nullopt;
    const double unit = map->pixel_at({0, 0, -depth}) / map->scale();  // source units per pixel
    const double most = unit * most_pixels;
    if (!(most > 0) || !std::isfinite(most)) return std::nullopt;
    const double length = round_length(most);
    return ScaleBar{length, length / unit};
}

std::optional<std::array<double, 2>> north(const Camera& camera)
{
    const auto map = ScreenMap::of(camera);
    if (!map) return std::nullopt;
    const Vec3d direction = map->eye_direction({0, 1, 0}) / map->scale();
    if (std::hypot(direction[0], direction[1]) < least_across) return std::nullopt;
    return std::array<double, 2>{direction[0], direction[1]};
}

std::optional<PlanGrid> plan_grid(const Camera& camera, double depth, double least_pixels)
{
    const auto map = ScreenMap::of(camera);
    if (!map || !map->orthographic()) return std::nullopt;
    const Vec3d up = map->eye_direction({0, 0, 1});
    if (!(up[2] >= std::cos(most_tilt) * length(up))) return std::nullopt;
    const double unit = map->pixel_at({0, 0, -depth}) / map->scale(), least = unit * least_pixels;
    if (!(least > 0) || !std::isfinite(least)) return std::nullopt;
    PlanGrid grid;
    grid.step = round_length(2.5 * least);  // round numbers are at most 2.5 times as large as the ones before
    const double height = map->source_of(map->window_of({0, 0, -depth}))[2];
    Box3d seen;
    for (const double x : {0.0, double(camera.width)})
        for (const double y : {0.0, double(camera.height)}) seen.extend(at_height(*map, x, y, height));
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double first = std::ceil(seen.min[axis] / grid.step), last = std::floor(seen.max[axis] / grid.step);
        if (!(last - first <= most_lines)) return std::nullopt;
        for (double k = first; k <= last; ++k) {
            std::array<Vec3d, 2> line{seen.min, seen.max};
            for (Vec3d& end : line) {
                end[axis] = k * grid.step;
                end[2] = height;
            }
            const auto ends = ends_in(camera, *map, line);
            if (!ends) continue;
            grid.lines.push_back(line);
            // At the upper border, and at the left one.
            const bool second = axis == 0 ? (*ends)[1].y() > (*ends)[0].y() : (*ends)[1].x() < (*ends)[0].x();
            grid.labels.emplace_back((axis == 0 ? "x " : "y ") + step_text(k * grid.step, grid.step),
                                     (*ends)[second ? 1 : 0]);
        }
    }
    return grid;
}

QImage scale_bar_image(const ScaleBar& bar, const QString& unit, double ratio)
{
    const QFont font = QGuiApplication::font();
    const QFontMetrics metrics(font);
    const QString text = step_text(bar.length, bar.length) + " " + unit;
    const double wide = bar.pixels / ratio;
    const double width = std::max<double>(wide, metrics.horizontalAdvance(text)) + 2 * bar_margin;
    const double height = metrics.height() + scale_bar_height + 3 * bar_margin;
    QImage image(int(std::ceil(width * ratio)), int(std::ceil(height * ratio)), QImage::Format_RGBA8888);
    image.fill(QColor(0, 0, 0, 128));
    QPainter painter(&image);
    painter.scale(ratio, ratio);
    painter.setFont(font);
    painter.setPen(Qt::white);
    painter.drawText(QRectF(bar_margin, bar_margin, width, metrics.height()), Qt::AlignLeft | Qt::AlignVCenter, text);
    const double top = metrics.height() + 2 * bar_margin;
    painter.fillRect(QRectF(bar_margin, top, wide, scale_bar_height), Qt::white);
    painter.fillRect(QRectF(bar_margin + wide / 2, top + 1, wide / 2 - 1, scale_bar_height - 2), Qt::black);
    return image;
}

QImage north_image(const std::array<double, 2>& direction, double ratio)
{
    const int size = int(std::ceil(arrow * ratio));
    QImage image(size, size, QImage::Format_RGBA8888);
    image.fill(QColor(0, 0, 0, 128));
    QPainter painter(&image);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.scale(ratio, ratio);
    painter.translate(arrow / 2, arrow / 2);
    const QPointF along(direction[0], -direction[1]);  // y of images points down
    const double across = std::hypot(along.x(), along.y());
    const QPointF beside(-along.y() / across, along.x() / across);
    QPolygonF shape;
    shape << along * 11 << along * -13 + beside * 7 << along * -8 << along * -13 - beside * 7;
    painter.setPen(Qt::NoPen);
    painter.setBrush(Qt::white);
    painter.drawPolygon(shape);
    QFont font = QGuiApplication::font();
    font.setBold(true);
    painter.setFont(font);
    painter.setPen(Qt::white);
    const QPointF letter = along / across * 16;
    painter.drawText(QRectF(letter.x() - 10, letter.y() - 10, 20, 20), Qt::AlignCenter, "N");
    return image;
}

}  // namespace pcm::host
