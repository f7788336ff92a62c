#include "pcm/bpc/double_codes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcm {
namespace {

constexpr std::uint64_t sign_bit = std::uint64_t{1} << 63;
constexpr double largest_code = 9007199254740992.0;  // 2^53: integers up to here are doubles
constexpr int most_digits = 15;

std::uint64_t bits_of(double value)
{
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

std::int64_t ordered_code(double value, unsigned shift)
{
    const std::uint64_t bits = bits_of(value);
    const auto code = static_cast<std::int64_t>((bits & ~sign_bit) >> shift);
    return bits & sign_bit ? ~code : code;
}

double from_ordered(std::int64_t code, unsigned shift)
{
    const auto magnitude = static_cast<std::uint64_t>(code < 0 ? ~code : code) << shift;
    const std::uint64_t bits = code < 0 ? magnitude | sign_bit : magnitude & ~sign_bit;
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

// Whether the value is an integer over the divisor; -0, NaN and infinities never are.
bool divides(double value, double divisor)
{
    const double code = std::nearbyint(value * divisor);
    return std::fabs(code) <= largest_code && bits_of((code + 0.0) / divisor) == bits_of(value);
}

// The smallest power of ten that is a divisor for all values, or 0.
double decimal_divisor(const double* values, std::size_t count)
{
    double divisor = 1;
    int digits = 0;
    for (std::size_t i = 0; i < count; ++i)
        while (!divides(values[i], divisor)) {
            if (++digits > most_digits) return 0;
            divisor *= 10;  // exact up to 10^22
        }
    // A finer divisor may fail for values for which a coarser one worked, since the codes are larger.
    for (std::size_t i = 0; i < count; ++i)
        if (!divides(values[i], divisor)) return 0;
    return divisor;
}

// The smallest power of two that is a divisor for all values, or 0.
double binary_divisor(const double* values, std::size_t count)
{
    int lowest = std::numeric_limits<int>::max();  // exponent of the lowest bit that is set in any value
    double largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t bits = bits_of(values[i]);
        if ((bits & ~sign_bit) == 0) {
            if (bits) return 0;  // -0
            continue;
        }
        const int exponent = static_cast<int>(bits >> 52 & 0x7ff);
        if (exponent == 0 || exponent == 0x7ff) return 0;  // NaN, infinities, subnormals
        const std::uint64_t mantissa = (bits & ((std::uint64_t{1} << 52) - 1)) | std::uint64_t{1} << 52;
        lowest = std::min(lowest, exponent - 1075 + __builtin_ctzll(mantissa));
        largest = std::max(largest, std::fabs(values[i]));
    }
    if (lowest == std::numeric_limits<int>::max()) return 1;  // all are 0
    if (lowest < -1000 || lowest > 1000) return 0;
    return std::ldexp(largest, -lowest) <= largest_code ? std::ldexp(1.0, -lowest) : 0;
}

unsigned common_shift(const double* values, std::size_t count)
{
    std::uint64_t any = 0;
    for (std::size_t i = 0; i < count; ++i) any |= bits_of(values[i]);
    any &= ~sign_bit;
    return any ? static_cast<unsigned>(__builtin_ctzll(any)) : 62;
}

std::uint64_t span(const std::vector<std::int64_t>& codes)
{
    const auto [low, high] = std::minmax_element(codes.begin(), codes.end());
    return static_cast<std::uint64_t>(*high) - static_cast<std::uint64_t>(*low);
}

}  // namespace

std::optional<DoubleCodes> DoubleCodes::checked(const Vec3d& divisor, const Vec3d& shift)
{
    DoubleCodes codes;
    for (std::size_t a = 0; a < 3; ++a) {
        if (!(divisor[a] >= 0) || !std::isfinite(divisor[a])) return std::nullopt;
        if (!(shift[a] >= 0) || shift[a] > 63 || shift[a] != std::floor(shift[a])) return std::nullopt;
        codes.divisor[a] = divisor[a];
        codes.shift[a] = static_cast<std::uint32_t>(shift[a]);
    }
    return codes;
}

double DoubleCodes::to_source(std::int64_t code, std::size_t axis) const
{
    return divisor[axis] > 0 ? static_cast<double>(code) / divisor[axis] : from_ordered(code, shift[axis]);
}

void code_doubles(const double* values, std::size_t count, std::size_t axis, DoubleCodes& codes, std::int64_t* to)
{
    // Approximately, the coding with the smallest range of codes takes the fewest bits.
    const unsigned shift = common_shift(values, count);
    std::vector<std::int64_t> best(count), other(count);
    for (std::size_t i = 0; i < count; ++i) best[i] = ordered_code(values[i], shift);
    std::uint64_t best_span = span(best);
    codes.divisor[axis] = 0;
    codes.shift[axis] = shift;
    for (const double divisor : {binary_divisor(values, count), decimal_divisor(values, count)}) {
        if (divisor == 0) continue;
        for (std::size_t i = 0; i < count; ++i)
            other[i] = static_cast<std::int64_t>(std::nearbyint(values[i] * divisor));
        const std::uint64_t other_span = span(other);
        if (other_span >= best_span) continue;
        best_span = other_span;
        best.swap(other);
        codes.divisor[axis] = divisor;
        codes.shift[axis] = 0;
    }
    std::copy(best.begin(), best.end(), to);
}

template <class Word>
void decode_doubles(const DoubleCodes& codes, std::size_t axis, std::int64_t origin, const Word* relative,
                    std::size_t count, double* to)
{
    const auto code = [&](std::size_t i) {
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(origin) + relative[i]);
    };
    const double divisor = codes.divisor[axis];
    const unsigned shift = codes.shift[axis];
    if (divisor > 0)
        for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<double>(code(i)) / divisor;
    else
        for (std::size_t i = 0; i < count; ++i) to[i] = from_ordered(code(i), shift);
}

template void decode_doubles(const DoubleCodes&, std::size_t, std::int64_t, const std::uint32_t*, std::size_t, double*);
template void decode_doubles(const DoubleCodes&, std::size_t, std::int64_t, const std::uint64_t*, std::size_t, double*);

}  // namespace pcm
