#include "pcm/generate/surface.h"

#include <algorithm>
#include <cmath>

namespace pcm::scene {
namespace {

double floor(double x) { return static_cast<double>(whole_below(x)); }

double fraction(double x) { return x - floor(x); }

Colour blend(const Colour& a, const Colour& b, double share)
{
    return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
}

double cell_value(double i, double j, std::uint64_t seed)
{
    return to_unit(hash(seed ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(i)),
                        static_cast<std::uint64_t>(static_cast<std::int64_t>(j))));
}

// Value noise in [0, 1) with cells of one unit.
double smooth_noise(double x, double y, std::uint64_t seed)
{
    const double i = floor(x), j = floor(y);
    const double fx = x - i, fy = y - j;
    const double sx = fx * fx * (3 - 2 * fx), sy = fy * fy * (3 - 2 * fy);
    const double low = cell_value(i, j, seed) * (1 - sx) + cell_value(i + 1, j, seed) * sx;
    const double high = cell_value(i, j + 1, seed) * (1 - sx) + cell_value(i + 1, j + 1, seed) * sx;
    return low * (1 - sy) + high * sy;
}

Look ground_look(const Site& site, const Vec3d& p)
{
    Look look;
    look.classification = 2;
    // Distance from the middle of the nearest street of either direction.
    const auto from_street = [&](double x) { return std::abs(x - site.block * floor(x / site.block + 0.5)); };
    const double dx = from_street(p[0]), dy = from_street(p[1]);
    const double street = std::min(dx, dy);
    const double along = dx < dy ? p[1] : p[0];
    if (street < site.street) {
        look.colour = blend({74, 74, 78}, {96, 95, 96}, smooth_noise(p[0] * 0.8, p[1] * 0.8, 1));
        look.reflectivity = 0.18;
        const bool marking = std::max(dx, dy) > site.street + 2 && street < 0.07 && fraction(along / 4) < 0.5;
        if (marking) {
            look.colour = {226, 226, 218};
            look.reflectivity = 0.75;
        }
        return look;
    }
    if (street < site.street + 1.5) {
        const bool joint = fraction(p[0] / 0.9) < 0.05 || fraction(p[1] / 0.9) < 0.05;
        look.colour = joint ? Colour{132, 128, 122} : Colour{176, 172, 164};
        look.reflectivity = 0.42;
        return look;
    }
    const double patch = smooth_noise(p[0] * 0.11, p[1] * 0.11, 2);
    const double fine = smooth_noise(p[0] * 1.7, p[1] * 1.7, 3);
    const Colour grass = blend({78, 112, 52}, {124, 142, 70}, fine);
    const Colour gravel = blend({150, 140, 122}, {172, 162, 144}, fine);
    const bool town = p[0] < 0.45 * site.side;
    const double bare = std::clamp(((town ? 0.25 : 0.75) + 0.7 * (patch - 0.5) - 0.45) * 8, 0.0, 1.0);
    look.colour = blend(grass, gravel, bare);
    look.reflectivity = 0.5 - 0.15 * bare;
    return look;
}

// Windows in rows and columns on the rectangular part of a wall; a, b in metres along and up from its middle.
bool is_window(const Shape& s, double a, double b, bool& is_frame)
{
    const double height = b + s.half_v - 1.0;  // above the ground: walls reach 1 m below it
    if (height < 0.8 || b > s.half_v - 0.5 || std::abs(a) > s.half_u - 0.6) return false;
    const double column = std::abs(fraction(a / 2.6) - 0.5) * 2.6,
                 row = std::abs(fraction((height - 0.2) / 2.8) - 0.5) * 2.8;
    is_frame = column > 0.5 || row > 0.6;
    return column < 0.6 && row < 0.7;
}

// A point on a shape: relative to its centre, and, on flat surfaces and along cylinders, in metres along and up.
struct Place {
    Vec3d from;
    double a = 0, b = 0;
    bool round = false;  // on a cylinder
};

Place place_of(const Shape& s, const Vec3d& p)
{
    Place at;
    at.from = p - s.centre;
    at.round = s.kind == Shape::Kind::cylinder;
    at.a = at.round ? 0 : dot(at.from, s.u);
    at.b = at.round ? dot(at.from, s.n) : dot(at.from, s.v);
    return at;
}

void brick(const Shape& s, const Place& at, Look& look)
{
    bool is_frame = false;
    if (!at.round && is_window(s, at.a, at.b, is_frame)) {
        look.colour = is_frame ? Colour{232, 230, 224} : Colour{58, 74, 92};
        look.reflectivity = is_frame ? 0.6 : 0.12;
        return;
    }
    const double course = floor(at.b / 0.16);
    const double offset = fraction(0.5 * course) * 0.3;
    if (fraction(at.b / 0.16) < 0.12 || (!at.round && fraction((at.a + offset) / 0.3) < 0.05))
        look.colour = {190, 182, 170};
    else
        look.colour = blend(s.colour, {96, 48, 40}, 0.35 * cell_value(floor((at.a + offset) / 0.3), course, s.id));
    look.reflectivity = 0.38;
}

void plaster(const Shape& s, const Place& at, Look& look)
{
    bool is_frame = false;
    if (is_window(s, at.a, at.b, is_frame)) {
        look.colour = is_frame ? Colour{120, 88, 64} : Colour{62, 78, 96};
        look.reflectivity = is_frame ? 0.4 : 0.12;
    } else {
        look.colour = blend(s.colour, {150, 142, 130}, 0.3 * smooth_noise(at.a * 0.7, at.b * 0.35, s.id));
        look.reflectivity = 0.62;
    }
}

void cladding(const Shape& s, const Place& at, Look& look)
{
    look.colour = blend(s.colour, {0, 0, 0}, fraction(at.a / 0.3) < 0.25 ? 0.2 : 0.0);
    const double height = at.b + s.half_v - 1.0;
    if (height > 2 * s.half_v - 2.6 && height < 2 * s.half_v - 1.8) look.colour = {70, 88, 106};  // strip of windows
    if (std::abs(at.a) < 2.2 && height < 3.6) look.colour = {196, 92, 48};                        // gate
    look.reflectivity = 0.55;
}

void tiles(const Shape& s, const Place& at, Look& look)
{
    const double row = floor(at.b / 0.32);
    look.colour = blend(s.colour, {58, 40, 36}, 0.25 * cell_value(floor(at.a / 0.24), row, s.id));
    if (fraction(at.b / 0.32) < 0.14) look.colour = blend(look.colour, {30, 24, 24}, 0.4);
    look.reflectivity = 0.33;
}

void flat_roof(const Shape& s, const Place& at, Look& look)
{
    look.colour = blend(s.colour, {96, 96, 96}, smooth_noise(at.a * 0.5, at.b * 0.5, s.id));
    if (fraction(at.a / 4) < 0.02) look.colour = {84, 84, 86};
    look.reflectivity = 0.3;
}

void concrete(const Shape& s, const Place& at, Look& look)
{
    look.colour = blend(s.colour, {138, 136, 130}, smooth_noise(at.a * 0.4, at.b * 0.4, s.id));
    if (fraction(at.a / 3) < 0.012 || fraction(at.b / 3) < 0.012) look.colour = {118, 116, 112};
    look.reflectivity = 0.42;
}

void metal(const Shape& s, const Place& at, Look& look)
{
    if (fraction(at.b / 2.4) < 0.06) look.colour = blend(s.colour, {70, 70, 74}, 0.6);  // flanges
    look.reflectivity = 0.72;
}

void paint(const Shape& s, const Place& at, Look& look)
{
    const double height = at.round ? at.b + s.half_v : at.from[2];
    if (at.round && s.radius > 0.5) {
        if (fraction(height / 1.8) < 0.02) look.colour = blend(s.colour, {90, 90, 90}, 0.5);  // weld seams
        const double stain = smooth_noise(std::abs(at.from[0]) * 1.5 + at.from[1], height * 0.15, s.id);
        if (stain > 0.72) look.colour = blend(look.colour, {142, 92, 58}, (stain - 0.72) * 1.6);
    } else if (s.kind == Shape::Kind::sphere && std::abs(height) < 0.12 && s.lowest < -1e8) {
        look.colour = {170, 60, 48};  // equator band
    }
    look.reflectivity = 0.68;
}

void leaf(const Shape& s, const Place& at, Look& look)
{
    const double height = std::clamp((at.from[2] / s.radius + 1) / 2, 0.0, 1.0);
    look.colour = blend(blend(s.colour, {0, 0, 0}, 0.35), s.colour, height);
    look.reflectivity = 0.45;
}

Look shape_look(const Shape& s, const Vec3d& p)
{
    Look look;
    look.classification = s.classification;
    look.colour = s.colour;
    look.reflectivity = 0.5;
    const Place at = place_of(s, p);
    switch (s.material) {
        case Material::brick:
            brick(s, at, look);
            break;
        case Material::plaster:
            plaster(s, at, look);
            break;
        case Material::cladding:
            cladding(s, at, look);
            break;
        case Material::tiles:
            tiles(s, at, look);
            break;
        case Material::flat_roof:
            flat_roof(s, at, look);
            break;
        case Material::concrete:
            concrete(s, at, look);
            break;
        case Material::metal:
            metal(s, at, look);
            break;
        case Material::paint:
            paint(s, at, look);
            break;
        case Material::bark:
            look.reflectivity = 0.3;
            break;
        case Material::leaf:
            leaf(s, at, look);
            break;
    }
    return look;
}

}  // namespace

Look look_at(const Site& site, const Shape* shape, const Vec3d& point, const Vec3d& normal, Random& random)
{
    Look look = shape ? shape_look(*shape, point) : ground_look(site, point);
    // A soft sky light distinguishes the faces of a thing in a picture.
    static const Vec3d light{0.40824829046386302, -0.40824829046386302, 0.81649658092772603};
    const bool leaf = shape && shape->material == Material::leaf;
    const double brightness = leaf ? 1.0 : 0.8 + 0.22 * dot(normal, light);
    const double grain = brightness * (1 + (leaf ? 0.16 : 0.05) * (2 * random.unit() - 1));
    for (double& channel : look.colour) channel = std::clamp(channel * grain, 0.0, 255.0);
    return look;
}

}  // namespace pcm::scene
