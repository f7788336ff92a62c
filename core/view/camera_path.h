// A camera's way through a cloud, a frame at a time, and the file that keeps it:
//
//     {"format": "pcm camera path", "version": 1, "name": "tour", "coordinates": "source", "frames": [
//      {"eye": [500010, 4800020, 131.5], "target": [500050, 4800050, 120], "up": [0, 0, 1], "angle": 60},
//      {"eye": [500050, 4800050, 400], "target": [500050, 4800050, 0], "up": [0, 1, 0], "height": 250, "rest": true}]}
//
// `angle` is the angle of view from bottom to top, in degrees; `height` instead makes the frame orthographic, so many
// units high. `up` may be left out when it is the z axis, `name` when it is the file's. At a frame with `rest` the
// camera stays until the picture is complete. `"coordinates": "box"` makes a path that fits any cloud: x and y go from
// -1 to 1 across its box, z counts from the box's bottom in halves of its longest side, as `height` does.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/view/camera.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct CameraFrame {
    Vec3d eye{}, target{}, up{0, 0, 1};  // source coordinates once placed() was called
    std::optional<double> angle;         // of view, from bottom to top, degrees; absent: orthographic
    double height = 0;                   // orthographic: of what is seen, source units
    bool rest = false;                   // the camera stays until the picture is complete
};

// Throws Error(invalid_argument), saying what is wrong: numbers that are not finite, an angle that is not between 0 and
// 180 degrees, a height that is not above 0, an eye that is the target, an `up` along the view.
void check(const CameraFrame& frame);

struct CameraPath {
    std::string name;
    bool in_box = false;  // coordinates of the cloud's box, see placed()
    std::vector<CameraFrame> frames;

    // Throws Error(not_found | permission | io | bad_format), which says at which frame and what is wrong.
    static CameraPath read(const std::filesystem::path& file);

    // In source coordinates. Of a path in a box's coordinates, the box's.
    CameraPath placed(const Box3d& box) const;
};

// What a camera sees in a picture of width x height pixels, relative to `origin`. The near and the far plane enclose
// `box`, but the near one is never nearer than 1/20000 of the far one: what is closer is cut off. `frame` is in source
// coordinates, and check() passes it.
Camera view_of(const CameraFrame& frame, const Vec3d& origin, const Box3d& box, int width, int height);

// The whole box, seen obliquely from above, by an angle of view in degrees or, without one, orthographically; filling
// the picture but for a margin of 5 %.
CameraFrame overview_of(const Box3d& box, const std::optional<double>& angle, int width, int height);

}  // namespace pcm
