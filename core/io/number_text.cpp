#include "io/number_text.h"

#include "io/scalars.h"

#include <fast_float/fast_float.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace pcm {
namespace {

// What from_chars leaves over: a plus sign, numbers beyond the range of T, and what Microsoft's printf writes for NaN.
template <class T>
bool parse_odd_real(std::string_view word, T& value)
{
    if (!word.empty() && word[0] == '+') {
        word.remove_prefix(1);
        if (word.empty() || word[0] == '-' || word[0] == '+') return false;
    }
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    const std::string_view rest(stop, static_cast<std::size_t>(end - stop));
    const bool negative = !word.empty() && word[0] == '-';
    if (error == std::errc::result_out_of_range && rest.empty()) {
        double wide = 0;
        const auto [wide_stop, wide_error] = std::from_chars(word.data(), end, wide);
        if (wide_stop == end && wide_error == std::errc()) {  // a double that is no float
            value = static_cast<T>(std::abs(wide) > 1 ? std::numeric_limits<T>::infinity() : T{0});
        } else {
            const std::size_t exponent = word.find_first_of("eE");
            const bool tiny = exponent != std::string_view::npos ? word.substr(exponent + 1, 1) == "-"
                                                                 : word.find_first_of("123456789") > word.find('.');
            value = tiny ? T{0} : std::numeric_limits<T>::infinity();
        }
        if (negative) value = -value;
        return true;
    }
    if (error != std::errc()) return false;
    if (rest.empty()) return true;
    if (rest.substr(0, 4) == "#INF") {
        value = negative ? -std::numeric_limits<T>::infinity() : std::numeric_limits<T>::infinity();
        return true;
    }
    if (rest.substr(0, 4) == "#IND" || rest.substr(0, 5) == "#QNAN" || rest.substr(0, 5) == "#SNAN") {
        value = std::numeric_limits<T>::quiet_NaN();
        return true;
    }
    return false;
}

template <class T>
bool parse_number(std::string_view word, T& value)
{
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error == std::errc() && stop == end) return true;
    if constexpr (std::is_floating_point_v<T>) {
        return parse_odd_real(word, value);
    } else {
        // "+7", and "255.0" where a whole number was promised.
        double real = 0;
        if (!parse_number(word, real) || real != std::floor(real)) return false;
        if (!(real >= static_cast<double>(std::numeric_limits<T>::min()) &&
              real < static_cast<double>(std::numeric_limits<T>::max()) + 1.0))
            return false;
        value = static_cast<T>(real);
        return true;
    }
}

template <class T>
const char* fast_number(const char* from, const char* end, T& value)
{
    if constexpr (std::is_floating_point_v<T>) {
        const auto result = fast_float::from_chars(from, end, value);
        return result.ec == std::errc() ? result.ptr : nullptr;
    } else {
        const auto result = std::from_chars(from, end, value);
        return result.ec == std::errc() ? result.ptr : nullptr;
    }
}

}  // namespace

std::string_view LineWords::next()
{
    skip_separators();
    const char* const start = at_;
    while (at_ != end_ && !separates(*at_)) ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
}

bool LineWords::at_end()
{
    skip_separators();
    return at_ == end_;
}

template <class T>
bool LineWords::take(std::byte* to, std::string_view& word)
{
    skip_separators();
    T value{};
    const char* const stop = fast_number(at_, end_, value);
    // fast_float gives infinity for what is too large and 0 for what is too small, as is wanted.
    if (stop && (stop == end_ || separates(*stop))) {
        at_ = stop;
    } else {
        word = next();
        if (word.empty() || !parse_number(word, value)) return false;
    }
    std::memcpy(to, &value, sizeof value);
    return true;
}

bool LineWords::next_number(ScalarType type, std::byte* to, std::string_view& word)
{
    return with_type(type, [&](auto example) { return take<decltype(example)>(to, word); });
}

}  // namespace pcm
