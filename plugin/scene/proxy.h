// The sample of a cloud that MeshLab itself gets as vertices of the layer.
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
    Vec3d origin{};         // zero of the positions, in source coordinates
    bool has_rgb = false;   // the cloud has rgb, and not all sampled points are black (in many LAS files all are)
    double spacing = 0;     // every point of the cloud has a point of the sample about this near; 0 if is_whole
    bool is_whole = false;  // these are all points of the cloud
};

inline constexpr std::uint64_t proxy_points = 50'000;

// All points of a cloud that has no more than `most`. Else an even sample of at most `most` points, plus those of the
// cloud's extreme points that it lacks, each once, so that it has the cloud's bounding box: MeshLab takes the far plane
// and the centre of rotation from it. Colours are those of the renderer: rgb, else
// intensity, else grey. Reads only the coarsest levels. Throws what reading chunks throws.
Proxy make_proxy(PointCloud& cloud, const Vec3d& origin, std::uint64_t most = proxy_points);

// RGB of each value of `column`, an rgb or an intensity attribute of a cloud or of a sample of it.
std::vector<std::array<std::uint8_t, 3>> colours_of(const Column& column, bool is_rgb);
bool is_black(const Column& column);

}  // namespace pcm::host
