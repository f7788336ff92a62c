#include "bench/pictures/scenes/look.h"

#include "pcm/generate/surface.h"

#include <algorithm>
#include <cmath>

namespace pcm::bench {

using namespace scene;

namespace {

constexpr double nearest = 0.05, farthest = 400;  // metres
constexpr double least_cosine = 0.12;             // between a scanner's ray and a surface's normal: 83 degrees
constexpr double thin_radius = 0.09;              // radius of cylinders; below this they are `thin`

// The ground is 0; shapes have the label of their thing or, without one, a number of their own.
Rgb label_colour(const Shape* shape, std::int64_t index)
{
    const std::uint64_t label = !shape ? 0 : shape->id ? shape->id : 100000 + static_cast<std::uint64_t>(index);
    const std::uint64_t bits = hash(0x6c61, label);
    return {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
            static_cast<std::uint8_t>(bits >> 16)};
}

Kind kind_of(const Shape* shape)
{
    if (!shape) return Kind::surface;
    if (shape->material == Material::leaf) return Kind::leaves;
    return shape->kind == Shape::Kind::cylinder && shape->radius < thin_radius ? Kind::thin : Kind::surface;
}

// Where a ray comes into the column over the site: the ground is met by rays that start over it only. 0 from inside of
// it, and for rays that miss it.
double way_to_site(const Site& site, const Vec3d& from, const Vec3d& direction)
{
    double enter = 0, leave = farthest;
    for (std::size_t a = 0; a < 2; ++a) {
        const double one = -from[a] / direction[a], other = (site.side - from[a]) / direction[a];
        enter = std::max(enter, std::min(one, other));
        leave = std::min(leave, std::max(one, other));
    }
    return enter < leave && enter > 0 ? enter + 1e-6 : 0;
}

double degrees(double radians) { return radians * 180 / pi; }

}  // namespace

std::optional<Sight> Eye::look(const Vec3d& from, const Vec3d& direction, std::uint64_t key, int grains) const
{
    Random random(key);
    Hit hit;
    const double outside = way_to_site(scene_.site, from, direction);
    if (!caster_.cast({from + outside * direction, direction, random.bits()}, outside > 0 ? 0 : nearest, farthest, hit))
        return std::nullopt;
    hit.distance += outside;
    const Shape* shape = hit.shape < 0 ? nullptr : &scene_.site.shapes[static_cast<std::size_t>(hit.shape)];
    Sight sight;
    sight.distance = hit.distance;
    sight.place = from + hit.distance * direction;
    for (int i = 0; i < grains; ++i) {
        const Colour colour = look_at(scene_.site, shape, sight.place, hit.normal, random).colour;
        for (std::size_t c = 0; c < 3; ++c) sight.colour[c] += colour[c] / grains;
    }
    sight.normal = hit.normal;
    sight.label = label_colour(shape, hit.shape);
    sight.kind = kind_of(shape);
    sight.scattered = shape && shape->kind == Shape::Kind::crown;
    return sight;
}

bool Eye::was_scanned(const Sight& sight) const
{
    return sight.scattered || std::any_of(scene_.scanners.begin(), scene_.scanners.end(),
                                          [&](const Scanner& scanner) { return sees(scanner, sight); });
}

bool Eye::sees(const Scanner& scanner, const Sight& sight) const
{
    const Vec3d& place = sight.place;
    Vec3d from = scanner.from;
    if (scanner.flies()) {
        // From where the line is nearest: it scans across its way.
        const Vec3d way = scanner.to - scanner.from;
        const double t = dot(place - scanner.from, way) / dot(way, way);
        if (t < 0 || t > 1) return false;
        from = scanner.from + t * way;
    }
    const Vec3d to = place - from;
    const double distance = length(to);
    if (scanner.flies()) {
        if (degrees(std::acos(std::clamp(-to[2] / distance, -1.0, 1.0))) > scanner.highest) return false;
    } else {
        const double elevation = degrees(std::asin(std::clamp(to[2] / distance, -1.0, 1.0)));
        double azimuth = degrees(std::atan2(to[1], to[0]));
        while (azimuth < scanner.left) azimuth += 360;
        while (azimuth > scanner.left + 360) azimuth -= 360;
        if (elevation < scanner.lowest || elevation > scanner.highest || azimuth > scanner.right) return false;
    }
    if (sight.kind == Kind::surface && std::abs(dot(sight.normal, to)) < least_cosine * distance) return false;
    Hit hit;
    const double before = distance - 0.005;  // metres
    return before <= nearest || !caster_.cast({from, to / distance, 1}, nearest, before, hit);
}

}  // namespace pcm::bench
