#include "pcm/ops/values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace pcm::ops {
namespace {

std::string quoted(const std::string& word) { return "'" + word + "'"; }

// All of the word as a number.
std::errc read(const std::string& word, double& value)
{
    const std::size_t sign = !word.empty() && word[0] == '+';
    const auto result = std::from_chars(word.data() + sign, word.data() + word.size(), value);
    return result.ptr == word.data() + word.size() ? result.ec : std::errc::invalid_argument;
}

// Whether a word is nearly a name: a typing error or two, or its beginning.
bool resembles(const std::string& word, const std::string& name)
{
    if (word.size() >= 2 && name.compare(0, word.size(), word) == 0) return true;
    std::vector<std::size_t> row(name.size() + 1);  // distances of Levenshtein, row by row
    for (std::size_t c = 0; c < row.size(); ++c) row[c] = c;
    for (std::size_t w = 0; w < word.size(); ++w) {
        std::size_t diagonal = row[0];
        row[0] = w + 1;
        for (std::size_t c = 1; c < row.size(); ++c) {
            const std::size_t above = row[c];
            row[c] = std::min({above + 1, row[c - 1] + 1, diagonal + (word[w] != name[c - 1])});
            diagonal = above;
        }
    }
    return row.back() <= 1 + name.size() / 5;
}

}  // namespace

std::string short_text(double value)
{
    char text[40];
    std::snprintf(text, sizeof text, "%.10g", value);
    return text;
}

std::string text_of(const AllowedNumbers& allowed)
{
    const std::string number = allowed.whole ? "a whole number" : "a number";
    if (allowed.least && allowed.most)
        return number + " from " + short_text(*allowed.least) + " to " + short_text(*allowed.most);
    if (allowed.least && allowed.above_least) return number + " greater than " + short_text(*allowed.least);
    if (allowed.least) return number + " that is " + short_text(*allowed.least) + " or more";
    return number;
}

std::string brief_text_of(const AllowedNumbers& allowed)
{
    if (allowed.least && allowed.most) return short_text(*allowed.least) + " to " + short_text(*allowed.most);
    if (allowed.least)
        return allowed.above_least ? "above " + short_text(*allowed.least) : short_text(*allowed.least) + " or more";
    return "";
}

std::string number_fault(const std::string& word, const AllowedNumbers& allowed)
{
    double value = 0;
    const std::errc error = read(word, value);
    if (error == std::errc::result_out_of_range) return quoted(word) + " is too large or too small a number";
    const bool holds = error == std::errc() && !(allowed.whole && std::nearbyint(value) != value) &&
                       !(allowed.least && !(allowed.above_least ? value > *allowed.least : value >= *allowed.least)) &&
                       !(allowed.most && !(value <= *allowed.most)) &&
                       !((allowed.least || allowed.most) && !std::isfinite(value));
    return holds ? "" : quoted(word) + " is not " + text_of(allowed);
}

std::string whole_fault(std::string& word, std::uint64_t most)
{
    const std::string given = word;
    const std::size_t sign = !word.empty() && word[0] == '+';
    std::uint64_t value = 0;
    const char* const end = word.data() + word.size();
    const auto result = std::from_chars(word.data() + sign, end, value);
    if (result.ptr != end || result.ec != std::errc()) {
        // Doubles hold all whole numbers up to 2^53.
        double real = 0;
        const bool is_whole = read(word, real) == std::errc() && std::nearbyint(real) == real;
        if (!is_whole || real < 0) return quoted(given) + " is not a whole number" + (is_whole ? ", 0 or more" : "");
        if (real >= 0x1p53) return quoted(given) + " is too large; " + std::to_string(most) + " is the largest";
        value = static_cast<std::uint64_t>(real);
    }
    if (value > most) return quoted(given) + " is too large; " + std::to_string(most) + " is the largest";
    word = std::to_string(value);
    return "";
}

std::string bytes_fault(std::string& word)
{
    const std::string given = word;
    const auto fault = [&] {
        return quoted(given) + " is not a size: write a number and a unit (K, M, G or T), as in 512M or 2G";
    };
    const std::size_t digits = std::min(word.find_first_not_of("0123456789."), word.size());
    std::string unit = word.substr(digits);
    unit.erase(0, std::min(unit.find_first_not_of(' '), unit.size()));
    for (char& c : unit) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    for (const char* const end : {"ib", "b"})  // KiB and KB are K
        if (const std::string tail = end; unit.size() == 1 + tail.size() && unit.substr(1) == tail) unit.resize(1);
    const std::string units = "bkmgtp";
    const std::size_t power = unit.empty() ? 0 : units.find(unit);
    double value = 0;
    if (digits == 0 || unit.size() > 1 || power == std::string::npos ||
        read(word.substr(0, digits), value) != std::errc())
        return fault();
    value = std::nearbyint(std::ldexp(value, static_cast<int>(10 * power)));
    if (!(value < 0x1p63)) return quoted(given) + " is too large a size";
    word = std::to_string(static_cast<std::uint64_t>(value));
    return "";
}

std::string choice_fault(const std::string& word, const std::vector<std::string>& choices)
{
    if (std::find(choices.begin(), choices.end(), word) != choices.end()) return "";
    std::string all;
    for (std::size_t i = 0; i < choices.size(); ++i)
        all += (i == 0 ? "" : i + 1 < choices.size() ? ", " : " or ") + choices[i];
    return quoted(word) + " is not " + all + perhaps(word, choices);
}

std::string perhaps(const std::string& word, const std::vector<std::string>& names)
{
    std::string nearest;
    for (const std::string& name : names)
        if (resembles(word, name)) nearest += (nearest.empty() ? "" : " or ") + name;
    return nearest.empty() ? "" : "; perhaps " + nearest;
}

}  // namespace pcm::ops
