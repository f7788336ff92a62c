#include "pcm/io/scans.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <locale>
#include <sstream>
#include <utility>

namespace pcm {
namespace {

constexpr const char* ptx_scan = "ptx.scan/";
constexpr const char* e57_scan = "e57.scan/";
constexpr std::size_t prefix = 9;

// The number in a key, and what follows it; 0: it has none.
std::pair<std::uint32_t, std::string> number_of(const std::string& key)
{
    if (key.compare(0, prefix, ptx_scan) != 0 && key.compare(0, prefix, e57_scan) != 0) return {0, {}};
    std::uint32_t number = 0;
    const char* const last = key.data() + key.size();
    const auto [end, error] = std::from_chars(key.data() + prefix, last, number);
    return error == std::errc() ? std::pair{number, std::string(end, last)} : std::pair{0u, std::string()};
}

// The numbers after the first few.
std::optional<Vec3d> numbers_after(const Metadata& block, int skipped)
{
    std::istringstream words(std::string(reinterpret_cast<const char*>(block.value.data()), block.value.size()));
    words.imbue(std::locale::classic());
    double number = 0;
    for (int i = 0; i < skipped; ++i)
        if (!(words >> number)) return {};
    Vec3d numbers;
    for (double& each : numbers)
        if (!(words >> each) || !std::isfinite(each)) return {};
    return numbers;
}

}  // namespace

std::uint32_t scans_of(const std::vector<Metadata>& metadata, const Schema& schema)
{
    constexpr std::uint32_t more_than_any = 10000;
    std::uint32_t scans = 0;
    for (const Metadata& block : metadata) scans = std::max(scans, number_of(block.key).first);
    return scans == 1 && schema.find(scan_attribute) ? more_than_any : scans;
}

std::optional<std::size_t> place_for_scan_numbers(Schema& schema)
{
    if (const auto place = schema.find(scan_attribute)) {
        const Attribute& there = schema[*place];
        const bool fits =
            there.type == ScalarType::u32 && there.components == 1 && there.scale == 1 && there.offset == 0;
        return fits ? place : std::nullopt;
    }
    schema.add({scan_attribute, ScalarType::u32, 1, 1, 0, "number of the scan, from 1, in the order of the files"});
    return schema.size() - 1;
}

void number_scans(Column& column, std::size_t count, std::uint32_t before, bool numbered)
{
    auto* const numbers = column.as<std::uint32_t>();
    for (std::size_t i = 0; i < count; ++i) numbers[i] = before + (numbered ? numbers[i] : 1);
}

std::string renumbered(const std::string& key, std::uint32_t before)
{
    const auto [number, rest] = number_of(key);
    return number > 0 ? key.substr(0, prefix) + std::to_string(number + before) + rest : key;
}

std::map<std::uint32_t, Vec3d> scan_positions(const std::vector<Metadata>& metadata)
{
    constexpr int before_translation = 2 + 12 + 12;  // columns, rows, pose, and three of the transform's lines
    std::map<std::uint32_t, Vec3d> positions;
    for (const Metadata& block : metadata) {
        const auto [number, rest] = number_of(block.key);
        if (number == 0) continue;
        std::optional<Vec3d> position;
        if (block.key.compare(0, prefix, ptx_scan) == 0 && rest.empty())
            position = numbers_after(block, before_translation);
        else if (rest == "/pose")
            position = numbers_after(block, 0);
        if (position) positions[number] = *position;
    }
    return positions;
}

}  // namespace pcm
