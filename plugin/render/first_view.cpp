#include "plugin/render/first_view.h"

#include "pcm/cloud/vector.h"
#include "plugin/host/trackball_pose.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcm::host {

namespace {

constexpr double filled = 0.85;
constexpr std::size_t one_outside_in = 500;

// The value that a share of 1/one_outside_in exceeds.
double largest_but_few(std::vector<double>& values)
{
    const auto place = values.end() - static_cast<std::ptrdiff_t>(values.size() / one_outside_in) - 1;
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

double median(std::vector<double>& values)
{
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

Vec3d median_of(const std::vector<Vec3d>& points)
{
    Vec3d middle{};
    std::vector<double> values(points.size());
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][a];
        middle[a] = median(values);
    }
    return middle;
}

// At a distance `away` from the plane of the middle and shifted by `shift` along `axis`, the eye sees a point p when
//     |p.axis - shift| <= (away - p.back) * slope.
// For each sign the largest p.back +- p.axis / slope bounds `away`, which is least when the shift makes both bounds
// equal.
double least_distance(const std::vector<Vec3d>& offsets, const Vec3d& back, const Vec3d& axis, double slope)
{
    std::vector<double> positive, negative;
    for (const Vec3d& p : offsets) {
        positive.push_back(dot(back, p) + dot(axis, p) / slope);
        negative.push_back(dot(back, p) - dot(axis, p) / slope);
    }
    return (largest_but_few(positive) + largest_but_few(negative)) / 2;
}

// The shift within `most` with which the points reach equally far to both sides in the picture, when the eye is farther
// away than they need along this axis.
double centred(const std::vector<Vec3d>& offsets, const Vec3d& back, const Vec3d& axis, double away, double most)
{
    double low = -most, high = most;
    std::vector<double> positive, negative;
    for (int step = 0; step < 20; ++step) {
        const double shift = (low + high) / 2;
        positive.clear();
        negative.clear();
        for (const Vec3d& p : offsets) {
            const double seen = (dot(axis, p) - shift) / std::max(away - dot(back, p), 1e-3 * away);
            positive.push_back(seen);
            negative.push_back(-seen);
        }
        (largest_but_few(positive) > largest_but_few(negative) ? low : high) = shift;
    }
    return (low + high) / 2;
}

// The distance of what is seen in the centre of the picture; of all points, if nothing is.
double focus_of(const std::vector<Vec3d>& points, const EyePose& pose, double slope)
{
    constexpr double centre = 0.1;  // a tenth of the picture's height to each side
    std::vector<double> all, central;
    for (const Vec3d& point : points) {
        const Vec3d p = point - pose.eye;
        const double depth = -dot(pose.back, p);
        all.push_back(depth);
        if (std::hypot(dot(pose.right, p), dot(pose.up, p)) < centre * slope * depth) central.push_back(depth);
    }
    return median(central.empty() ? all : central);
}

}  // namespace

std::vector<Vec3d> placed_vertices(const MeshModel& layer)
{
    std::vector<Vec3d> points;
    for (const CVertexO& vertex : layer.cm.vert) {
        if (vertex.IsD()) continue;
        const Point3m p = layer.cm.Tr * vertex.cP();
        points.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    }
    return points;
}

std::optional<vcg::Similarityf> first_view(const std::vector<Vec3d>& points, float fov, int width, int height,
                                           int covered)
{
    if (points.empty() || width < 1 || height < 1 || covered < 0 || 2 * covered > height || is_orthographic(fov))
        return std::nullopt;
    EyePose pose;
    pose.back = normalised({-0.5, -1, 0.8});
    pose.right = normalised(cross({0, 0, 1}, pose.back));
    pose.up = cross(pose.back, pose.right);
    const Vec3d middle = median_of(points);
    // Half the height over the distance; above the covered part, whose middle is by `raised` higher.
    const double half = std::tan(static_cast<double>(fov) * pi / 360), hidden = static_cast<double>(covered) / height;
    const double slope = filled * half * (1 - hidden), raised = half * hidden;
    // A point is as far above the middle of the free part as it is above that of the picture along this axis.
    const Vec3d free_up = pose.up + raised * pose.back;
    std::vector<Vec3d> offsets;
    std::vector<double> depths, distances;
    for (const Vec3d& point : points) {
        offsets.push_back(point - middle);
        depths.push_back(dot(pose.back, offsets.back()));
        distances.push_back(length(offsets.back()));
    }
    const double extent = largest_but_few(distances);
    // A single point is seen from a distance that is a number beside its coordinates.
    const double least = std::max({0.01 * extent, 1e-5 * largest_magnitude(middle), 1e-6});
    const double away = std::max({least_distance(offsets, pose.back, pose.right, filled * half * width / height),
                                  least_distance(offsets, pose.back, free_up, slope),
                                  largest_but_few(depths) + least});  // not within the cloud
    const double across = centred(offsets, pose.back, pose.right, away, extent);
    const double upright = centred(offsets, pose.back, free_up, away, 2 * extent) - raised * away;
    pose.eye = middle + away * pose.back + across * pose.right + upright * pose.up;
    pose.focus = std::max(focus_of(points, pose, slope), least);
    return trackball_of(pose, fov);
}

}  // namespace pcm::host
