// What the names of columns mean, in the languages and words of surveying and of common programs.
//
// Names are compared without regard to case, diacritics and signs; a part in brackets, and units and systems next to
// the name ("Easting [m]", "X_utm") do not count. Only names that mean one thing are known: X is x even where surveyors
// let it point north.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace pcm {

// The letters and digits of a name in UTF-8 or Latin-1, in lower case and without diacritics: "GPS Time [s]" ->
// "gpstime", "Höhe" -> "hohe".
std::string bare_name(std::string_view name);

// UTF-8 as it is; other text is taken for Latin-1.
std::string as_utf8(std::string_view text);

// A coordinate axis that a name may mean.
struct AxisName {
    // The horizontal axes of a file come from one of these, the first of which both are there.
    enum class Kind : unsigned char { plain, projected, geographic };
    std::size_t axis = 0;  // 0: x, east, longitude; 1: y, north, latitude; 2: z, height
    Kind kind = Kind::plain;
    unsigned rank = 0;  // if there are several names for an axis, the one of the lowest rank counts
};
std::optional<AxisName> axis_name(std::string_view name);

// The column that a name stands for, as in TextLayout::columns: the column of the name itself ("Intensity",
// "GpsTime"), or one that it is another word for ("Klasse", "Rouge"). Empty when it is not known.
std::string_view own_meaning(std::string_view name);
std::string_view other_meaning(std::string_view name);

// Whether a column of this name may well hold text: descriptions, codes, numbers of points with letters.
bool names_a_label(std::string_view name);

}  // namespace pcm
