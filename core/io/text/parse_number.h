// Parses numbers in text exactly: reals become the nearest float or double (Eisel-Lemire, by fast_float), integers keep
// all 64 bits.
#pragma once

#include <fast_float/fast_float.h>

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace pcm::text {

inline bool is_blank(char c) { return c == ' ' || c == '\t'; }
inline bool is_line_end(char c) { return c == '\n' || c == '\r'; }
inline bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

// Reads the number at `at` and moves `at` to its end: all forms except those that only parse_real() accepts. False,
// with `at` undefined, when there is no number. Beyond the range of T the value is infinite or zero.
template <class T>
bool take_any_real(const char*& at, const char* end, T& value, char point)
{
    const auto [stop, error] = fast_float::from_chars_advanced(
        at, end, value, fast_float::parse_options(fast_float::chars_format::general, point));
    at = stop;
    return error == std::errc() || error == std::errc::result_out_of_range;
}

// The same, but faster for most numbers in files: some digits with a point among them. The bytes before `end` must
// include one that ends the number.
template <class T>
bool take_real(const char*& at, const char* end, T& value, char point)
{
    // Integers up to these, and powers of ten up to these, are numbers of type T: one division rounds once (Clinger's
    // fast path, PLDI 1990).
    constexpr std::uint64_t exact_integers = std::uint64_t{1} << std::numeric_limits<T>::digits;
    constexpr std::ptrdiff_t exact_powers = sizeof(T) == 8 ? 22 : 10;
    static constexpr T powers[] = {T(1e0),  T(1e1),  T(1e2),  T(1e3),  T(1e4),  T(1e5),  T(1e6),  T(1e7),
                                   T(1e8),  T(1e9),  T(1e10), T(1e11), T(1e12), T(1e13), T(1e14), T(1e15),
                                   T(1e16), T(1e17), T(1e18), T(1e19), T(1e20), T(1e21), T(1e22)};
    const char* p = at;
    const bool negative = *p == '-';
    p += negative;
    std::uint64_t digits = 0;
    const char* const first = p;
    while (is_digit(*p)) digits = digits * 10 + static_cast<std::uint64_t>(*p++ - '0');
    std::ptrdiff_t count = p - first, decimals = 0;
    if (*p == point) {
        const char* const behind = ++p;
        while (is_digit(*p)) digits = digits * 10 + static_cast<std::uint64_t>(*p++ - '0');
        decimals = p - behind;
        count += decimals;
    }
    if (count == 0 || count > 19 || digits > exact_integers || decimals > exact_powers || *p == 'e' || *p == 'E')
        return take_any_real(at, end, value, point);
    const T magnitude = static_cast<T>(digits) / powers[decimals];
    value = negative ? -magnitude : magnitude;
    at = p;
    return true;
}

// Reads digits, with a minus if T is signed, and an optional fraction of zeros ("255.00"). False when the value does
// not fit T.
template <class T>
bool take_integer(const char*& at, char point, T& value)
{
    bool negative = false;
    if constexpr (std::is_signed_v<T>) {
        negative = *at == '-';
        at += negative;
    }
    std::uint64_t magnitude = 0;
    const char* const digits = at;
    while (is_digit(*at)) magnitude = magnitude * 10 + static_cast<std::uint64_t>(*at++ - '0');
    if (at == digits || at - digits > 18) return false;  // 19 digits may be too many for 64 bits
    if (*at == point) {
        ++at;
        while (*at == '0') ++at;
    }
    if (magnitude > static_cast<std::uint64_t>(std::numeric_limits<T>::max())) return false;
    const auto plain = static_cast<std::int64_t>(magnitude);
    value = static_cast<T>(negative ? -plain : plain);
    return true;
}

// Reads a whole word as a real; also accepts a plus sign, and NaN and infinity as Microsoft's printf writes them.
template <class T>
bool parse_real(std::string_view word, T& value, char point = '.')
{
    if (!word.empty() && word[0] == '+') {
        word.remove_prefix(1);
        if (word.empty() || word[0] == '-' || word[0] == '+') return false;
    }
    const char* at = word.data();
    const char* const end = at + word.size();
    if (at == end || !take_any_real(at, end, value, point)) return false;
    const std::string_view rest(at, static_cast<std::size_t>(end - at));
    if (rest.empty()) return true;
    if (rest.substr(0, 4) == "#INF") {
        value = word[0] == '-' ? -std::numeric_limits<T>::infinity() : std::numeric_limits<T>::infinity();
        return true;
    }
    if (rest.substr(0, 4) == "#IND" || rest.substr(0, 5) == "#QNAN" || rest.substr(0, 5) == "#SNAN") {
        value = std::numeric_limits<T>::quiet_NaN();
        return true;
    }
    return false;
}

// Reads a whole word as a number of type T; whole numbers may be written as reals ("255.0", "1e3", "+7"). False when it
// is not a number or does not fit an integer type; reals beyond the range of T are infinite or zero.
template <class T>
bool parse_number(std::string_view word, T& value, char point = '.')
{
    if constexpr (std::is_floating_point_v<T>) {
        return parse_real(word, value, point);
    } else {
        const char* const end = word.data() + word.size();
        const auto [stop, error] = std::from_chars(word.data(), end, value);
        if (error == std::errc() && stop == end) return true;
        double real = 0;
        if (!parse_real(word, real, point) || real != std::floor(real)) return false;
        if (!(real >= static_cast<double>(std::numeric_limits<T>::min()) &&
              real < static_cast<double>(std::numeric_limits<T>::max()) + 1.0))
            return false;
        value = static_cast<T>(real);
        return true;
    }
}

// The number of digits without leading zeros, sign, point and exponent: 3 for "-0.0120".
inline std::size_t significant_digits(std::string_view word)
{
    std::size_t digits = 0;
    for (const char c : word) {
        if (c == 'e' || c == 'E') break;
        if (is_digit(c) && (digits || c != '0')) ++digits;
    }
    return digits;
}

}  // namespace pcm::text
