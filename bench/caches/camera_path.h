// A camera's way through a cloud, a frame at a time. The file format is described in bench/README.md.
#pragma once

#include "cloud/geometry.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm::bench {

struct CameraFrame {
    Vec3d eye{}, target{}, up{0, 0, 1};  // source coordinates once placed() was called
    std::optional<double> angle;         // of view, from bottom to top, degrees; absent: orthographic
    double height = 0;                   // orthographic: of what is seen, source units
    bool rest = false;                   // the camera stays until the picture is complete
};

struct CameraPath {
    std::string name;
    bool in_box = false;  // coordinates of the cloud's box, see placed()
    std::vector<CameraFrame> frames;

    // Throws std::runtime_error, saying which frame and what is wrong.
    static CameraPath read(const std::filesystem::path& file);

    // In source coordinates. Of a path in a box's coordinates, x and y go from -1 to 1 across the box, and z counts from its bottom
    // in halves of its longest side, as heights do.
    CameraPath placed(const Box3d& box) const;
};

}  // namespace pcm::bench
