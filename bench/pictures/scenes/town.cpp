// Houses with roofs along a street, a long brick wall, trees; and the site of `pcmlab generate`.
#include "bench/pictures/scenes/scenes.h"

#include "pcm/generate/construction.h"

namespace pcm::bench {

using namespace scene;

Scene make_site_scene(std::uint64_t seed)
{
    Scene scene;
    scene.name = "site";
    scene.site = make_site(60, seed);
    for (const Vec3d& station : scene.site.stations)
        scene.scanners.push_back({station, station, 1, -180, 180, -50, 50});
    scene.views = {{"above", {68.86, -20.70, 29.80}, {28, 28, -4}, 45}};
    return scene;
}

Scene make_town(std::uint64_t seed)
{
    Scene scene;
    scene.name = "town";
    Site& site = scene.site;
    site.side = 90;
    site.block = 45;
    site.street = 3.5;
    site.seed = seed;
    site.ground = Ground(seed);
    Random random(hash(seed, 0x746f776e));
    Construction construct(site);
    const auto at = [&](double x, double y, double over) { return Vec3d{x, y, site.ground.height(x, y) + over}; };
    for (int i = 0; i < 6; ++i)
        for (const double y : {13.0, 32.0, 58.0, 77.0}) {
            const double x = 9 + 14.2 * i + (i > 2 ? 1 : 0);
            if (y == 32.0 && i < 3) continue;  // the terrace below stands there
            const double half_x = random.between(4.2, 5.4), half_y = random.between(3.4, 4.4);
            const double eaves = random.between(4.5, 7.5);
            const Frame frame(at(x, y, 0), random.between(-0.01, 0.01) + (random.chance(0.4) ? 0.25 : 0));
            construct.house(frame, half_x, half_y, eaves, eaves + half_y * random.between(0.6, 0.9), random);
            construct.cylinder(frame.at(0.5 * half_x, 0.6, eaves), frame.at(0.5 * half_x, 0.6, eaves + half_y + 0.8),
                               0.3, Material::brick, {150, 84, 66});
        }
    const Frame terrace(at(22, 34, 0), 0);
    construct.walls(terrace, 17, 4.5, 1, 8, 0, Material::brick, {172, 92, 70}, 6);
    construct.rectangle(terrace.at(0, 0, 8), terrace.x, terrace.y, 17, 4.5, 0, Material::flat_roof, {132, 130, 126}, 6);
    std::uint16_t label = 30000;
    for (int i = 0; i < 8; ++i) {
        TreeDesign design;
        design.height = random.between(5, 8);
        design.leaves = 1000;
        const double x = 5 + 11.3 * i;
        plant(site, at(x, i % 2 ? 41 : 49.6, 0), design, label++, random);
    }
    const auto tripod = [&](double x, double y, double share) {
        scene.scanners.push_back({at(x, y, 1.8), at(x, y, 1.8), share, -180, 180, -45, 60});
    };
    tripod(10, 24.2, 1);
    tripod(26, 24.6, 1);
    tripod(45, 45, 1);
    tripod(70, 45, 0.6);
    for (const double x : {25.0, 65.0}) scene.scanners.push_back({{x, 0, 90}, {x, 90, 90}, 2.4, 0, 0, 0, 32});
    scene.views = {{"wall", at(7, 28.3, 1.7), at(27, 29.7, 2.8), 45}, {"town", at(82, 2, 34), at(50, 41, 3), 45}};
    return scene;
}

}  // namespace pcm::bench
