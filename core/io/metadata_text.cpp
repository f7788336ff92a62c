#include "pcm/io/metadata_text.h"

#include <cstring>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

// The key of a VLR, with or without a description at its end.
bool is_geo_directory(std::string_view key)
{
    constexpr std::string_view name = "/LASF_Projection/34735";
    const auto at = key.find(name);
    return at != std::string_view::npos && (at + name.size() == key.size() || key[at + name.size()] == '/');
}

// Ids of GeoTIFF 1.1 (OGC 19-008r4) that LAS files use; others are printed as numbers.
constexpr std::pair<unsigned, std::string_view> geo_keys[] = {
    {1024, "GTModelType"},      {1025, "GTRasterType"},      {1026, "GTCitation"},        {2048, "GeographicType"},
    {2049, "GeogCitation"},     {2050, "GeogGeodeticDatum"}, {2051, "GeogPrimeMeridian"}, {2052, "GeogLinearUnits"},
    {2054, "GeogAngularUnits"}, {2056, "GeogEllipsoid"},     {3072, "ProjectedCSType"},   {3073, "PCSCitation"},
    {3074, "Projection"},       {3075, "ProjCoordTrans"},    {3076, "ProjLinearUnits"},   {4096, "VerticalCSType"},
    {4097, "VerticalCitation"}, {4098, "VerticalDatum"},     {4099, "VerticalUnits"},
};

// Four 16-bit numbers, the last of which is the number of keys; then four per key: id, place of its value (0: here),
// count, value.
std::string geo_directory(const std::vector<std::byte>& value)
{
    const auto number = [&](std::size_t i) {
        std::uint16_t n = 0;
        std::memcpy(&n, value.data() + 2 * i, 2);
        return static_cast<unsigned>(n);
    };
    const std::size_t numbers = value.size() / 2;
    if (numbers < 4) return {};
    std::string text;
    for (std::size_t k = 1; k <= number(3) && 4 * k + 3 < numbers; ++k) {
        const unsigned id = number(4 * k), place = number(4 * k + 1), what = number(4 * k + 3);
        std::string name = "key " + std::to_string(id);
        for (const auto& [known, known_name] : geo_keys)
            if (known == id) name = known_name;
        text += (text.empty() ? "" : ", ") + name;
        if (place == 0) text += " " + std::to_string(what);
    }
    return text;
}

}  // namespace

std::string text_of(const Metadata& block)
{
    if (is_geo_directory(block.key)) return geo_directory(block.value);
    std::string text(reinterpret_cast<const char*>(block.value.data()), block.value.size());
    while (!text.empty() && (text.back() == '\0' || text.back() == ' ' || text.back() == '\n' || text.back() == '\r'))
        text.pop_back();
    for (char& c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool blank = c == '\n' || c == '\r' || c == '\t';
        if (byte >= 0x7f || (byte < 0x20 && !blank)) return {};
        if (blank) c = ' ';
    }
    return text;
}

}  // namespace pcm
