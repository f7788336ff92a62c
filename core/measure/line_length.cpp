#include "pcm/measure/line_length.h"

#include <cmath>

namespace pcm {

LineLength line_length(const std::vector<MeasuredPoint>& points, Seen seen, bool closed)
{
    LineLength line;
    line.gradient.resize(points.size());
    const std::size_t segments = closed ? points.size() : points.size() - 1;
    for (std::size_t i = 0; i < segments; ++i) {
        const std::size_t j = (i + 1) % points.size();
        Vec3d d = points[j].position - points[i].position;
        if (seen == Seen::in_plan) d[2] = 0;
        const double size = length(d);
        line.value += size;
        if (!(size > 0)) {
            line.variance_apart += points[i].variance() + points[j].variance();
            continue;
        }
        line.gradient[i] = line.gradient[i] - d / size;
        line.gradient[j] = line.gradient[j] + d / size;
    }
    return line;
}

double propagated(const std::vector<MeasuredPoint>& points, const std::vector<Vec3d>& gradient, double apart)
{
    double variance = apart;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points[i].variance() > 0)  // an exact point adds none, also where the derivative is infinite
            variance += points[i].variance() * dot(gradient[i], gradient[i]);
    return std::sqrt(variance);
}

}  // namespace pcm
