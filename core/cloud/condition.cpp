#include "pcm/cloud/condition.h"

#include "pcm/cloud/attribute_names.h"
#include "pcm/cloud/with_type.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

namespace pcm {
namespace {

[[noreturn]] void refuse(const std::string& condition, const std::string& what)
{
    throw Error(ErrorCode::invalid_argument, {}, "condition '" + condition + "': " + what,
                "write for example classification=2,6 or \"intensity>=100\" or gps_time=100..200");
}

std::string_view trim(std::string_view text)
{
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
}

Condition::Number parse_value(std::string_view text, const std::string& condition)
{
    const std::string quoted = "'" + std::string(text) + "'";
    if (text.empty()) refuse(condition, "a number is missing");
    if (text[0] == '+') text.remove_prefix(1);
    Condition::Number number;
    const char *begin = text.data(), *end = begin + text.size();
    const auto result = std::from_chars(begin, end, number.value);
    if (result.ec == std::errc::result_out_of_range) refuse(condition, quoted + " is too large or too small a number");
    if (result.ec != std::errc() || result.ptr != end) refuse(condition, quoted + " is not a number");
    if (!std::isfinite(number.value)) refuse(condition, quoted + " is not a finite number");
    std::int64_t i = 0;
    std::uint64_t u = 0;
    if (const auto r = std::from_chars(begin, end, i); r.ec == std::errc() && r.ptr == end) number.i64 = i;
    if (const auto r = std::from_chars(begin, end, u); r.ec == std::errc() && r.ptr == end) number.u64 = u;
    return number;
}

using Wide = long double;  // 64 bits of mantissa: every i64 and u64 is exact
static_assert(std::numeric_limits<Wide>::digits >= 64);

// A user's value in the raw units of an integer attribute.
Wide raw_of(const Condition::Number& number, const Attribute& attribute)
{
    if (attribute.scale == 1 && attribute.offset == 0) {
        if (number.i64) return static_cast<Wide>(*number.i64);
        if (number.u64) return static_cast<Wide>(*number.u64);
        return number.value;
    }
    const Wide raw = (static_cast<Wide>(number.value) - attribute.offset) / attribute.scale;
    const Wide nearest = std::round(raw);
    return std::fabs(raw - nearest) <= 1e-6L ? nearest : raw;
}

template <class T>
using Interval = std::array<T, 2>;  // closed

template <class T>
Interval<T> nothing()
{
    return {std::numeric_limits<T>::max(), std::numeric_limits<T>::lowest()};
}

// The raw values of type T between two values as users see them; the ends are included unless `open`.
template <class T>
Interval<T> interval(std::optional<Condition::Number> low, std::optional<Condition::Number> high, bool open,
                     const Attribute& attribute)
{
    if (attribute.scale < 0) std::swap(low, high);
    if constexpr (std::is_integral_v<T>) {
        Wide from = std::numeric_limits<T>::min(), to = std::numeric_limits<T>::max();
        if (low) {
            const Wide raw = raw_of(*low, attribute);
            from = std::max(from, open ? std::floor(raw) + 1 : std::ceil(raw));
        }
        if (high) {
            const Wide raw = raw_of(*high, attribute);
            to = std::min(to, open ? std::ceil(raw) - 1 : std::floor(raw));
        }
        if (from > to) return nothing<T>();
        return {static_cast<T>(from), static_cast<T>(to)};
    } else {
        constexpr T infinity = std::numeric_limits<T>::infinity();
        const auto nearest = [&](const Condition::Number& number) {
            const double raw = attribute.scale == 1 && attribute.offset == 0
                                   ? number.value
                                   : (number.value - attribute.offset) / attribute.scale;
            constexpr double largest = std::numeric_limits<T>::max();
            return static_cast<T>(std::clamp(raw, -largest, largest));
        };
        Interval<T> result{-infinity, infinity};
        if (low) result[0] = open ? std::nextafter(nearest(*low), infinity) : nearest(*low);
        if (high) result[1] = open ? std::nextafter(nearest(*high), -infinity) : nearest(*high);
        return result;
    }
}

template <class T>
std::vector<Interval<T>> intervals(const Condition& condition, const Attribute& attribute)
{
    std::vector<Interval<T>> result;
    for (const Condition::Range& range : condition.ranges) {
        using R = Condition::Relation;
        switch (condition.relation) {
            case R::equal:
            case R::not_equal:
                result.push_back(interval<T>(range.low, range.high, false, attribute));
                break;
            case R::less:
                result.push_back(interval<T>({}, range.high, true, attribute));
                break;
            case R::less_equal:
                result.push_back(interval<T>({}, range.high, false, attribute));
                break;
            case R::greater:
                result.push_back(interval<T>(range.low, {}, true, attribute));
                break;
            case R::greater_equal:
                result.push_back(interval<T>(range.low, {}, false, attribute));
                break;
        }
    }
    return result;
}

template <class T>
class TypedTest final : public AttributeTest {
public:
    TypedTest(const Condition& condition, const Attribute& attribute, std::uint32_t component)
        : component_(component),
          ranges_(intervals<T>(condition, attribute)),
          inside_(condition.relation != Condition::Relation::not_equal)
    {
    }
    void narrow(const Column& column, std::vector<std::uint32_t>& selected) const override
    {
        const T* values = column.as<T>() + component_;
        const std::size_t stride = column.components();
        std::size_t kept = 0;
        for (const std::uint32_t i : selected) {
            const T v = values[i * stride];
            bool inside = false;
            for (const Interval<T>& range : ranges_) inside = inside || (v >= range[0] && v <= range[1]);
            selected[kept] = i;
            kept += inside == inside_;
        }
        selected.resize(kept);
    }

private:
    std::uint32_t component_;
    std::vector<Interval<T>> ranges_;
    bool inside_;
};

}  // namespace

Condition parse_condition(const std::string& text)
{
    using R = Condition::Relation;
    static constexpr std::pair<std::string_view, R> relations[] = {
        {"==", R::equal}, {"!=", R::not_equal}, {"<=", R::less_equal}, {">=", R::greater_equal},
        {"=", R::equal},  {"<", R::less},       {">", R::greater}};
    Condition condition;
    condition.text = text;
    const std::string_view all = text;
    const auto written = written_name(all, "=!<>");
    if (!written) refuse(text, "the quotes around the attribute's name do not match");
    if (written->end == all.size()) refuse(text, "it has no =, !=, <, <=, > or >=");
    condition.name = written->name;
    condition.quoted = written->quoted;
    if (condition.name.empty()) refuse(text, "no attribute stands before the sign");
    if (!condition.quoted && is_number(condition.name))
        throw Error(
            ErrorCode::invalid_argument, {},
            "condition '" + text + "': an attribute stands before the sign, and '" + condition.name + "' is a number",
            "write for example intensity=100..200; an attribute of this name is written in quotes, '" + condition.name +
                "'>3");
    std::string_view rest = all.substr(written->end);
    bool found = false;
    for (const auto& [sign, relation] : relations)
        if (!found && rest.substr(0, sign.size()) == sign) {
            found = true;
            condition.relation = relation;
            rest.remove_prefix(sign.size());
        }
    if (!found) refuse(text, "'!' must be followed by '='");

    const bool lists = condition.relation == R::equal || condition.relation == R::not_equal;
    while (true) {
        const auto comma = rest.find(',');
        const std::string_view item = trim(rest.substr(0, comma));
        const auto dots = item.find("..");
        if (!lists && (dots != std::string_view::npos || comma != std::string_view::npos))
            refuse(text, "one number was expected; lists and ranges are allowed with = and != only");
        Condition::Range range;
        if (dots == std::string_view::npos) {
            range.low = range.high = parse_value(item, text);
        } else {
            const std::string_view low = trim(item.substr(0, dots)), high = trim(item.substr(dots + 2));
            if (low.empty() && high.empty()) refuse(text, "a range needs at least one end");
            if (!low.empty()) range.low = parse_value(low, text);
            if (!high.empty()) range.high = parse_value(high, text);
            if (range.low && range.high && range.low->value > range.high->value)
                refuse(text, "the range '" + std::string(item) + "' ends before it begins");
        }
        condition.ranges.push_back(range);
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    return condition;
}

std::unique_ptr<AttributeTest> make_attribute_test(const Condition& condition, const Attribute& attribute,
                                                   std::uint32_t component)
{
    return with_type(attribute.type, [&](auto zero) -> std::unique_ptr<AttributeTest> {
        return std::make_unique<TypedTest<decltype(zero)>>(condition, attribute, component);
    });
}

CoordinateTest::CoordinateTest(const Condition& condition, std::size_t axis)
    : axis_(axis),
      ranges_(intervals<double>(condition, {condition.name, ScalarType::f64, 1, 1, 0, {}})),
      inside_(condition.relation != Condition::Relation::not_equal)
{
}

std::optional<std::array<double, 2>> CoordinateTest::bounds() const
{
    if (!inside_) return std::nullopt;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& range : ranges_) {
        low = std::min(low, range[0]);
        high = std::max(high, range[1]);
    }
    return std::array<double, 2>{low, high};
}

}  // namespace pcm
