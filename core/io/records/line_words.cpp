#include "pcm/io/records/line_words.h"

#include "pcm/cloud/with_type.h"
#include "pcm/io/text/parse_number.h"

#include <fast_float/fast_float.h>

#include <charconv>
#include <cstring>
#include <type_traits>

namespace pcm {
namespace {

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
    // fast_float returns infinity for numbers that are too large and 0 for those too small, as documented.
    if (stop && (stop == end_ || separates(*stop))) {
        at_ = stop;
    } else {
        word = next();
        if (word.empty() || !text::parse_number(word, value)) return false;
    }
    std::memcpy(to, &value, sizeof value);
    return true;
}

bool LineWords::next_number(ScalarType type, std::byte* to, std::string_view& word)
{
    return with_type(type, [&](auto example) { return take<decltype(example)>(to, word); });
}

}  // namespace pcm
