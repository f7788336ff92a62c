#include "pcm/view/first_view.h"

#include "pcm/cloud/numbers.h"
#include "pcm/view/value_range.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <utility>

namespace pcm {
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

double ranked(std::vector<double>& values, double share)
{
    const auto place =
        values.begin() + static_cast<std::ptrdiff_t>(std::floor(share * static_cast<double>(values.size() - 1) + 0.5));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

// Drops points that are far from almost all others: noise of scanners, birds.
void drop_far(std::vector<Vec3d>& points)
{
    Vec3d low{}, high{};
    std::vector<double> values(points.size());
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][a];
        const double first = ranked(values, 0.01), last = ranked(values, 0.99);
        low[a] = first - (last - first);
        high[a] = last + (last - first);
    }
    // Along an axis without an extent, that of the others counts.
    const double widest = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    const auto is_far = [&](const Vec3d& p) {
        for (std::size_t a = 0; a < 3; ++a)
            if (p[a] < low[a] - 0.05 * widest || p[a] > high[a] + 0.05 * widest) return true;
        return false;
    };
    points.erase(std::remove_if(points.begin(), points.end(), is_far), points.end());
}

Vec3d median_of(const std::vector<Vec3d>& points)
{
    Vec3d middle{};
    std::vector<double> values(points.size());
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][a];
        middle[a] = ranked(values, 0.5);
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

// The distance of what is seen in the centre of the picture; of all points in front, if nothing is.
double focus_of(const std::vector<Vec3d>& points, const EyePose& pose, double slope)
{
    constexpr double centre = 0.1;  // a tenth of the picture's height to each side
    std::vector<double> all, central;
    for (const Vec3d& point : points) {
        const Vec3d p = point - pose.eye;
        const double depth = -dot(pose.back, p);
        if (!(depth > 0)) continue;
        all.push_back(depth);
        if (std::hypot(dot(pose.right, p), dot(pose.up, p)) < centre * slope * depth) central.push_back(depth);
    }
    if (all.empty()) return 0;
    return ranked(central.empty() ? all : central, 0.5);
}

bool is_a_picture(const PictureShape& picture)
{
    return picture.width > 0 && picture.height > 0 && picture.covered >= 0 && 2 * picture.covered <= picture.height;
}

// Puts the eye, whose axes are given, to where the points fill the picture.
void place(EyePose& pose, const std::vector<Vec3d>& points, const PictureShape& picture)
{
    const auto [angle, width, height, covered] = picture;
    const Vec3d middle = median_of(points);
    // Half the height over the distance; above the covered part, whose middle is by `raised` higher.
    const double half = std::tan(angle / 2 * degree), hidden = static_cast<double>(covered) / height;
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
    // A single point is seen from a distance that is not lost in the rounding of its coordinates.
    const double least = extent > 0 ? std::max(0.01 * extent, 1e-9 * largest_magnitude(middle))
                                    : std::max(1e-5 * largest_magnitude(middle), 1e-6);
    const double away = std::max({least_distance(offsets, pose.back, pose.right, filled * half * width / height),
                                  least_distance(offsets, pose.back, free_up, slope),
                                  largest_but_few(depths) + least});  // not within the cloud
    const double across = centred(offsets, pose.back, pose.right, away, extent);
    const double upright = centred(offsets, pose.back, free_up, away, 2 * extent) - raised * away;
    pose.eye = middle + away * pose.back + across * pose.right + upright * pose.up;
    pose.focus = std::max(focus_of(points, pose, slope), least);
}

// --- scans ----------------------------------------------------------------------------------------------------------

std::vector<double> numbers_of(const Metadata& block)
{
    std::vector<double> numbers;
    std::string text(reinterpret_cast<const char*>(block.value.data()), block.value.size());
    const char* at = text.c_str();
    for (char* end = nullptr;; at = end) {
        const double number = std::strtod(at, &end);
        if (end == at || !std::isfinite(number)) return numbers;
        numbers.push_back(number);
    }
}

bool starts_with(const std::string& text, const char* begin) { return text.rfind(begin, 0) == 0; }

// Turns by a quaternion w x y z, which is divided by its length; the axes themselves where it has none.
void turn(ScanPose& pose, double w, double x, double y, double z)
{
    const double size = std::sqrt(w * w + x * x + y * y + z * z);
    if (!(size > 0) || !std::isfinite(size)) return;
    w /= size, x /= size, y /= size, z /= size;
    pose.x = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
    pose.y = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
    pose.z = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
}

