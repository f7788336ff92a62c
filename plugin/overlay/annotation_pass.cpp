#include "plugin/overlay/annotation_pass.h"

#include "pcm/view/screen_map.h"
#include "plugin/overlay/blend_image.h"

#include <array>

namespace pcm::host {

namespace {

constexpr double cross_px = 11;           // Qt's pixels
constexpr float faint = 0.25f;            // opacity of what is behind points
constexpr std::size_t most_images = 512;  // kept

std::array<float, 4> colour_of(const QColor& colour)
{
    return {static_cast<float>(colour.redF()), static_cast<float>(colour.greenF()), static_cast<float>(colour.blueF()),
            static_cast<float>(colour.alphaF())};
}

}  // namespace

const QImage& AnnotationPass::image_of(const QString& text, double ratio)
{
    if (ratio != ratio_ || images_.size() >= most_images) images_.clear();
    ratio_ = ratio;
    QImage& image = images_[text];
    if (image.isNull()) image = label_image(text, ratio);
    return image;
}

void AnnotationPass::draw(Scene& scene, const Camera& camera, const SnapshotTile& tile, double ratio)
{
    const auto& all = scene.part<Annotations>().all();
    const auto map = ScreenMap::of(tile.whole);
    if (all.empty() || !map) return;
    std::vector<SceneLine> lines;
    std::vector<SceneMark> marks;
    std::vector<std::pair<QString, QPointF>> anchors;
    std::map<QString, QSize> sizes;
    for (const auto& [owner, annotations] : all)
        for (const Annotation& annotation : annotations) {
            const auto colour = colour_of(annotation.colour);
            const float hidden = annotation.on_top ? 1 : faint;
            const double width = annotation.width_px * ratio;
            if (annotation.line.size() > 1)
                lines.push_back({annotation.line, annotation.closed, colour, width, hidden});
            for (const Vec3d& mark : annotation.marks) marks.push_back({mark, cross_px * ratio, colour, width, hidden});
            if (annotation.label.isEmpty()) continue;
            if (const auto place = map->place_of(annotation.label_at)) {
                anchors.emplace_back(annotation.label, QPointF((*place)[0], (*place)[1]));
                sizes[annotation.label] = image_of(annotation.label, ratio).size();
            }
        }
    lines_.draw(camera, lines, marks);
    for (const PlacedLabel& label : place_labels(anchors, sizes, QSize(tile.whole.width, tile.whole.height)))
        blend_image(image_of(label.text, ratio), label.place.x() - tile.corner.x(), label.place.y() - tile.corner.y());
}

}  // namespace pcm::host
