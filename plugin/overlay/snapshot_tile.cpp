#include "plugin/overlay/snapshot_tile.h"

#include "pcm/cloud/vector.h"

#include <cmath>

namespace pcm::host {

namespace {

constexpr double most_magnified = 1000;

}  // namespace

SnapshotTile tile_of(const Camera& camera, float fov)
{
    SnapshotTile tile;
    tile.whole = camera;
    // The vertical scale of the whole view depends on the fov alone.
    const double scale = fov <= 5 ? 1 / 1.75 : 1 / std::tan(static_cast<double>(fov) * pi / 360);
    const double times = std::round(camera.projection[5] / scale);
    if (!(times > 1 && times <= most_magnified)) return tile;
    tile.magnified = times;
    tile.whole.width = static_cast<int>(camera.width * times);
    tile.whole.height = static_cast<int>(camera.height * times);
    // In normalised device coordinates a tile shows x as times * x + shift; the whole view is symmetric.
    Matrix4d& projection = tile.whole.projection;
    const bool parallel = projection[11] == 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        double& across = projection[(parallel ? 12 : 8) + axis];
        const double shift = parallel ? across : -across;
        const double number = std::round((times - 1 - shift) / 2);  // place of the tile, from the left or from below
        (axis == 0 ? tile.corner.rx() : tile.corner.ry()) =
            static_cast<int>(number) * (axis == 0 ? camera.width : camera.height);
        projection[5 * axis] /= times;
        across = 0;
    }
    return tile;
}

}  // namespace pcm::host
