#include "plugin/tools/measure/plot_axis.h"

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr double border = 0.04;  // share of the range, on each side

// A range of nothing gets a width that its numbers resolve.
void widen(double& from, double& to)
{
    const double least = std::max({std::abs(from), std::abs(to), 1e-9}) * 1e-9;
    if (to - from >= least) return;
    const double middle = from + (to - from) / 2;
    from = middle - least;
    to = middle + least;
}

}  // namespace

QString Ticks::text(double value) const
{
    const double exponent = std::floor(std::log10(step) + 1e-9);
    if (std::abs(value) < step / 2) return "0";
    if (exponent < -9 || std::abs(value) >= 1e12) return QString::number(value, 'g', 12);
    return QString::number(value, 'f', std::max(0, static_cast<int>(-exponent)));
}

Ticks round_ticks(double from, double to, int most)
{
    Ticks ticks;
    if (!std::isfinite(from) || !std::isfinite(to) || !(to > from)) return ticks;
    const double least = (to - from) / most;
    const double power = std::pow(10.0, std::floor(std::log10(least)));
    ticks.step = 10 * power;
    for (const double digit : {1.0, 2.0, 5.0})
        if (digit * power >= least) {
            ticks.step = digit * power;
            break;
        }
    const double first = std::ceil(from / ticks.step), last = std::floor(to / ticks.step);
    for (double i = first; i <= last && static_cast<int>(ticks.values.size()) < most; ++i)
        ticks.values.push_back(i * ticks.step);
    return ticks;
}

void PlotFrame::zoom(double pixel_at_x, double pixel_at_y, double factor_x, double factor_y)
{
    const double at_x = value_x(pixel_at_x), at_y = value_y(pixel_at_y);
    const PlotFrame old = *this;
    left = at_x - (at_x - left) / factor_x;
    right = at_x + (right - at_x) / factor_x;
    bottom = at_y - (at_y - bottom) / factor_y;
    top = at_y + (top - at_y) / factor_y;
    // No farther than double resolves the pixels.
    const auto resolved = [](double a, double b) {
        return std::isfinite(b - a) && b - a > std::max(std::abs(a), std::abs(b)) * 1e-12 && b - a > 1e-300;
    };
    if (!resolved(left, right) || !resolved(bottom, top)) *this = old;
}

void PlotFrame::move(double dx, double dy)
{
    const double x_by = dx / width * (right - left), y_by = dy / height * (top - bottom);
    left -= x_by;
    right -= x_by;
    bottom += y_by;
    top += y_by;
}

void PlotFrame::fit(double x0, double x1, double y0, double y1, bool equal)
{
    widen(x0, x1);
    widen(y0, y1);
    left = x0 - border * (x1 - x0);
    right = x1 + border * (x1 - x0);
    bottom = y0 - border * (y1 - y0);
    top = y1 + border * (y1 - y0);
    if (equal) make_equal();
}

void PlotFrame::make_equal()
{
    const double per_pixel = std::max((right - left) / width, (top - bottom) / height);
    const double x_more = (per_pixel * width - (right - left)) / 2;
    const double y_more = (per_pixel * height - (top - bottom)) / 2;
    left -= x_more;
    right += x_more;
    bottom -= y_more;
    top += y_more;
}

}  // namespace pcm::host
