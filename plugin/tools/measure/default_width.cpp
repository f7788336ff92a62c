#include "plugin/tools/measure/default_width.h"

#include "pcm/system/round_number.h"

#include <algorithm>

namespace pcm::host {

namespace {

constexpr double usual_spacings = 10, least_spacings = 2, least_pixels = 3;
constexpr double most_of_line = 1.0 / 10, usual_of_line = 1.0 / 50;

double median(std::vector<double> values)
{
    values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !(v > 0); }), values.end());
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

double default_width(const ProfileLine& line)
{
    const double spacing = median(line.spacings);
    const double usual = spacing > 0 ? usual_spacings * spacing : usual_of_line * line.length;
    const double most = line.length > 0 ? most_of_line * line.length : usual;
    const double least = std::max(least_spacings * spacing, std::min(least_pixels * line.pixel, most));
    const double wanted = std::max(std::min(usual, most), least);
    return wanted > 0 ? round_number(wanted) : 0;
}

}  // namespace pcm::host
