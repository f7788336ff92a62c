// Parses regions.
#include "pcm/cloud/region.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace pcm {
namespace {

struct Form {
    const char *kind, *numbers;
};
constexpr Form forms[] = {
    {"box", "X0 Y0 Z0 X1 Y1 Z1"},
    {"oriented-box", "CX CY CZ HX HY HZ TURN or HX HY HZ UX UY UZ VX VY VZ"},
    {"sphere", "CX CY CZ RADIUS"},
    {"ray", "OX OY OZ DX DY DZ RADIUS [LENGTH]"},
    {"cone", "AX AY AZ DX DY DZ HALF_ANGLE [LENGTH]"},
    {"frustum", "EX EY EZ TX TY TZ ANGLE ASPECT NEAR FAR [UX UY UZ]"},
    {"planes", "CX CY CZ and NX NY NZ OFFSET for each plane"},
    {"polygon", "and X Y of three or more corners in plan"},
    {"prism", "CX CY CZ UX UY UZ VX VY VZ and X Y of each corner along u and v"},
    {"lasso", "16 numbers of the modelview, 16 of the projection, OX OY OZ and X Y of each corner on the screen"}};

// The form of the text's kind of region, or where there is no such kind all forms.
std::string forms_for(const std::string& text)
{
    std::string all;
    for (const Form& form : forms) {
        const std::string one = std::string(form.kind) + " " + form.numbers;
        const std::size_t size = std::char_traits<char>::length(form.kind);
        if (text.compare(0, size, form.kind) == 0 && (text.size() == size || text[size] == ' ')) return "write " + one;
        all += (all.empty() ? "" : "; ") + one;
    }
    return all;
}

[[noreturn]] void refuse_as_region(const std::string& text, const std::string& what)
{
    // Only the beginning of a polygon with very many corners is shown.
    constexpr std::size_t most_shown = 200;
    const std::string shown = text.size() > most_shown ? text.substr(0, most_shown) + "..." : text;
    throw Error(ErrorCode::invalid_argument, {}, "region '" + shown + "': " + what, forms_for(text));
}

bool separates(char c) { return c == ' ' || c == ',' || c == '\t'; }

std::vector<std::string_view> words_of(std::string_view text)
{
    std::vector<std::string_view> words;
    for (std::size_t i = 0; i < text.size();) {
        while (i < text.size() && separates(text[i])) ++i;
        const std::size_t begin = i;
        while (i < text.size() && !separates(text[i])) ++i;
        if (i > begin) words.push_back(text.substr(begin, i - begin));
    }
    return words;
}

double number_of(const std::string_view word, const std::string& text)
{
    const std::string_view digits = word.substr(word[0] == '+');
    double value = 0;
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (result.ec == std::errc::result_out_of_range)
        refuse_as_region(text, "'" + std::string(word) + "' is too large or too small a number");
    if (result.ec != std::errc() || result.ptr != digits.data() + digits.size())
        refuse_as_region(text, "'" + std::string(word) + "' is not a number");
    return value;
}

Region parse_polygon(std::string_view kind, const std::vector<double>& numbers, const std::string& text)
{
    const std::size_t n = numbers.size(), first = kind == "polygon" ? 0 : kind == "prism" ? 9 : 35;
    if (n < first + 6 || (n - first) % 2 != 0)
        refuse_as_region(text, std::to_string(n) + " numbers were given; " +
                                   (first > 0 ? std::to_string(first) + ", and then " : std::string()) +
                                   "two for each of three or more corners are needed");
    std::vector<Vec2d> corners;
    for (std::size_t i = first; i < n; i += 2) corners.push_back({numbers[i], numbers[i + 1]});
    const auto vector = [&](std::size_t at) { return Vec3d{numbers[at], numbers[at + 1], numbers[at + 2]}; };
    if (kind == "polygon") return Region::prism({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, corners);
    if (kind == "prism") return Region::prism(vector(0), vector(3), vector(6), corners);
    std::array<double, 16> modelview, projection;
    std::copy_n(numbers.begin(), 16, modelview.begin());
    std::copy_n(numbers.begin() + 16, 16, projection.begin());
    return Region::lasso(modelview, projection, vector(32), corners);
}

}  // namespace

Region parse_region(const std::string& text)
{
    const std::vector<std::string_view> words = words_of(text);
    if (words.empty()) refuse_as_region(text, "it is empty");
    std::vector<double> numbers;
    for (std::size_t i = 1; i < words.size(); ++i) numbers.push_back(number_of(words[i], text));
    const auto vector = [&](std::size_t at) { return Vec3d{numbers[at], numbers[at + 1], numbers[at + 2]}; };
    const std::size_t n = numbers.size();
    const auto need = [&](std::size_t a, std::size_t b) {
        if (n != a && n != b)
            refuse_as_region(text, std::to_string(n) + " numbers were given, " + std::to_string(a) +
                                       (a == b ? "" : " or " + std::to_string(b)) + " are needed");
    };
    const std::string_view kind = words[0];
    if (kind == "box") {
        need(6, 6);
        return Region::box({vector(0), vector(3)});
    }
    if (kind == "sphere") {
        need(4, 4);
        return Region::sphere(vector(0), numbers[3]);
    }
    if (kind == "oriented-box") {
        need(7, 12);
        Vec3d u, v;
        if (n == 7) {
            const double turn = numbers[6] / 180 * pi;
            u = {std::cos(turn), std::sin(turn), 0};
            v = {-u[1], u[0], 0};
        } else {
            u = vector(6);
            v = vector(9);
        }
        return Region::oriented_box(vector(0), {u, v, cross(u, v)}, vector(3));
    }
    if (kind == "ray" || kind == "cone") {
        need(7, 8);
        const std::optional<double> length = n == 8 ? std::optional(numbers[7]) : std::nullopt;
        return kind == "ray" ? Region::ray(vector(0), vector(3), numbers[6], length)
                             : Region::cone(vector(0), vector(3), numbers[6], length);
    }
    if (kind == "frustum") {
        need(10, 13);
        const Vec3d up = n == 13 ? vector(10) : Vec3d{0, 0, 1};
        return Region::frustum(vector(0), vector(3), up, numbers[6], numbers[7], numbers[8], numbers[9]);
    }
    if (kind == "planes") {
        if (n < 7 || (n - 3) % 4 != 0)
            refuse_as_region(
                text, std::to_string(n) + " numbers were given; three are needed for the centre, four for each plane");
        std::vector<Region::Plane> planes;
        for (std::size_t i = 3; i < n; i += 4) planes.push_back({vector(i), numbers[i + 3]});
        return Region::convex(vector(0), planes);
    }
    if (kind == "polygon" || kind == "prism" || kind == "lasso") return parse_polygon(kind, numbers, text);
    refuse_as_region(text, "'" + std::string(kind) + "' is not a known shape");
}

}  // namespace pcm