// Programs disagree on whether the orientation has been applied to the points, as it is meant to be.
std::vector<ScanPose> poses_of_pcd(const std::vector<double>& v)
{
    if (v.size() != 7) return {};
    ScanPose plain;
    plain.eye = {v[0], v[1], v[2]};
    plain.stated = plain.eye != Vec3d{0, 0, 0};
    ScanPose turned = plain;
    turn(turned, v[3], v[4], v[5], v[6]);
    return {turned, plain};
}

// Ten lines: columns, rows, the scanner's place and axes, and a matrix for row vectors.
std::vector<ScanPose> poses_of_ptx(const std::vector<double>& v)
{
    if (v.size() != 2 + 12 + 16) return {};
    const double* const m = &v[14];
    ScanPose pose;
    pose.eye = {m[12], m[13], m[14]};
    const auto axis = [&](std::size_t row) { return Vec3d{m[4 * row], m[4 * row + 1], m[4 * row + 2]}; };
    for (std::size_t row = 0; row < 3; ++row)
        if (!(length(axis(row)) > 0)) return {};
    pose.x = normalised(axis(0));
    pose.y = normalised(axis(1));
    pose.z = normalised(axis(2));
    pose.stated = true;
    return {pose};
}

std::vector<ScanPose> poses_of_e57(const std::vector<double>& v)
{
    if (v.size() != 7) return {};
    ScanPose pose;
    pose.eye = {v[0], v[1], v[2]};
    turn(pose, v[3], v[4], v[5], v[6]);
    pose.stated = pose.eye != Vec3d{0, 0, 0} || pose.z != Vec3d{0, 0, 1} || pose.x != Vec3d{1, 0, 0};
    return pose.stated ? std::vector<ScanPose>{pose} : std::vector<ScanPose>{};
}

// Whether the points are a surface as seen from the eye: neighbours in direction are at about the same distance, and
// not at any of those that occur.
bool is_seen_from(const std::vector<Vec3d>& points, const Vec3d& eye)
{
    constexpr std::size_t most = 1500, least = 30;
    std::vector<Vec3d> directions;
    std::vector<double> distances;
    const std::size_t step = points.size() / most + 1;
    for (std::size_t i = 0; i < points.size(); i += step) {
        const Vec3d p = points[i] - eye;
        if (!(length(p) > 0)) continue;
        directions.push_back(normalised(p));
        distances.push_back(std::log(length(p)));
    }
    if (directions.size() < least) return false;
    std::vector<double> differences;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        double nearest = -2;
        std::size_t neighbour = i;
        for (std::size_t j = 0; j < directions.size(); ++j) {
            const double cosine = dot(directions[i], directions[j]);
            if (j != i && cosine > nearest) {
                nearest = cosine;
                neighbour = j;
            }
        }
        differences.push_back(std::fabs(distances[i] - distances[neighbour]));
    }
    const double spread = std::max(0.05, ranked(distances, 0.9) - ranked(distances, 0.1));
    // 0.5 % for a room seen from within; 15 % and more seen from outside, where walls are behind walls.
    const auto far = std::count_if(differences.begin(), differences.end(), [&](double d) { return d > spread / 4; });
    return 10 * static_cast<std::size_t>(far) < differences.size();
}

// The horizontal direction in which a view of this width sees most points.
Vec3d fullest_direction(const std::vector<Vec3d>& points, const Vec3d& eye, double half_width)
{
    constexpr int directions = 36;
    std::vector<double> azimuths;
    for (const Vec3d& point : points) azimuths.push_back(std::atan2(point[1] - eye[1], point[0] - eye[0]));
    double best = -1, chosen = 0;
    for (int d = 0; d < directions; ++d) {
        const double azimuth = 2 * 180 * degree * d / directions;
        double sum = 0;  // points count the more the nearer to the middle
        for (const double a : azimuths)
            sum += std::max(0.0, 1 - std::fabs(std::remainder(a - azimuth, 360 * degree)) / half_width);
        if (sum > best) {
            best = sum;
            chosen = azimuth;
        }
    }
    return {std::cos(chosen), std::sin(chosen), 0};
}

}  // namespace

