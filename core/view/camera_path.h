// A camera path through a cloud, frame by frame, and its file format:
//
//     {"format": "pcm camera path", "version": 1, "name": "tour", "coordinates": "source", "frames": [
//      {"eye": [500010, 4800020, 131.5], "target": [500050, 4800050, 120], "up": [0, 0, 1], "angle": 60},
//      {"eye": [500050, 4800050, 400], "target": [500050, 4800050, 0], "up": [0, 1, 0], "height": 250, "rest": true}]}
//
// `angle` is the vertical angle of view in degrees; `height` instead makes the frame orthographic and gives the visible
// height. `up` defaults to the z axis, `name` to the name of the file; a frame may have a `name` of its own. At a frame
// with `rest` the camera stays until the picture is complete. `"coordinates": "box"` makes a path that fits any cloud:
// x and y go from -1 to 1 across its box; z is the height above the box's bottom in halves of its longest side, the
// unit of `height` too.
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
    std::optional<double> angle;         // vertical angle of view, degrees; absent: orthographic
    double height = 0;                   // orthographic: visible height, source units
    bool rest = false;                   // the camera stays until the picture is complete
    std::string name;                    // name of a bookmark; may be empty
};

// Throws Error(invalid_argument) for numbers that are not coordinates (cloud/coordinates.h), an
// angle that is not between 0 and 180 degrees, a height that is not above 0, an eye equal to the target, an `up`
// parallel to the direction of view.
void check(const CameraFrame& frame);

struct CameraPath {
    std::string name;
    bool in_box = false;  // in the coordinates of the cloud's box, see placed()
    std::vector<CameraFrame> frames;

    // Throws Error(not_found | permission | io | bad_format), which names the fault and the frame.
    static CameraPath read(const std::filesystem::path& file);
    // The same of a file's text; `source` is what it is called in errors.
    static CameraPath of_text(const std::string& text, const std::filesystem::path& source);
    // What read() reads back: all digits, in the coordinates of in_box.
    std::string text() const;

    // The path in source coordinates; a path in box coordinates is placed in `box`.
    CameraPath placed(const Box3d& box) const;
};

// The camera of a picture of width x height pixels, relative to `origin`. The near and the far plane enclose `box`, and
// splats that curve away behind it by up to a twentieth of its size, but the near plane is never nearer than 1/20000 of
// the far plane or a tenth of the way to the target: what is closer than both is clipped. `frame` is in source
// coordinates, and passes check().
Camera view_of(const CameraFrame& frame, const Vec3d& origin, const Box3d& box, int width, int height);

// The whole box seen obliquely from above, with a vertical angle of view in degrees or, without one, orthographically;
// it fills the picture up to a margin of 5 %.
CameraFrame overview_of(const Box3d& box, const std::optional<double>& angle, int width, int height);

}  // namespace pcm
