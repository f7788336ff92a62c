#include "plugin/scene/tidy_numbers.h"

#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace pcm::host {

namespace {

constexpr int most_digits = 15;  // number of digits of a double that are exact
constexpr double centre_part = 10;

// Decimals; nothing where they would be no fewer digits than the value has.
std::optional<int> decimals_of(double value, double step)
{
    if (!(step > 0) || !std::isfinite(step) || !std::isfinite(value)) return std::nullopt;
    int decimals = 0;
    double unit = 1;
    // A step of 0.025 has three.
    const auto is_whole = [](double v) { return v > 0.5 && std::fabs(v - std::round(v)) <= 1e-6; };
    while (decimals <= most_digits && !is_whole(step / unit)) {
        ++decimals;
        unit = std::pow(10, -decimals);
    }
    const int before = std::fabs(value) < 1 ? 1 : 1 + static_cast<int>(std::floor(std::log10(std::fabs(value))));
    return decimals + before > most_digits ? std::nullopt : std::optional(decimals);
}

}  // namespace

double decimal(double value, double step)
{
    const auto decimals = decimals_of(value, step);
    return decimals ? QString::number(value, 'f', *decimals).toDouble() : value;
}

QString decimal_text(double value, double step) { return QString::fromStdString(exact(decimal(value, step))); }

QString on_grid_text(double value, double step)
{
    constexpr double noise = 1e-6;  // share of a step
    constexpr int most_decimals = 17;
    const QString all = QString::fromStdString(exact(value));
    for (int decimals = 0; step > 0 && decimals < most_decimals; ++decimals) {
        const QString shorter = QString::number(value, 'f', decimals);
        if (!(std::abs(shorter.toDouble() - value) <= noise * step)) continue;
        return shorter.size() < all.size() ? shorter : all;
    }
    return all;
}

ClipBox tidied(const ClipBox& box, double step, bool contains)
{
    if (!(step > 0) || !std::isfinite(step)) return box;
    ClipBox tidy = box;
    for (std::size_t k = 0; k < 3; ++k) {
        tidy.centre[k] = decimal(box.centre[k], step / centre_part);
        const double size = 2 * box.half[k], moved = contains ? 2 * std::fabs(tidy.centre[k] - box.centre[k]) : 0;
        double round = decimal(contains ? std::ceil((size + moved) / step - 1e-9) * step : size, step);
        // Below the step, as of a flat cloud, the size has digits of its own.
        if (!(round > 0) || round < size / 2) round = size;
        tidy.half[k] = round / 2;
    }
    return tidy;
}

}  // namespace pcm::host
