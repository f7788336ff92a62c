#include "pcm/io/crs/geo_keys.h"

#include "pcm/io/crs/crs_units.h"
#include "pcm/io/file_text.h"

#include <cstring>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

constexpr unsigned doubles_record = 34736, ascii_record = 34737;
constexpr unsigned user_defined = 32767;

enum : unsigned {
    model_type = 1024,
    citation = 1026,
    geographic_type = 2048,
    geographic_citation = 2049,
    geographic_linear_units = 2052,
    geographic_angular_units = 2054,
    projected_type = 3072,
    projected_citation = 3073,
    projected_units = 3076,
    projected_unit_size = 3077,
    vertical_type = 4096,
    vertical_citation = 4097,
    vertical_units = 4099,
};

// Keys that LAS files use; others are printed as numbers.
constexpr std::pair<unsigned, std::string_view> key_names[] = {
    {1024, "GTModelType"},      {1025, "GTRasterType"},      {1026, "GTCitation"},        {2048, "GeographicType"},
    {2049, "GeogCitation"},     {2050, "GeogGeodeticDatum"}, {2051, "GeogPrimeMeridian"}, {2052, "GeogLinearUnits"},
    {2054, "GeogAngularUnits"}, {2056, "GeogEllipsoid"},     {3072, "ProjectedCSType"},   {3073, "PCSCitation"},
    {3074, "Projection"},       {3075, "ProjCoordTrans"},    {3076, "ProjLinearUnits"},   {4096, "VerticalCSType"},
    {4097, "VerticalCitation"}, {4098, "VerticalDatum"},     {4099, "VerticalUnits"},
};

class Decoder {
public:
    Decoder(const std::vector<std::byte>& directory, const std::vector<std::byte>& doubles,
            const std::vector<std::byte>& ascii)
        : keys_(geo_keys_of(directory)),
          doubles_(doubles),
          ascii_(reinterpret_cast<const char*>(ascii.data()), ascii.size())
    {
    }

    std::optional<CoordinateSystem> decode() const
    {
        CoordinateSystem system;
        system.source = "GeoTIFF keys";
        const unsigned model = number(model_type), projected = number(projected_type),
                       geographic = number(geographic_type);
        const bool is_geocentric = model == 3 && !projected;
        const bool is_projected = projected || model == 1;
        system.kind = is_projected               ? CrsKind::projected
                      : is_geocentric            ? CrsKind::geocentric
                      : model == 2 || geographic ? CrsKind::geographic
                                                 : CrsKind::unknown;
        system.horizontal = is_projected ? part(projected, {projected_citation, citation})
                                         : part(geographic, {geographic_citation, citation});
        system.horizontal.unit = is_projected    ? unit_of_code(number(projected_units))
                                 : is_geocentric ? unit_of_code(number(geographic_linear_units))
                                                 : unit_of_code(number(geographic_angular_units));
        if (is_projected && number(projected_units) == user_defined)
            system.horizontal.unit = linear_unit("unit", real(projected_unit_size));
        // GeoTIFF 1.0 numbered the vertical datums; EPSG's codes of the systems are 600 higher.
        const unsigned heights = number(vertical_type);
        system.vertical = part(heights >= 5101 && heights <= 5106 ? heights + 600 : heights, {vertical_citation});
        system.vertical.unit = unit_of_code(number(vertical_units));
        system.name = system.horizontal.name;
        if (system.kind == CrsKind::unknown && !system.horizontal.is_known() && !system.vertical.is_known()) return {};
        return system;
    }

private:
    const GeoKey* find(unsigned id) const
    {
        for (const GeoKey& key : keys_)
            if (key.id == id) return &key;
        return nullptr;
    }
    unsigned number(unsigned id) const
    {
        const GeoKey* key = find(id);
        return key && key->place == 0 ? key->value : 0;
    }
    double real(unsigned id) const
    {
        const GeoKey* key = find(id);
        double value = 0;
        if (key && key->place == doubles_record && (key->value + std::size_t{1}) * 8 <= doubles_.size())
            std::memcpy(&value, doubles_.data() + std::size_t{8} * key->value, 8);
        return value;
    }
    // Texts end with '|'; citations of some programs hold further ones, "Primem = Greenwich|", which are left out.
    std::string text(unsigned id) const
    {
        const GeoKey* key = find(id);
        if (!key || key->place != ascii_record || key->value >= ascii_.size()) return {};
        std::string_view found = ascii_.substr(key->value, key->count);
        found = found.substr(0, found.find('|'));
        for (const std::string_view label : {"PCS Name = ", "GCS Name = ", "VCS Name = "})
            if (found.substr(0, label.size()) == label) found.remove_prefix(label.size());
        return printable_name(found);
    }
    CrsPart part(unsigned code, std::initializer_list<unsigned> citations) const
    {
        CrsPart part;
        if (code && code != user_defined) {
            part.authority = "EPSG";
            part.code = code;
        }
        for (const unsigned id : citations)
            if (part.name.empty()) part.name = text(id);
        return part;
    }

    const std::vector<GeoKey> keys_;
    const std::vector<std::byte>& doubles_;
    const std::string_view ascii_;
};

}  // namespace

// Four 16-bit numbers, the last of which is the number of keys; then four per key.
std::vector<GeoKey> geo_keys_of(const std::vector<std::byte>& directory)
{
    const auto number = [&](std::size_t i) {
        std::uint16_t n = 0;
        std::memcpy(&n, directory.data() + 2 * i, 2);
        return static_cast<unsigned>(n);
    };
    const std::size_t numbers = directory.size() / 2;
    std::vector<GeoKey> keys;
    if (numbers < 4) return keys;
    for (std::size_t k = 1; k <= number(3) && 4 * k + 3 < numbers; ++k)
        keys.push_back({number(4 * k), number(4 * k + 1), number(4 * k + 2), number(4 * k + 3)});
    return keys;
}

std::string name_of_geo_key(unsigned id)
{
    for (const auto& [known, name] : key_names)
        if (known == id) return std::string(name);
    return "key " + std::to_string(id);
}

std::optional<CoordinateSystem> decode_geo_keys(const std::vector<std::byte>& directory,
                                                const std::vector<std::byte>& doubles,
                                                const std::vector<std::byte>& ascii)
{
    return Decoder(directory, doubles, ascii).decode();
}

}  // namespace pcm
