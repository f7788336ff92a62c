// A camera: where points appear in a picture.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/matrix.h"

namespace pcm {

struct Camera {
    Matrix4d modelview{};   // affine and invertible; maps (source - origin) to eye space, eye at 0, looking down -z
    Matrix4d projection{};  // perspective (also off-axis) or orthographic; clip volume -w <= x, y, z <= w
    Vec3d origin{0, 0, 0};  // source coordinates of the local origin
    int width = 0;          // viewport, pixels
    int height = 0;
};

}  // namespace pcm
