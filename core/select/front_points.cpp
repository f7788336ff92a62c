#include "pcm/select/front_points.h"

#include "pcm/cloud/vector.h"
#include "pcm/select/point_scan.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/tree/point_size.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <string>

namespace pcm {
namespace {

constexpr double most_splat_pixels = 64;
constexpr int most_pixels = 16384;

// Where a point appears.
struct Seen {
    double x = 0, y = 0;  // pixels, from the lower left corner of the viewport
    double depth = 0;     // along the view, in units of eye space
    double size = 0;      // in the same units
    double radius = 0;    // on-screen radius of the size, pixels
    double least = 0;     // the smallest size that counts for the tolerance: as large as 1.5 pixels
};

class Eye {
public:
    Eye(const Camera& camera, const TreeInfo& info)
        : camera_(camera), rounding_(info), grid_(info.grid), least_(least_point_size(info.grid))
    {
        std::array<Vec3d, 3> rows;
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 3; ++c) rows[r][c] = camera.modelview[c * 4 + r] / camera.modelview[15];
        scale_ = std::cbrt(std::fabs(dot(rows[0], cross(rows[1], rows[2]))));
    }

    Vec3d position(const Chunk& chunk, std::size_t i) const
    {
        return rounding_(grid_.to_source(chunk.positions->grid(i)));
    }

    Seen see(const Chunk& chunk, std::size_t i) const
    {
        const Vec3d d = position(chunk, i) - camera_.origin;
        const Matrix4d &m = camera_.modelview, &p = camera_.projection;
        Vec3d e;
        for (std::size_t r = 0; r < 3; ++r)
            e[r] = (m[r] * d[0] + m[4 + r] * d[1] + m[8 + r] * d[2] + m[12 + r]) / m[15];
        const auto row = [&](std::size_t r) { return p[r] * e[0] + p[4 + r] * e[1] + p[8 + r] * e[2] + p[12 + r]; };
        const double w = row(3);
        Seen seen;
        seen.x = (row(0) / w + 1) / 2 * camera_.width;
        seen.y = (row(1) / w + 1) / 2 * camera_.height;
        seen.depth = -e[2];
        const double pixels = std::fabs(p[5]) * camera_.height / 2 / w;  // per unit of eye space, at this depth
        const std::uint8_t code = chunk.sizes ? chunk.sizes->as<std::uint8_t>()[i] : unknown_size;
        const double size = code == unknown_size ? 0 : scale_ * point_size(code, least_);
        seen.size = std::max(size, 0.5 / pixels);
        seen.least = 1.5 / pixels;
        seen.radius = std::min(seen.size * pixels, most_splat_pixels);
        return seen;
    }

private:
    const Camera& camera_;
    const SourceRounding rounding_;
    const Grid grid_;
    const double least_;
    double scale_ = 1;  // scale of the modelview
};

// The minimum depth of each pixel of a rectangle. Any number of threads.
class DepthBuffer {
public:
    DepthBuffer(const Camera& camera, const Polygon& polygon)
    {
        const auto pixel = [](double ndc, int size) {
            return static_cast<int>(std::clamp(std::floor((ndc + 1) / 2 * size), 0.0, static_cast<double>(size - 1)));
        };
        for (std::size_t a = 0; a < 2; ++a) {
            const int size = a == 0 ? camera.width : camera.height;
            low_[a] = std::max(0, pixel(polygon.min()[a], size) - 1);
            high_[a] = std::min(size - 1, pixel(polygon.max()[a], size) + 1);
        }
        depths_ = std::vector<std::atomic<std::uint64_t>>(static_cast<std::size_t>(width()) *
                                                          static_cast<std::size_t>(high_[1] - low_[1] + 1));
        for (auto& depth : depths_) depth = ordered(std::numeric_limits<double>::infinity());
    }

    void draw(const Seen& seen)
    {
        lower(static_cast<int>(std::floor(seen.x)), static_cast<int>(std::floor(seen.y)), seen.depth);
        const auto first = [&](std::size_t a, double at) {
            return std::max(low_[a], static_cast<int>(std::ceil(std::max(at - seen.radius, -1e6) - 0.5)));
        };
        const auto last = [&](std::size_t a, double at) {
            return std::min(high_[a], static_cast<int>(std::floor(std::min(at + seen.radius, 1e6) - 0.5)));
        };
        for (int y = first(1, seen.y); y <= last(1, seen.y); ++y)
            for (int x = first(0, seen.x); x <= last(0, seen.x); ++x) {
                const double dx = x + 0.5 - seen.x, dy = y + 0.5 - seen.y;
                const double part = (dx * dx + dy * dy) / (seen.radius * seen.radius);
                if (part <= 1) lower(x, y, seen.depth + seen.size * part);
            }
    }

