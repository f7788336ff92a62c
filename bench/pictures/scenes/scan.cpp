#include "bench/pictures/scenes/scan.h"

#include "pcm/io/writer.h"
#include "pcm/threads/for_each_index.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcm::bench {

using namespace scene;

namespace {

constexpr double noise = 0.003;      // standard deviation of the range, metres
constexpr double grid_step = 0.001;  // step of the file's coordinates, metres

// The rays of one scanner as lines and steps along a line, both from 0 to 1: equally spaced in angle (tripod), or along
// the way and across it on the ground (flight).
struct Rays {
    const Scanner& scanner;
    double lines = 0, steps = 0;  // lengths of both directions in one unit: radians, metres

    explicit Rays(const Scanner& s) : scanner(s)
    {
        lines = s.flies() ? length(s.to - s.from) : (s.right - s.left) * pi / 180;
        steps = s.flies() ? 2 * s.from[2] * std::tan(s.highest * pi / 180) : (s.highest - s.lowest) * pi / 180;
    }
    void at(double line, double step, Vec3d& from, Vec3d& direction) const
    {
        if (scanner.flies()) {
            const Vec3d way = scanner.to - scanner.from;
            const Vec3d aside = unit(cross(way, {0, 0, 1}));
            from = scanner.from + line * way;
            direction = unit((step - 0.5) * steps * aside - Vec3d{0, 0, scanner.from[2]});
        } else {
            const double azimuth = (scanner.left + line * (scanner.right - scanner.left)) / 360;
            const double elevation = (scanner.lowest + step * (scanner.highest - scanner.lowest)) / 360;
            double sin_a, cos_a, sin_e, cos_e;
            sine_cosine(azimuth, sin_a, cos_a);
            sine_cosine(elevation, sin_e, cos_e);
            from = scanner.from;
            direction = {cos_e * cos_a, cos_e * sin_a, sin_e};
        }
    }
};

std::vector<ScanPoint> scan_line(const Rays& rays, const Eye& eye, std::size_t line, std::size_t lines,
                                 std::size_t steps, std::uint64_t key)
{
    std::vector<ScanPoint> points;
    for (std::size_t step = 0; step < steps; ++step) {
        Vec3d from, direction;
        rays.at((static_cast<double>(line) + 0.5) / static_cast<double>(lines),
                (static_cast<double>(step) + 0.5) / static_cast<double>(steps), from, direction);
        const std::uint64_t own = hash(key, line * 1000003 + step);
        const auto sight = eye.look(from, direction, own);
        if (!sight) continue;
        Random random(own + 1);
        ScanPoint point;
        point.place = sight->place + (noise * random.normal()) * direction;
        for (std::size_t c = 0; c < 3; ++c) point.colour[c] = static_cast<std::uint8_t>(sight->colour[c] + 0.5);
        point.label = sight->label;
        points.push_back(point);
    }
    return points;
}

std::vector<ScanPoint> scan_with(const Rays& rays, const Eye& eye, double count, std::uint64_t key, unsigned threads)
{
    const double step = std::sqrt(rays.lines * rays.steps / count);
    const auto lines = static_cast<std::size_t>(std::ceil(rays.lines / step));
    const auto steps = static_cast<std::size_t>(std::ceil(rays.steps / step));
    std::vector<std::vector<ScanPoint>> parts(lines);
    for_each_index(
        lines, threads, [&](std::size_t line) { parts[line] = scan_line(rays, eye, line, lines, steps, key); },
        [](std::size_t) {});
    std::vector<ScanPoint> points;
    for (const auto& part : parts) points.insert(points.end(), part.begin(), part.end());
    return points;
}

}  // namespace

std::vector<ScanPoint> scan(const Scene& scene, const Eye& eye, std::uint64_t points, unsigned threads)
{
    double shares = 0;
    for (const Scanner& scanner : scene.scanners) shares += scanner.share;
    std::vector<ScanPoint> all;
    for (std::size_t i = 0; i < scene.scanners.size(); ++i) {
        const Scanner& scanner = scene.scanners[i];
        const Rays rays(scanner);
        const double wanted = static_cast<double>(points) * scanner.share / shares;
        constexpr double trial = 4000;  // rays: how many see no sky
        const auto tried = static_cast<double>(scan_with(rays, eye, trial, scene.site.seed, threads).size());
        const auto found = scan_with(rays, eye, wanted * trial / std::max(1.0, tried), scene.site.seed + i, threads);
        all.insert(all.end(), found.begin(), found.end());
    }
    return all;
}

void write_cloud(const std::filesystem::path& file, const std::vector<ScanPoint>& points, bool labels)
{
    FileInfo info;
    info.points = points.size();
    info.position_type = ScalarType::i32;
    info.grid = Grid{{grid_step, grid_step, grid_step}, scene_origin};
    info.schema.add({std::string(attribute_name::rgb), ScalarType::u16, 3, 1, 0, {}});
    const auto writer = create_writer(file, info);
    PointBatch batch;
    for (std::size_t first = 0; first < points.size(); first += default_batch_points) {
        const std::size_t count = std::min(default_batch_points, points.size() - first);
        batch.reset(info.schema, true, count);
        batch.resize(count);
        auto* const rgb = batch.attributes[0].as<std::uint16_t>();
        for (std::size_t i = 0; i < count; ++i) {
            const ScanPoint& point = points[first + i];
            for (std::size_t a = 0; a < 3; ++a) {
                batch.grid_xyz[a][i] = static_cast<std::int32_t>(std::lround(point.place[a] / grid_step));
                rgb[3 * i + a] = static_cast<std::uint16_t>(256 * (labels ? point.label : point.colour)[a]);
            }
        }
        writer->write(batch);
    }
    writer->finish();
}

}  // namespace pcm::bench
