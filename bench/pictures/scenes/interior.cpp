// A furnished room, seen by two tripods.
#include "bench/pictures/scenes/scenes.h"

#include "pcm/generate/construction.h"

namespace pcm::bench {

using namespace scene;

namespace {

constexpr Vec3d axis_x{1, 0, 0}, axis_y{0, 1, 0};

class Room {
public:
    explicit Room(Site& site) : construct_(site) {}

    // `low` and `high` are corners; all six sides have one look.
    void box(const Vec3d& low, const Vec3d& high, const Colour& colour, Material material = Material::metal)
    {
        const Vec3d c = corner_ + 0.5 * (low + high), h = 0.5 * (high - low);
        for (const double side : {-1.0, 1.0}) {
            plane(c + Vec3d{side * h[0], 0, 0}, axis_y, up, h[1], h[2], colour, material);
            plane(c + Vec3d{0, side * h[1], 0}, axis_x, up, h[0], h[2], colour, material);
            plane(c + Vec3d{0, 0, side * h[2]}, axis_x, axis_y, h[0], h[1], colour, material);
        }
    }
    void rod(const Vec3d& from, const Vec3d& to, double radius, const Colour& colour)
    {
        construct_.cylinder(corner_ + from, corner_ + to, radius, Material::metal, colour);
    }
    void ball(const Vec3d& centre, double radius, const Colour& colour)
    {
        construct_.sphere(corner_ + centre, radius, colour);
    }
    void plane(const Vec3d& centre, const Vec3d& u, const Vec3d& v, double half_u, double half_v, const Colour& colour,
               Material material)
    {
        construct_.rectangle(centre, u, v, half_u, half_v, 0, material, colour, 6);
    }
    Vec3d at(double x, double y, double z) const { return corner_ + Vec3d{x, y, z}; }

    void table(double x, double y)
    {
        box({x - 0.8, y - 0.45, 0.71}, {x + 0.8, y + 0.45, 0.75}, {168, 122, 78});
        for (const double a : {-0.72, 0.72})
            for (const double b : {-0.38, 0.38}) rod({x + a, y + b, 0}, {x + a, y + b, 0.71}, 0.03, {120, 88, 58});
        box({x - 0.3, y - 0.1, 0.75}, {x - 0.05, y + 0.1, 0.79}, {196, 62, 52});
        ball({x + 0.35, y + 0.05, 0.84}, 0.09, {222, 150, 42});
    }
    void chair(double x, double y, double back)
    {
        box({x - 0.21, y - 0.21, 0.43}, {x + 0.21, y + 0.21, 0.46}, {70, 92, 120});
        box({x - 0.21, y + back - 0.015, 0.46}, {x + 0.21, y + back + 0.015, 0.92}, {70, 92, 120});
        for (const double a : {-0.18, 0.18})
            for (const double b : {-0.18, 0.18}) rod({x + a, y + b, 0}, {x + a, y + b, 0.43}, 0.018, {60, 60, 64});
    }
    void shelf(double x, double y, Random& random)
    {
        const Colour wood{150, 110, 72};
        for (int board = 0; board < 6; ++board)
            box({x, y, 0.05 + 0.38 * board}, {x + 0.32, y + 1.8, 0.08 + 0.38 * board}, wood);
        for (const double side : {0.0, 1.78}) box({x, y + side, 0}, {x + 0.32, y + side + 0.02, 2}, wood);
        for (int board = 0; board < 5; ++board)
            for (double at = y + 0.04; at < y + 1.68;) {
                const double thick = random.between(0.02, 0.055), tall = random.between(0.2, 0.33);
                const double foot = 0.08 + 0.38 * board;
                const Colour cover{random.between(40, 220), random.between(40, 200), random.between(40, 200)};
                if (random.chance(0.85)) box({x + 0.03, at, foot}, {x + 0.26, at + thick, foot + tall}, cover);
                at += thick + 0.004;
            }
    }

private:
    Vec3d corner_{5, 5, 0};
    Construction construct_;
};

}  // namespace

Scene make_interior(std::uint64_t seed)
{
    Scene scene = empty_scene("interior", 20, seed);
    Site& site = scene.site;
    Random random(hash(seed, 0x726f6f6d));
    Room room(site);
    const double x = 7, y = 5, z = 2.7;
    room.plane(room.at(x / 2, y / 2, 0.005), axis_x, axis_y, x / 2, y / 2, {158, 128, 96}, Material::concrete);
    room.plane(room.at(x / 2, y / 2, z), axis_x, axis_y, x / 2, y / 2, {232, 232, 226}, Material::concrete);
    const Colour paint{206, 200, 184};
    for (const double side : {0.0, 1.0}) {
        room.plane(room.at(side * x, y / 2, z / 2), axis_y, up, y / 2, z / 2, paint, Material::concrete);
        room.plane(room.at(x / 2, side * y, z / 2), axis_x, up, x / 2, z / 2, paint, Material::concrete);
    }
    room.box({2.6, 4.95, 1.1}, {4.4, 5, 2.3}, {120, 152, 178});  // a picture on the wall
    room.box({2.7, 4.94, 1.2}, {4.3, 4.96, 2.2}, {198, 158, 92}, Material::brick);
    room.box({0.02, 3.6, 0}, {1.0, 4.9, 0.42}, {96, 110, 88});  // a sofa
    room.box({0.02, 3.6, 0.42}, {0.25, 4.9, 0.85}, {96, 110, 88});
    room.plane(room.at(3.6, 2.4, 0.015), axis_x, axis_y, 1.5, 1.1, {142, 62, 58}, Material::brick);  // a rug
    room.table(3.6, 2.4);
    for (const double a : {-0.4, 0.4}) {
        room.chair(3.6 + a, 3.15, 0.2);
        room.chair(3.6 + a, 1.65, -0.2);
    }
    room.shelf(6.6, 1.2, random);
    room.rod({6.2, 4.4, 0}, {6.2, 4.4, 1.6}, 0.02, {50, 50, 54});  // a lamp
    room.ball({6.2, 4.4, 1.75}, 0.18, {240, 226, 176});
    room.ball({2.1, 1.1, 0.12}, 0.12, {52, 96, 170});
    const auto tripod = [&](double a, double b, double height) {
        scene.scanners.push_back({room.at(a, b, height), room.at(a, b, height), 1, -180, 180, -65, 89});
    };
    tripod(1.6, 2.2, 1.5);
    tripod(5.3, 3.7, 1.7);
    tripod(5.2, 0.8, 1.3);
    scene.views = {{"interior", room.at(0.5, 0.6, 1.65), room.at(4.6, 3.1, 0.85), 60}};
    return scene;
}

}  // namespace pcm::bench
