#include "plugin/overlay/map_overlay.h"

#include "pcm/cloud/vector.h"
#include "plugin/overlay/blend_image.h"
#include "plugin/overlay/label_places.h"
#include "plugin/overlay/map_marks.h"

#include <cmath>
#include <map>

namespace pcm::host {

namespace {

// Qt's pixels.
constexpr double most_bar = 160, grid_distance = 100;
constexpr int border = 8, text_height = 120;  // text_height: of MeshLab's own text
const std::array<float, 4> grid_colour{1, 1, 1, 0.35f};

}  // namespace

// As in meshlab/trackball_pose.h.
double distance_to_pivot(float fov) { return fov <= 5 ? 8 : 1.75 / std::tan(static_cast<double>(fov) * pi / 360); }

void MapOverlay::draw(const Camera& camera, const SnapshotTile& tile, double depth, const std::string& unit,
                      const MapSettings& settings, double ratio, bool above_text)
{
    const Camera& whole = tile.whole;
    const auto blend = [&](const QImage& image, int x, int y) {
        blend_image(image, x - tile.corner.x(), y - tile.corner.y());
    };
    if (settings.grid)
        if (const auto grid = plan_grid(whole, depth, grid_distance * ratio)) {
            std::vector<SceneLine> lines;
            for (const auto& line : grid->lines)
                lines.push_back({{line[0], line[1]}, false, grid_colour, 1 * ratio, 1});
            lines_.draw(camera, lines, {});
            std::map<QString, QImage> images;
            std::map<QString, QSize> sizes;
            for (const auto& [text, place] : grid->labels) {
                images[text] = label_image(text, ratio);
                sizes[text] = images[text].size();
            }
            for (const PlacedLabel& label : place_labels(grid->labels, sizes, QSize(whole.width, whole.height)))
                blend(images[label.text], label.place.x(), label.place.y());
        }
    int x = static_cast<int>(border * ratio);
    const int y = static_cast<int>((border + (above_text ? text_height : 0)) * ratio);
    const auto put = [&](const QImage& image) {
        if (x + image.width() > whole.width || y + image.height() > whole.height) return;
        blend(image, x, y);
        x += image.width() + static_cast<int>(border * ratio);
    };
    if (settings.scale_bar)
        if (const auto bar = scale_bar(whole, depth, most_bar * ratio))
            put(scale_bar_image(*bar, QString::fromStdString(unit), ratio));
    if (settings.north)
        if (const auto direction = north(whole)) put(north_image(*direction, ratio));
}

}  // namespace pcm::host
