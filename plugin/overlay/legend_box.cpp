#include "plugin/overlay/legend_box.h"

#include "plugin/overlay/blend_image.h"

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr int distance = 8;       // from the view's border, Qt's pixels
constexpr int info_height = 120;  // MeshLab's own text at the bottom of the view

}  // namespace

void LegendBox::draw(const std::vector<LayerLegend>& legends, const QSize& view, double ratio, const QPoint& corner)
{
    picture_ = draw_legends(legends, std::max(0, view.height() - info_height), ratio);
    if (picture_.image.isNull()) return;
    const QSize size = picture_.image.size();
    const int width = static_cast<int>(std::ceil(size.width() / ratio));
    corner_ = QPoint(std::max(0, view.width() - distance - width), distance);
    blend_image(picture_.image, static_cast<int>(corner_.x() * ratio) - corner.x(),
                static_cast<int>((view.height() - corner_.y()) * ratio) - size.height() - corner.y());
}

std::optional<unsigned> LegendBox::class_at(const QPoint& place) const
{
    for (const auto& [row, number] : picture_.classes)
        if (row.contains(place - corner_)) return number;
    return std::nullopt;
}

std::vector<LegendPicture::Bar> LegendBox::bars() const
{
    std::vector<LegendPicture::Bar> bars = picture_.bars;
    for (LegendPicture::Bar& bar : bars) bar.place.translate(corner_);
    return bars;
}

}  // namespace pcm::host
