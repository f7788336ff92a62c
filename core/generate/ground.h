// The ground of the generated site.
#pragma once

#include <array>
#include <cstdint>

namespace pcm::scene {

// Rolling ground: the sum of a few sine waves. Metres.
class Ground {
public:
    Ground() = default;
    explicit Ground(std::uint64_t seed);

    double height(double x, double y) const;
    // Also the derivatives along x and y.
    double height(double x, double y, double& slope_x, double& slope_y) const;
    // Upper bound of the slope.
    double steepest() const { return steepest_; }
    // Upper bound of the second derivative along any direction, 1/m.
    double most_curved() const { return most_curved_; }

private:
    struct Wave {
        double amplitude, x, y, phase;  // amplitude * sin(2 pi (x * px + y * py + phase))
    };
    std::array<Wave, 4> waves_{};
    double steepest_ = 0;
    double most_curved_ = 0;
};

}  // namespace pcm::scene
