#include "pcm/shapes/command_script.h"

#include <charconv>
#include <cmath>

namespace pcm {

std::string CommandScript::decimal(double value)
{
    char text[400];
    const auto end = std::to_chars(text, text + sizeof text, value + 0.0, std::chars_format::fixed);
    return {text, end.ptr};
}

std::string CommandScript::decimal(const Vec3d& v) { return decimal(v[0]) + "," + decimal(v[1]) + "," + decimal(v[2]); }

void CommandScript::comment(const std::string& text)
{
    std::string plain = "; ";
    for (const char c : text) plain += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    line(plain);
}

void CommandScript::lines(std::initializer_list<std::string> texts)
{
    for (const std::string& text : texts) line(text);
}

void CommandScript::coordinate_system(const Vec3d& origin, const Vec3d& x, const Vec3d& y)
{
    lines({"_.UCS", "_W", "_.UCS", "_3"});
    // First moved, along the present axes: any step does.
    place(origin);
    place({origin[0] + 1 + std::fabs(origin[0]), origin[1], origin[2]});
    place({origin[0], origin[1] + 1 + std::fabs(origin[1]), origin[2]});
    if (x == Vec3d{1, 0, 0} && y == Vec3d{0, 1, 0}) return;
    lines({"_.UCS", "_3"});
    place({});
    place(x);
    place(y);
}

}  // namespace pcm
