// The few points of a cloud that MeshLab itself gets to see.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/point_cloud.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcm::host {

struct ProxyPoint {
    std::array<float, 3> position{};  // source coordinates minus the origin
    std::array<std::uint8_t, 3> colour{};
};

struct Proxy {
    std::vector<ProxyPoint> points;
    bool has_rgb = false;  // there is an rgb attribute, and it is not black throughout (many LAS files' is)
};

inline constexpr std::uint64_t proxy_points = 50'000;

// An even sample of at most `most` points, and the extreme ones, so that its box is the cloud's own: MeshLab takes the
// far plane and the centre of rotation from it. Colours are those that the renderer shows: rgb, else intensity, else
// grey. Reads the coarsest levels only. Errors: those of reading chunks.
Proxy make_proxy(PointCloud& cloud, const Vec3d& origin, std::uint64_t most = proxy_points);

// Colours of `column`, which is an rgb or an intensity attribute of one cloud or a sample of it: 3 bytes a point.
std::vector<std::array<std::uint8_t, 3>> colours_of(const Column& column, bool is_rgb);
bool is_black(const Column& column);

}  // namespace pcm::host
