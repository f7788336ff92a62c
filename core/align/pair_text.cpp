#include "pcm/align/pair_text.h"

#include "pcm/io/file_text.h"
#include "pcm/io/text/parse_number.h"
#include "pcm/system/error.h"
#include "pcm/system/output_file.h"
#include "pcm/system/text.h"
#include "pcm/system/text_file.h"

#include <array>
#include <cmath>

namespace pcm {
namespace {

constexpr std::uint64_t most_bytes = 16u << 20;

[[noreturn]] void refuse(const std::filesystem::path& name, std::size_t line, const std::string& what)
{
    throw Error(ErrorCode::bad_format, name, "line " + std::to_string(line) + ": " + what,
                "a pair is x y z of the moving point, x y z of the fixed one, and optionally a weight");
}

bool separates(char c) { return text::is_blank(c) || c == '\r' || c == ',' || c == ';'; }

std::vector<double> numbers_of(std::string_view line, const std::filesystem::path& name, std::size_t number)
{
    std::vector<double> values;
    std::size_t at = 0;
    while (true) {
        while (at < line.size() && separates(line[at])) ++at;
        if (at == line.size()) return values;
        std::size_t end = at;
        while (end < line.size() && !separates(line[end])) ++end;
        const std::string_view word = line.substr(at, end - at);
        double value = 0;
        if (!text::parse_number(word, value)) refuse(name, number, quote_bytes(word) + " is not a number");
        if (!std::isfinite(value)) refuse(name, number, "'" + std::string(word) + "' is not finite");
        values.push_back(value);
        at = end;
    }
}

}  // namespace

std::vector<PointPair> parse_pairs(std::string_view text, const std::filesystem::path& name)
{
    std::vector<PointPair> pairs;
    std::size_t number = 0;
    while (!text.empty()) {
        ++number;
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        line = line.substr(0, line.find('#'));
        const std::vector<double> v = numbers_of(line, name, number);
        if (v.empty()) continue;
        if (v.size() != 6 && v.size() != 7)
            refuse(name, number, "6 or 7 numbers were expected, and there are " + std::to_string(v.size()));
        PointPair pair{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v.size() == 7 ? v[6] : 1};
        if (!(pair.weight >= 0)) refuse(name, number, "the weight is below 0");
        pairs.push_back(pair);
    }
    return pairs;
}

std::vector<PointPair> read_pairs(const std::filesystem::path& file)
{
    return parse_pairs(read_text_file(file, "a list of picked pairs", most_bytes), file);
}

std::string text_of(const std::vector<PointPair>& pairs)
{
    std::string text = "# x y z of the moving point, x y z of the fixed point, weight (1 where none is given)\n";
    for (const PointPair& pair : pairs)
        text +=
            exact(pair.moving) + "  " + exact(pair.fixed) + (pair.weight == 1 ? "" : "  " + exact(pair.weight)) + "\n";
    return text;
}

void write_pairs(const std::vector<PointPair>& pairs, const std::filesystem::path& file)
{
    OutputFile out(file);
    out.append(text_of(pairs));
    out.finish();
}

}  // namespace pcm
