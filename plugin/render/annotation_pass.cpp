#include "plugin/render/annotation_pass.h"

#include "pcm/view/screen_map.h"
#include "plugin/render/blend_image.h"

#include <QFontMetrics>
#include <QGuiApplication>
#include <QPainter>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr double cross_px = 11;           // Qt's pixels
constexpr float faint = 0.25f;            // opacity of what is behind points
constexpr int label_distance = 8;         // from its anchor, pixels of the screen
constexpr int label_margin = 4;           // within its box, Qt's pixels
constexpr std::size_t most_images = 512;  // kept

std::array<float, 4> colour_of(const QColor& colour)
{
    return {static_cast<float>(colour.redF()), static_cast<float>(colour.greenF()), static_cast<float>(colour.blueF()),
            static_cast<float>(colour.alphaF())};
}

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
        for (const QPoint& corner :
             {QPoint(right, above), QPoint(right, below), QPoint(left, above), QPoint(left, below)})
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

const QImage& AnnotationPass::image_of(const QString& text, double ratio)
{
    if (ratio != ratio_ || images_.size() >= most_images) images_.clear();
    ratio_ = ratio;
    QImage& image = images_[text];
    if (image.isNull()) image = label_image(text, ratio);
    return image;
}

void AnnotationPass::draw(const MeshDocument& document, const Camera& camera, double ratio, double magnified)
{
    const auto& all = Annotations::of(const_cast<MeshDocument&>(document)).all();
    const auto map = ScreenMap::of(camera);
    if (all.empty() || !map) return;
    std::vector<SceneLine> lines;
    std::vector<SceneMark> marks;
    std::vector<std::pair<QString, QPointF>> anchors;
    std::map<QString, QSize> sizes;
    const double scale = ratio * magnified;
    for (const auto& [owner, annotations] : all)
        for (const Annotation& annotation : annotations) {
            const auto colour = colour_of(annotation.colour);
            const float hidden = annotation.on_top ? 1 : faint;
            const double width = annotation.width_px * scale;
            if (annotation.line.size() > 1)
                lines.push_back({annotation.line, annotation.closed, colour, width, hidden});
            for (const Vec3d& mark : annotation.marks) marks.push_back({mark, cross_px * scale, colour, width, hidden});
            if (annotation.label.isEmpty() || magnified != 1) continue;
            if (const auto place = map->place_of(annotation.label_at)) {
                anchors.emplace_back(annotation.label, QPointF((*place)[0], (*place)[1]));
                sizes[annotation.label] = image_of(annotation.label, ratio).size();
            }
        }
    lines_.draw(camera, lines, marks);
    for (const PlacedLabel& label : place_labels(anchors, sizes, QSize(camera.width, camera.height)))
        blend_image(image_of(label.text, ratio), label.place.x(), label.place.y());
}

}  // namespace pcm::host
