#include "pcm/io/metadata_text.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/crs/geo_keys.h"

#include <string_view>

namespace pcm {
namespace {

// The key of a VLR, with or without a description at its end.
bool is_geo_directory(std::string_view key)
{
    constexpr std::string_view name = "/LASF_Projection/34735";
    const auto at = key.find(name);
    return at != std::string_view::npos && (at + name.size() == key.size() || key[at + name.size()] == '/');
}

std::string geo_directory(const std::vector<std::byte>& value)
{
    std::string text;
    for (const GeoKey& key : geo_keys_of(value)) {
        text += (text.empty() ? "" : ", ") + name_of_geo_key(key.id);
        if (key.place == 0) text += " " + std::to_string(key.value);
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

std::string unwritten_note(const std::string& format, const std::vector<Metadata>& metadata,
                           bool (*is_written)(const Metadata&))
{
    constexpr std::size_t most_named = 4;
    std::size_t count = 0;
    std::string names;
    for (const Metadata& block : metadata) {
        const std::string& key = block.key;
        // The description of extra bytes is in the names of the columns.
        if (key == "las.header" || key == "pcm.grid" || key == "pcm.decimals" || key == "pcd.viewpoint" ||
            key == crs_comment || key.rfind("las.vlr/LASF_Spec/4/", 0) == 0)
            continue;
        if (is_written && is_written(block)) continue;
        if (count++ < most_named) names += (names.empty() ? "" : ", ") + key;
    }
    if (count == 0) return {};
    if (count > most_named) names += " and " + std::to_string(count - most_named) + " more";
    return format + " has no place for metadata, which are not written: " + names;
}

}  // namespace pcm
