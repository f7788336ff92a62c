#include "bench/pictures/scenes/true_picture.h"

#include "pcm/threads/for_each_index.h"

#include <cmath>

namespace pcm::bench {
namespace {

constexpr int rays_a_side = 5;  // rays along a side of a pixel; odd, so that one goes through its middle
constexpr int grains = 4;       // grains for each ray: grain is the points', not the surfaces'

struct Camera {
    Vec3d eye, forward, right, up;
    double half = 0;  // the picture's height at distance 1, halved
    int width = 0, height = 0;

    Camera(const CameraFrame& frame, int w, int h) : eye(frame.eye), width(w), height(h)
    {
        forward = normalised(frame.target - frame.eye);
        right = normalised(cross(forward, frame.up));
        up = cross(right, forward);
        half = std::tan(*frame.angle * pi / 360);
    }
    // Pixels from the upper left corner.
    Vec3d direction(double x, double y) const
    {
        const double scale = 2 * half / height;
        return normalised(forward + scale * (x - 0.5 * width) * right - scale * (y - 0.5 * height) * up);
    }
};

void put(Image& image, int x, int y, const Rgb& colour, int alpha)
{
    const auto at =
        4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
    for (std::size_t c = 0; c < 3; ++c) image.rgba[at + c] = colour[c];
    image.rgba[at + 3] = static_cast<std::uint8_t>(alpha);
}

void draw_pixel(const Eye& eye, const Camera& camera, int x, int y, TruePicture& picture)
{
    constexpr int rays = rays_a_side * rays_a_side;
    scene::Colour sum{};
    int hits = 0;
    bool all_scanned = true;
    const auto pixel = static_cast<std::uint64_t>(y) * 100003 + static_cast<std::uint64_t>(x);
    for (int i = 0; i < rays; ++i) {
        const double dx = (i % rays_a_side + 0.5) / rays_a_side;
        const double dy = (static_cast<double>(i / rays_a_side) + 0.5) / rays_a_side;
        const auto sight = eye.look(camera.eye, camera.direction(x + dx, y + dy),
                                    scene::hash(pixel, static_cast<std::uint64_t>(i)), grains);
        if (i == rays / 2) {
            put(picture.labels, x, y, sight ? sight->label : Rgb{}, sight ? 255 : 0);
            put(picture.facts, x, y, {static_cast<std::uint8_t>(sight ? sight->kind : Kind{}), 0, 0}, 255);
        }
        if (!sight) continue;
        ++hits;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += sight->colour[c];
        if (i % (rays / 2) == 0 && all_scanned) all_scanned = eye.was_scanned(*sight);  // middle and two corners
    }
    Rgb mean{};
    for (std::size_t c = 0; c < 3 && hits; ++c) mean[c] = static_cast<std::uint8_t>(sum[c] / hits + 0.5);
    put(picture.colours, x, y, mean, (255 * hits + rays / 2) / rays);
    const auto at =
        4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x));
    picture.facts.rgba[at + 1] = all_scanned ? 255 : 0;
}

}  // namespace

TruePicture true_picture(const Eye& eye, const CameraFrame& frame, int width, int height, unsigned threads)
{
    const Camera camera(frame, width, height);
    TruePicture picture;
    for (Image* image : {&picture.colours, &picture.labels, &picture.facts}) {
        image->width = width;
        image->height = height;
        image->rgba.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    }
    for_each_index(
        static_cast<std::size_t>(height), threads,
        [&](std::size_t y) {
            for (int x = 0; x < width; ++x) draw_pixel(eye, camera, x, static_cast<int>(y), picture);
        },
        [](std::size_t) {});
    return picture;
}

}  // namespace pcm::bench
