#include "pcm/system/scaled_decimal.h"

#include "pcm/system/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

namespace pcm {
namespace {

constexpr int most_places = 18;
constexpr double most_units = 9e17;  // maximum number of 10^-places: sums of two such numbers fit 64 bits

// digits * 10^exponent, digits without a zero at the end.
struct Decimal {
    std::int64_t digits = 0;
    int exponent = 0;
};

// The shortest decimal that reads as v.
std::optional<Decimal> decimal_of(double v)
{
    if (v == 0) return Decimal();
    if (!std::isfinite(v)) return std::nullopt;
    char text[32];
    const char* const end = std::to_chars(text, text + sizeof text, v, std::chars_format::scientific).ptr;
    Decimal decimal;
    const char* at = text;
    const bool negative = *at == '-';
    if (negative) ++at;
    bool after_point = false;
    for (; at != end && *at != 'e'; ++at) {
        if (*at == '.') {
            after_point = true;
            continue;
        }
        decimal.digits = 10 * decimal.digits + (*at - '0');
        if (after_point) --decimal.exponent;
    }
    int power = 0;
    if (at != end && *++at == '+') ++at;
    std::from_chars(at, end, power);
    decimal.exponent += power;
    for (; decimal.digits % 10 == 0; decimal.digits /= 10) ++decimal.exponent;
    if (negative) decimal.digits = -decimal.digits;
    return decimal;
}

// The number in units of 10^-places, if it is small enough.
std::optional<std::int64_t> in_units(const Decimal& decimal, int places)
{
    std::int64_t units = decimal.digits;
    for (int k = decimal.exponent + places; k > 0 && units != 0; --k) {
        if (std::fabs(10.0 * static_cast<double>(units)) > most_units) return std::nullopt;
        units *= 10;
    }
    return units;
}

}  // namespace

ScaledDecimal::ScaledDecimal(double scale, double offset) : scale_(scale), offset_(offset)
{
    const auto step = decimal_of(scale), shift = decimal_of(offset);
    if (!step || !shift) return;
    places_ = std::max({0, -step->exponent, -shift->exponent});
    if (places_ > most_places) return;
    const auto step_units = in_units(*step, places_), shift_units = in_units(*shift, places_);
    if (!step_units || !shift_units || std::fabs(static_cast<double>(*shift_units)) > most_units) return;
    step_ = *step_units;
    shift_ = *shift_units;
    usable_ = true;
}

char* ScaledDecimal::write(char* to, std::int64_t q) const
{
    if (!usable_ || std::fabs(static_cast<double>(q) * static_cast<double>(step_)) > most_units) return nullptr;
    std::int64_t units = q * step_ + shift_;
    int places = places_;
    for (; places > 0 && units % 10 == 0; units /= 10) --places;
    const double size = std::fabs(static_cast<double>(units)) / std::pow(10.0, places);
    if (units != 0 && (size < 1e-5 || size >= 1e15)) return nullptr;
    char digits[24];
    const bool negative = units < 0;
    const auto magnitude = negative ? 0 - static_cast<std::uint64_t>(units) : static_cast<std::uint64_t>(units);
    const char* const digits_end = std::to_chars(digits, digits + sizeof digits, magnitude).ptr;
    const auto count = static_cast<int>(digits_end - digits);
    if (count > 17) return nullptr;
    if (negative) *to++ = '-';
    const int whole = count - places;  // digits before the point
    if (whole > 0) {
        std::memcpy(to, digits, static_cast<std::size_t>(whole));
        to += whole;
    } else {
        *to++ = '0';
    }
    if (places == 0) return to;
    *to++ = '.';
    for (int k = whole; k < 0; ++k) *to++ = '0';
    const int first = std::max(whole, 0);
    std::memcpy(to, digits + first, static_cast<std::size_t>(count - first));
    return to + (count - first);
}

std::string decimal_text(std::int64_t q, double scale, double offset)
{
    char digits[ScaledDecimal::longest];
    const char* const end = ScaledDecimal(scale, offset).write(digits, q);
    return end ? std::string(static_cast<const char*>(digits), end) : exact(static_cast<double>(q) * scale + offset);
}

}  // namespace pcm
