#include "pcm/piping/run_errors.h"

#include "pcm/cloud/numbers.h"

#include <algorithm>
#include <cmath>

namespace pcm::piping {

ValueWithError run_radius(const std::vector<const Tube*>& tubes)
{
    const bool known = std::all_of(tubes.begin(), tubes.end(), [](const Tube* tube) {
        return tube->radius_error > 0 && std::isfinite(tube->radius_error);
    });
    const double first = tubes.front()->radius;
    double weights = 0, sum = 0, misfit = 0;
    const auto weight = [&](const Tube& tube) { return known ? 1 / square(tube.radius_error) : 1.0; };
    for (const Tube* tube : tubes) {
        weights += weight(*tube);
        sum += weight(*tube) * (tube->radius - first);
    }
    ValueWithError radius;
    radius.value = first + sum / weights;
    if (!known) return radius;
    // sqrt(sum of w (r - mean)^2 / (n - 1)) is the ratio of the differences to those that the errors explain.
    for (const Tube* tube : tubes) misfit += weight(*tube) * square(tube->radius - radius.value);
    const double ratio = std::sqrt(misfit / static_cast<double>(tubes.size() - 1));
    radius.error = std::max(1.0, ratio) / std::sqrt(weights);
    return radius;
}

double length_error(const std::vector<RunBend>& bends, const std::array<double, 2>& free_ends)
{
    double sum = square(free_ends[0]) + square(free_ends[1]);
    for (const RunBend& bend : bends) {
        const double half = std::min(bend.turn, pi) / 2;
        const double along = half > 0 ? 2 - bend.turn / std::tan(half) : 0;
        const double k = std::min(std::tan(half), 2.0);
        const double missed = square(bend.place_error) + square(bend.tangent_error);
        const double across = bend.arc > 0 ? std::min(missed / bend.arc, std::sqrt(missed)) : 0;
        sum += square(across) + square(along * bend.tangent_error) + square(k * bend.place_error) +
               square(k * k * bend.direction_error);
    }
    return std::sqrt(sum);
}

double end_error(const Primitive& primitive, const Tube& tube)
{
    const double length =
        tube.is_straight() ? pcm::length(tube.ends[1].place - tube.ends[0].place) : tube.bend * tube.arc;
    const double points = static_cast<double>(std::max<std::uint64_t>(primitive.points, 1));
    const double spacing = std::sqrt(2 * pi * tube.radius * length / points);
    return std::hypot(std::min(spacing, length), primitive.fit.noise);
}

}  // namespace pcm::piping
