#include "tests/ops/frozen_answers.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <set>
#include <vector>

namespace pcm::test {
namespace {

using ops::Json;

constexpr std::size_t longest_list = 12, most_lines = 10;

bool is_of_the_run(const std::string& key)
{
    static const std::set<std::string> keys{"version",        "points_read", "bytes_read",    "requests",
                                            "bytes_received", "peak_memory", "scratch_bytes", "creation_day",
                                            "creation_year",  "load_times"};
    return keys.count(key) > 0 || key.find("seconds") != std::string::npos;
}

// False where there is anything but numbers.
bool add_numbers(const Json& json, std::vector<double>& numbers)
{
    if (json.is_number()) return numbers.push_back(json.get<double>()), true;
    return json.is_array() &&
           std::all_of(json.begin(), json.end(), [&](const Json& e) { return add_numbers(e, numbers); });
}

Json sums_of(const std::vector<double>& numbers)
{
    double sum = 0, weighted = 0, place = 0;
    for (const double number : numbers)
        sum += number, weighted += number * (++place / static_cast<double>(numbers.size()));
    return {{"numbers", numbers.size()}, {"sum", sum}, {"weighted", weighted}};
}

std::string without(std::string text, const std::string& folder)
{
    for (std::size_t at = 0; (at = text.find(folder, at)) != std::string::npos;) text.replace(at, folder.size(), "@");
    return text;
}

void compare(const Json& kept, const Json& now, const std::string& at, std::vector<std::string>& lines)
{
    if (kept.is_number() && now.is_number()) {
        const double a = kept.get<double>(), b = now.get<double>();
        if (std::fabs(a - b) <= 1e-6 * std::max(std::fabs(a), std::fabs(b)) + 1e-9) return;
    } else if (kept.is_object() && now.is_object()) {
        std::set<std::string> keys;
        for (const auto& [key, value] : kept.items()) keys.insert(key);
        for (const auto& [key, value] : now.items()) keys.insert(key);
        for (const std::string& key : keys)
            compare(kept.value(key, Json("missing")), now.value(key, Json("missing")), at + "/" + key, lines);
        return;
    } else if (kept.is_array() && now.is_array() && kept.size() == now.size()) {
        for (std::size_t i = 0; i < kept.size(); ++i) compare(kept[i], now[i], at + "/" + std::to_string(i), lines);
        return;
    } else if (kept == now) {
        return;
    }
    lines.push_back(at + ": " + now.dump().substr(0, 200) + " instead of " + kept.dump().substr(0, 200));
}

}  // namespace

std::string frozen_line(const std::string& line)
{
    static const std::regex number("-?[0-9][0-9,]*([.][0-9]+)?(e[-+]?[0-9]+)?( ?[munkMG]?(s|B)?)?\\b"), blanks(" +");
    return std::regex_replace(std::regex_replace(line, number, "#"), blanks, " ");
}

Json frozen(const Json& answer, const std::filesystem::path& folder)
{
    if (answer.is_string()) return without(answer.get<std::string>(), folder.string());
    if (answer.is_object()) {
        Json left = Json::object();
        for (const auto& [key, value] : answer.items())
            if (!is_of_the_run(key)) left[key] = frozen(value, folder);
        if (left.contains("lines"))
            for (Json& line : left["lines"]) line = frozen_line(line.get<std::string>());
        return left;
    }
    if (!answer.is_array()) return answer;
    std::vector<double> numbers;
    if (add_numbers(answer, numbers) && numbers.size() > longest_list) return sums_of(numbers);
    Json left = Json::array();
    for (const Json& element : answer) left.push_back(frozen(element, folder));
    return left;
}

Json frozen_text(const std::string& whole, const std::filesystem::path& folder)
{
    const std::string text = without(whole, folder.string());
    std::vector<double> numbers, letters;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" ,;\n\r\t\"()", i), text.size());
        const std::string word = text.substr(i, end - i);
        char* rest = nullptr;
        const double number = std::strtod(word.c_str(), &rest);
        // Whole numbers may be hexadecimal: handles of a drawing, such as 1E5.
        const bool is_number = !word.empty() && *rest == 0 && std::isfinite(number) &&
                               (word.find('.') != std::string::npos || word.find_first_of("eE") == std::string::npos);
        if (is_number) numbers.push_back(number);
        for (std::size_t k = is_number ? end : i; k < std::min(end + 1, text.size()); ++k)
            letters.push_back(static_cast<unsigned char>(text[k]));
        i = end + 1;
    }
    return {{"numbers", sums_of(numbers)}, {"letters", sums_of(letters)}};
}

std::string kept_text(const Json& frozen, int outer)
{
    if (outer == 0 || !frozen.is_object() || frozen.empty()) return frozen.dump();
    std::string text;
    for (const auto& [key, value] : frozen.items())
        text += (text.empty() ? "{\n" : ",\n") + Json(key).dump() + ": " + kept_text(value, outer - 1);
    return text + "\n}";
}

std::string differences(const Json& kept, const Json& now)
{
    std::vector<std::string> lines;
    compare(kept, now, "", lines);
    std::string text;
    for (std::size_t i = 0; i < std::min(lines.size(), most_lines); ++i) text += lines[i] + "\n";
    if (lines.size() > most_lines) text += "and " + std::to_string(lines.size() - most_lines) + " more\n";
    return text;
}

}  // namespace pcm::test
