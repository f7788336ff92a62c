// What stands on the generated site: shapes, ground and scanner stations, in metres from the south-west corner.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/generate/scene.h"

#include <cstdint>
#include <vector>

namespace pcm::scene {

inline Vec3d operator+(const Vec3d& a, const Vec3d& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3d operator-(const Vec3d& a, const Vec3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3d operator*(double s, const Vec3d& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3d cross(const Vec3d& a, const Vec3d& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vec3d unit(const Vec3d& a) { return (1 / std::sqrt(dot(a, a))) * a; }

enum class Material : std::uint8_t { brick, plaster, cladding, tiles, flat_roof, concrete, metal, paint, bark, leaf };

using Colour = std::array<double, 3>;  // 0..255

// One surface (or, for crowns, one volume of leaves).
struct Shape {
    enum class Kind : std::uint8_t { rectangle, disc, cylinder, sphere, crown };

    Kind kind = Kind::rectangle;
    Material material = Material::concrete;
    std::uint8_t classification = 0;
    std::uint16_t id = 0;  // of the primitive in the truth; 0: none
    Colour colour{};
    Vec3d centre{};
    Vec3d u{1, 0, 0}, v{0, 1, 0}, n{0, 0, 1};  // orthonormal; n: normal of the plane, axis of the cylinder
    double half_u = 0, half_v = 0;             // rectangle; half_v is also half the length of a cylinder
    double gable = 0;                          // height of a gable over the rectangle's upper edge, its tip at u = 0
    double radius = 0;                         // disc, cylinder, sphere, crown
    double lowest = -1e9;                      // of a dome: the sphere is cut off below this height

    Box3d box() const;
};

// Rolling ground: the sum of a few sine waves.
class Ground {
public:
    Ground() = default;
    explicit Ground(std::uint64_t seed);

    double height(double x, double y) const;
    // Also the derivatives along x and y.
    double height(double x, double y, double& slope_x, double& slope_y) const;
    // No slope is steeper than this.
    double steepest() const { return steepest_; }
    // No second derivative along any direction is greater, 1/m.
    double most_curved() const { return most_curved_; }

private:
    struct Wave {
        double amplitude, x, y, phase;  // amplitude * sin(2 pi (x * px + y * py + phase))
    };
    std::array<Wave, 4> waves_{};
    double steepest_ = 0;
    double most_curved_ = 0;
};

struct Site {
    double side = 0;    // metres
    double block = 0;   // distance of parallel streets
    double street = 0;  // half the width of a street
    std::uint64_t seed = 0;
    Ground ground;
    std::vector<Shape> shapes;
    std::vector<Vec3d> stations;             // where the scanner's head is
    std::vector<ScenePrimitive> primitives;  // primitives[id - 1], in metres from the corner
};

Site make_site(double side, std::uint64_t seed);

}  // namespace pcm::scene
