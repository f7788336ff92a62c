#include "pcm/generate/ground.h"

#include "pcm/generate/determinism.h"

namespace pcm::scene {

Ground::Ground(std::uint64_t seed)
{
    constexpr double tau = 2 * pi;
    struct {
        double amplitude, length;
    } const design[] = {{6.0, 1700}, {0.8, 190}, {0.2, 67}, {0.03, 19}};
    Random random(hash(seed, 0x6772));
    for (std::size_t i = 0; i < waves_.size(); ++i) {
        double sine, cosine;
        sine_cosine(random.unit(), sine, cosine);
        waves_[i] = {design[i].amplitude, cosine / design[i].length, sine / design[i].length, random.unit()};
        const double wave_number = tau / design[i].length;
        steepest_ += design[i].amplitude * wave_number;
        most_curved_ += design[i].amplitude * wave_number * wave_number;
    }
}

double Ground::height(double x, double y) const
{
    double slope_x, slope_y;
    return height(x, y, slope_x, slope_y);
}

double Ground::height(double x, double y, double& slope_x, double& slope_y) const
{
    constexpr double tau = 2 * pi;
    double sum = 0;
    slope_x = slope_y = 0;
    for (const Wave& wave : waves_) {
        double sine, cosine;
        sine_cosine(wave.x * x + wave.y * y + wave.phase, sine, cosine);
        sum += wave.amplitude * sine;
        slope_x += wave.amplitude * tau * wave.x * cosine;
        slope_y += wave.amplitude * tau * wave.y * cosine;
    }
    return sum;
}

}  // namespace pcm::scene
