// Sets the intensity of all points below a height to 0, in a file of any size:
//   darken_below city.bpc 50
#include "pcm/bpc/bpc_array.h"

#include <cstdio>
#include <string>

int main(int argc, char** argv)
try {
    if (argc != 3) return std::fprintf(stderr, "usage: darken_below CLOUD.bpc HEIGHT\n"), 2;

    pcm::BpcArray cloud(argv[1]);
    const auto intensity = cloud.column<std::uint16_t>("intensity");
    const double height = std::stod(argv[2]);
    std::size_t changed = 0;
    for (auto point : cloud) {
        if (point.position()[2] >= height || point.get(intensity) == 0) continue;
        point.set(intensity, 0);
        ++changed;
    }
    cloud.flush();
    std::printf("%zu of %zu points changed\n", changed, std::size_t(cloud.size()));
} catch (const std::exception& error) {
    return std::fprintf(stderr, "darken_below: %s\n", error.what()), 1;
}
