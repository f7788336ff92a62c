// The coordinate system of a cloud, decoded from its metadata, as far as two clouds can be compared by it.
//
// Nothing is transformed and no register of systems is needed: codes, names and units are what the metadata state.
// Pure functions; any thread.
#pragma once

#include "pcm/cloud/metadata.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// A unit of length (`per_unit` in metres) or of angle (in radians). 0: not stated.
struct CrsUnit {
    std::string name;
    double per_unit = 0;
    bool is_known() const { return per_unit > 0; }
};

// The system of positions (x and y; or all three axes of a geocentric system), or of heights.
struct CrsPart {
    std::string name;
    std::string authority;  // authority of the code, upper case: "EPSG", "ESRI"
    unsigned code = 0;      // 0: not stated, or defined by the user
    CrsUnit unit;
    bool is_known() const { return code || !name.empty() || unit.is_known(); }
};

enum class CrsKind { unknown, projected, geographic, geocentric, local };
std::string_view name_of(CrsKind kind);

struct CoordinateSystem {
    CrsKind kind = CrsKind::unknown;
    CrsPart horizontal;
    CrsPart vertical;    // nothing known in a system without heights
    std::string name;    // name of a compound system; else that of `horizontal`; may be empty
    std::string source;  // "GeoTIFF keys", "WKT", "E57 coordinate metadata", "comment"
    std::string wkt;     // where it is given as WKT
};

// The system that a block of text states: WKT 1 or 2, or text with codes such as "EPSG:32632+5783 any name". Nothing
// for empty text; other text is the name of a system.
std::optional<CoordinateSystem> coordinate_system_of_text(std::string_view text, std::string_view source);

// The system of a cloud. LAS: the record that the header's WKT bit chooses, completed by the other one; then E57's
// coordinate metadata, then comments of text files. Nothing where the metadata have none or it cannot be decoded.
std::optional<CoordinateSystem> coordinate_system_of(const std::vector<Metadata>& metadata);

// Metres in a source unit of positions: 1 where the metadata state none, or one of angles.
double metres_per_unit(const std::vector<Metadata>& metadata);

// Whether a block states the coordinate system, or is a part of that: all of these go together.
bool is_crs_block(const Metadata& block);
bool is_wkt_record(const Metadata& block);         // LASF_Projection 2112
bool is_geotiff_record(const Metadata& block);     // LASF_Projection 34735, 34736, 34737
inline constexpr const char* crs_comment = "crs";  // key of a block that text formats keep it in; its value is text

// "NAD83 / UTM zone 15N (EPSG:26915), metre; heights NAVD88 height (EPSG:5703), metre"
std::string describe(const CoordinateSystem& system);
// For formats with comments, without their marks: "crs: EPSG:26915+5703 NAD83 / UTM zone 15N". Only codes and name;
// empty where the metadata state no system, or one without both.
std::string crs_comment_line(const std::vector<Metadata>& metadata);
// The block that such a line among `lines` makes: any comment ("#", "//" or "%") that begins with "crs:".
std::optional<Metadata> crs_block_of_lines(const std::vector<std::string>& lines);

enum class CrsRelation {
    same,
    different,  // in code, name or unit
    unclear,    // only one states a code, or heights; the names differ
};
// Codes of one authority decide; else names, regardless of case, punctuation and the usual abbreviations. Units that
// both state must be equal.
CrsRelation compare(const CoordinateSystem& a, const CoordinateSystem& b);

}  // namespace pcm
