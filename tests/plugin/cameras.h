// Cameras of views for tests of tools.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/view/camera.h"

#include <cmath>

namespace pcm::test {

// 800 x 600 pixels, 10 units before `target`, looking obliquely down; from 0.5 to 100 units.
inline Camera camera_at(const Vec3d& target, bool parallel)
{
    const Vec3d back = normalised(Vec3d{0.5, -0.7, 0.6}), right = normalised(cross({0, 0, 1}, back));
    const Vec3d up = cross(back, right);
    Camera camera;
    camera.origin = target;
    const Vec3d rows[3] = {right, up, back};
    camera.modelview = identity_matrix;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) camera.modelview[c * 4 + r] = rows[r][c];
    camera.modelview[14] = -10;
    constexpr double near = 0.5, far = 100, aspect = 800.0 / 600, half = 5;
    camera.projection = Matrix4d{};
    if (parallel) {
        camera.projection[0] = 1 / (half * aspect);
        camera.projection[5] = 1 / half;
        camera.projection[10] = -2 / (far - near);
        camera.projection[14] = -(far + near) / (far - near);
        camera.projection[15] = 1;
    } else {
        camera.projection[0] = 1.7 / aspect;
        camera.projection[5] = 1.7;
        camera.projection[8] = 0.05;  // off-axis
        camera.projection[10] = -(far + near) / (far - near);
        camera.projection[11] = -1;
        camera.projection[14] = -2 * far * near / (far - near);
    }
    camera.width = 800;
    camera.height = 600;
    return camera;
}

}  // namespace pcm::test
