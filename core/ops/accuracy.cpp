#include "pcm/ops/accuracy.h"

#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm::ops {

const char* name_of(ErrorKind kind)
{
    constexpr const char* names[] = {"exact", "bound", "95 %", "estimated"};
    return names[static_cast<std::size_t>(kind)];
}

Accuracy exact_answer() { return {}; }

Accuracy bounded(double error, const std::string& of)
{
    if (error == 0) return {};
    return {ErrorKind::bound, error, "source units", of};
}

Accuracy rounded_positions(double error) { return bounded(error, "coordinates"); }

Accuracy without_finer_levels(double spacing, double rounding)
{
    if (spacing == 0) return rounded_positions(rounding);
    // The three coordinates add to a distance.
    return bounded(spacing + std::sqrt(3.0) * rounding, "distances to points that the level leaves out");
}

Accuracy from_deviation(double sigma, const std::string& unit, const std::string& of, std::size_t dimensions)
{
    // Roots of the 95 % quantiles of chi squared with 1, 2 and 3 degrees of freedom.
    constexpr double radius_of_95[] = {1.959964, 2.447747, 2.795483};
    if (sigma == 0) return {};
    return {ErrorKind::percent_95, radius_of_95[dimensions - 1] * sigma, unit, of};
}

Accuracy of_steps(const std::vector<Accuracy>& steps)
{
    Accuracy all;
    for (const Accuracy& step : steps) {
        if (step.kind == ErrorKind::exact) continue;
        if (all.kind == ErrorKind::exact) {
            all = step;
        } else if (all.unit == step.unit && all.of == step.of) {
            all.error += step.error;
            if (all.kind != step.kind) all.kind = ErrorKind::estimated;
        } else {
            return {ErrorKind::estimated, std::numeric_limits<double>::infinity(), "", "several steps"};
        }
    }
    return all;
}

std::string text_of(const Accuracy& accuracy)
{
    const std::string kind = name_of(accuracy.kind);
    if (accuracy.kind == ErrorKind::exact) return "error 0 (" + kind + ")";
    const std::string size = std::isfinite(accuracy.error)
                                 ? brief(accuracy.error) + (accuracy.unit.empty() ? "" : " " + accuracy.unit)
                                 : "not known";
    return "error " + size + " (" + kind + ", of " + accuracy.of + ")";
}

}  // namespace pcm::ops