std::vector<ScanPose> scan_poses(const std::vector<Metadata>& metadata)
{
    std::vector<ScanPose> poses;
    std::size_t scans = 0, e57_scans = 0;
    for (const Metadata& block : metadata) {
        const bool is_e57 = starts_with(block.key, "e57.scan/");
        if (is_e57 && !starts_with(block.key, "e57.scan/1/")) ++e57_scans;
        std::vector<ScanPose> more;
        if (block.key == "pcd.viewpoint")
            more = poses_of_pcd(numbers_of(block));
        else if (starts_with(block.key, "ptx.scan/"))
            more = poses_of_ptx(numbers_of(block));
        else if (is_e57 && block.key.size() > 5 && block.key.compare(block.key.size() - 5, 5, "/pose") == 0)
            more = poses_of_e57(numbers_of(block));
        else
            continue;
        ++scans;
        poses = std::move(more);
    }
    return scans == 1 && e57_scans == 0 ? poses : std::vector<ScanPose>{};
}

std::optional<EyePose> view_of_scan(const std::vector<Vec3d>& points, const ScanPose& scan, const PictureShape& picture)
{
    if (!is_a_picture(picture) || !is_seen_from(points, scan.eye)) return std::nullopt;
    std::size_t before = 0, ahead = 0;
    Vec3d least = points.front(), most = points.front();
    for (const Vec3d& point : points) {
        const Vec3d p = point - scan.eye;
        before += dot(scan.z, p) > 0.5 * length(p);
        for (std::size_t a = 0; a < 3; ++a) {
            least[a] = std::min(least[a], point[a]);
            most[a] = std::max(most[a], point[a]);
        }
    }
    const double slope = std::tan(picture.angle / 2 * degree);
    EyePose pose;
    pose.eye = scan.eye;
    if (before >= points.size() - points.size() / 50) {
        pose.back = -1.0 * scan.z;
        pose.up = -1.0 * scan.y;
    } else {
        if (!scan.stated) return std::nullopt;
        const double half_width = std::atan(slope * picture.width / picture.height);
        pose.back = -1.0 * fullest_direction(points, scan.eye, half_width);
        pose.up = {0, 0, 1};
    }
    pose.right = normalised(cross(pose.up, pose.back));
    pose.up = cross(pose.back, pose.right);
    for (const Vec3d& point : points) ahead += dot(pose.back, point - scan.eye) < 0;
    if (ahead < points.size() / 10) return std::nullopt;
    pose.focus = std::max(focus_of(points, pose, slope), 1e-6 * length(most - least));
    // A single thing, cut out of what the instrument saw, is seen from the same side and fills the picture.
    EyePose near = pose;
    place(near, points, picture);
    return dot(pose.back, near.eye - pose.eye) < -0.5 * pose.focus ? near : pose;
}

std::optional<EyePose> view_from_above(std::vector<Vec3d> points, const PictureShape& picture)
{
    if (points.empty() || !is_a_picture(picture)) return std::nullopt;
    drop_far(points);
    EyePose pose;
    pose.back = normalised({-0.5, -1, 0.8});
    pose.right = normalised(cross({0, 0, 1}, pose.back));
    pose.up = cross(pose.back, pose.right);
    place(pose, points, picture);
    return pose;
}

std::optional<EyePose> first_view(const std::vector<Vec3d>& points, const std::vector<ScanPose>& poses,
                                  const PictureShape& picture)
{
    for (const ScanPose& pose : poses)
        if (auto view = view_of_scan(points, pose, picture)) return view;
    return view_from_above(points, picture);
}

std::vector<Vec3d> sampled_places(L2Cache& cache)
{
    std::vector<Vec3d> places;
    const Grid& grid = cache.tree().info().grid;
    for (const SampledChunk& sampled : coarsest_chunks(cache.tree())) {
        ColumnSet columns;
        columns.positions = true;
        const L2Cache::Handle chunk = cache.get(sampled.node, columns);
        const std::size_t points = std::min(sampled.points, chunk->points);
        for (std::size_t i = 0; i < points; ++i) {
            Vec3d place{};
            for (unsigned a = 0; a < 3; ++a) place[a] = grid.to_source(chunk->positions->grid(i, a), a);
            places.push_back(place);
        }
    }
    return places;
}

}  // namespace pcm