    // Whether a point is drawn in the viewport and no deeper than its pixel and `behind`.
    bool shows(const Seen& seen, double behind) const
    {
        const int x = static_cast<int>(std::floor(seen.x)), y = static_cast<int>(std::floor(seen.y));
        return holds(x, y) && ordered(seen.depth - behind) <= depths_[index(x, y)].load(std::memory_order_relaxed);
    }

private:
    // Integers in the order of the numbers.
    static std::uint64_t ordered(double value)
    {
        std::uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        return bits >> 63 ? ~bits : bits | std::uint64_t(1) << 63;
    }
    int width() const { return high_[0] - low_[0] + 1; }
    bool holds(int x, int y) const { return x >= low_[0] && x <= high_[0] && y >= low_[1] && y <= high_[1]; }
    std::size_t index(int x, int y) const
    {
        return static_cast<std::size_t>(y - low_[1]) * static_cast<std::size_t>(width()) +
               static_cast<std::size_t>(x - low_[0]);
    }
    void lower(int x, int y, double depth)
    {
        if (!holds(x, y)) return;
        std::atomic<std::uint64_t>& present = depths_[index(x, y)];
        const std::uint64_t wanted = ordered(depth);
        std::uint64_t now = present.load(std::memory_order_relaxed);
        while (wanted < now && !present.compare_exchange_weak(now, wanted, std::memory_order_relaxed)) {
        }
    }

    std::array<int, 2> low_{}, high_{};
    std::vector<std::atomic<std::uint64_t>> depths_;
};

void check(const Camera& camera, const FrontOptions& options)
{
    for (const int size : {camera.width, camera.height})
        if (size < 1 || size > most_pixels)
            throw Error(ErrorCode::invalid_argument, {},
                        "the viewport has " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                            " pixels; 1 to " + std::to_string(most_pixels) + " are possible");
    if (!(options.tolerance >= 0) || !std::isfinite(options.tolerance))
        throw Error(ErrorCode::invalid_argument, {},
                    "the tolerance is " + exact(options.tolerance) + " sizes; it is 0 or more, and finite");
}

// The rectangle around the polygon, grown by the largest splat.
std::vector<Vec2d> surroundings(const Camera& camera, const Polygon& polygon)
{
    Vec2d low, high;
    for (std::size_t a = 0; a < 2; ++a) {
        const double margin = 2 * (most_splat_pixels + 2) / (a == 0 ? camera.width : camera.height);
        low[a] = std::max(polygon.min()[a], -1.0) - margin;
        high[a] = std::min(polygon.max()[a], 1.0) + margin;
    }
    return {low, {high[0], low[1]}, high, {low[0], high[1]}};
}

}  // namespace

PointSet front_points(const std::shared_ptr<const Tree>& tree, const Camera& camera, const std::vector<Vec2d>& polygon,
                      const FrontOptions& options)
{
    check(camera, options);
    const Region lasso = Region::lasso(camera.modelview, camera.projection, camera.origin, polygon);
    const Polygon area(polygon);
    PointSet set(tree);
    for (std::size_t a = 0; a < 2; ++a)
        if (area.min()[a] > 1 || area.max()[a] < -1) return set;  // outside the screen
    const Eye eye(camera, tree->info());
    DepthBuffer buffer(camera, area);
    ScanOptions scan;
    scan.columns = ColumnSet::only_positions();
    scan.columns->sizes = true;
    scan.select = options.select;
    scan.stage = "Finding what is in front";
    scan.end = 0.6;
    Selection around = options.shown;
    around.clips.push_back(
        {Region::lasso(camera.modelview, camera.projection, camera.origin, surroundings(camera, area)), false});
    scan_points(*tree, around, scan, [&](const ScannedPoints& found) {
        for (const std::uint32_t i : found.indices) buffer.draw(eye.see(found.part.chunk, i));
    });
    scan.begin = 0.6;
    scan.end = 1;
    Selection in_lasso = options.shown;
    in_lasso.clips.push_back({lasso, false});
    std::mutex mutex;
    scan_points(*tree, in_lasso, scan, [&](const ScannedPoints& found) {
        std::vector<std::uint32_t> seen;
        for (std::size_t k = 0; k < found.indices.size(); ++k) {
            const Seen point = eye.see(found.part.chunk, found.indices[k]);
            if (buffer.shows(point, options.tolerance * std::max(point.size, point.least)))
                seen.push_back(found.numbers[k]);
        }
        const std::lock_guard lock(mutex);
        set.set(found.node, seen);
    });
    return set;
}

}  // namespace pcm
