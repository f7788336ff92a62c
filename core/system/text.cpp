#include "pcm/system/text.h"

#include "pcm/system/counted.h"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace pcm {

std::string grouped(std::uint64_t number)
{
    std::string text = std::to_string(number);
    for (auto i = static_cast<int>(text.size()) - 3; i > 0; i -= 3) text.insert(static_cast<std::size_t>(i), ",");
    return text;
}

std::string counted(std::uint64_t number, const std::string& noun)
{
    return grouped(number) + " " + noun + (number == 1 ? "" : "s");
}

std::string counted(std::uint64_t number, const std::string& noun, const std::string& one, const std::string& several)
{
    return counted(number, noun) + " " + (number == 1 ? one : several);
}

std::string points_text(std::uint64_t points) { return counted(points, "point"); }

std::string exact(double value)
{
    // Coordinates are read by people: no exponent where the number is not too long without.
    const double magnitude = std::fabs(value);
    const bool plain = magnitude == 0 || (magnitude >= 1e-6 && magnitude < 1e15);
    char text[64];
    const auto format = plain ? std::chars_format::fixed : std::chars_format::scientific;
    return std::string(text, std::to_chars(text, text + sizeof text, value, format).ptr);
}

std::string exact(const std::array<double, 3>& v) { return exact(v[0]) + " " + exact(v[1]) + " " + exact(v[2]); }

std::string brief(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

std::string bytes_text(std::uint64_t bytes)
{
    static const char* const units[] = {"bytes", "kB", "MB", "GB", "TB"};
    auto value = static_cast<double>(bytes);
    int unit = 0;
    // What would be rounded to 1000.00 belongs to the next unit.
    while (value >= (unit ? 999.995 : 1000) && unit < 4) {
        value /= 1000;
        ++unit;
    }
    char text[32];
    std::snprintf(text, sizeof text, unit ? "%.2f %s" : "%.0f %s", value, units[unit]);
    return text;
}

std::string time_text(double seconds)
{
    if (seconds < 0.9995) return brief(seconds * 1000) + " ms";
    if (seconds < 119.5 || !(seconds < 1e15)) return brief(seconds) + " s";
    const auto whole = static_cast<std::uint64_t>(std::llround(seconds));
    const std::uint64_t minutes = whole / 60;
    if (minutes < 60) return std::to_string(minutes) + " min " + std::to_string(whole % 60) + " s";
    return grouped(minutes / 60) + " h " + std::to_string(minutes % 60) + " min";
}

}  // namespace pcm
