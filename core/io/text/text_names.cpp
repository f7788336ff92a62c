#include "pcm/io/text/text_names.h"

#include "pcm/io/text/text_columns.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace pcm {
namespace {

struct Synonym {
    std::string_view name, meaning;
};

// Horizontal axes in addition to x and y.
constexpr std::string_view east_names[] = {
    "easting", "eastings", "east", "e",       "rechtswert", "rechts", "ostwert", "ostkoordinate", "ost",    "rw", "est",
    "este",    "leste",    "oost", "oosting", "wschod",     "dogu",   "восток",  "восточная",     "东坐标", "东",
};
constexpr std::string_view north_names[] = {
    "northing", "northings", "north",    "n",      "hochwert", "hoch",  "nordwert", "nordkoordinate", "nord", "hw",
    "norte",    "noord",     "noording", "polnoc", "kuzey",    "север", "северная", "北坐标",         "北",
};
constexpr std::string_view longitude_names[] = {
    "longitude",  "lon",    "long",  "lng",         "longitud", "longitudine", "laengengrad",
    "langengrad", "laenge", "lange", "lengtegraad", "долгота",  "经度",
};
constexpr std::string_view latitude_names[] = {
    "latitude", "lat", "latitud", "latitudine", "breitengrad", "breite", "breedtegraad", "широта", "纬度",
};
constexpr std::string_view height_names[] = {
    "elevation", "elev",      "ele",      "height",  "heights", "hgt",       "altitude", "alt",     "hoehe",
    "hohe",      "hauteur",   "cota",     "altura",  "altitud", "elevacion", "quota",    "altezza", "elevazione",
    "elevacao",  "hoogte",    "wysokosc", "rzedna",  "vyska",   "hojd",      "hojde",    "hoyde",   "korkeus",
    "kota",      "yukseklik", "высота",   "отметка", "高程",    "标高",
};
// Height where nothing better is there.
constexpr std::string_view weak_height_names[] = {
    "h", "orthometricheight", "orthoheight", "ellipsoidalheight", "ellipsoidheight", "ellheight",
};

struct PlainAxis {
    std::string_view name;
    std::size_t axis;
};
constexpr PlainAxis plain_axes[] = {
    {"x", 0}, {"coordx", 0}, {"xcoord", 0}, {"xcoordinate", 0}, {"pointx", 0}, {"xwert", 0},
    {"y", 1}, {"coordy", 1}, {"ycoord", 1}, {"ycoordinate", 1}, {"pointy", 1}, {"ywert", 1},
    {"z", 2}, {"coordz", 2}, {"zcoord", 2}, {"zcoordinate", 2}, {"pointz", 2}, {"zwert", 2},
};

constexpr Synonym synonyms[] = {
    {"red", "r"},
    {"colorred", "r"},
    {"colourred", "r"},
    {"diffusered", "r"},
    {"rf", "r"},
    {"rot", "r"},
    {"rouge", "r"},
    {"rojo", "r"},
    {"rosso", "r"},
    {"vermelho", "r"},
    {"rood", "r"},
    {"czerwony", "r"},
    {"красный", "r"},
    {"green", "g"},
    {"colorgreen", "g"},
    {"colourgreen", "g"},
    {"diffusegreen", "g"},
    {"gf", "g"},
    {"grun", "g"},
    {"gruen", "g"},
    {"vert", "g"},
    {"verde", "g"},
    {"groen", "g"},
    {"zielony", "g"},
    {"зеленый", "g"},
    {"blue", "b"},
    {"colorblue", "b"},
    {"colourblue", "b"},
    {"diffuseblue", "b"},
    {"bf", "b"},
    {"blau", "b"},
    {"bleu", "b"},
    {"azul", "b"},
    {"blu", "b"},
    {"blauw", "b"},
    {"niebieski", "b"},
    {"синий", "b"},
    {"normalx", "nx"},
    {"xnormal", "nx"},
    {"normx", "nx"},
    {"normaly", "ny"},
    {"ynormal", "ny"},
    {"normy", "ny"},
    {"normalz", "nz"},
    {"znormal", "nz"},
    {"normz", "nz"},
    {"i", "intensity"},
    {"int", "intensity"},
    {"intens", "intensity"},
    {"intensitat", "intensity"},
    {"intensitaet", "intensity"},
    {"intensite", "intensity"},
    {"intensidad", "intensity"},
    {"intensita", "intensity"},
    {"intensidade", "intensity"},
    {"intensiteit", "intensity"},
    {"intensywnosc", "intensity"},
    {"интенсивность", "intensity"},
    {"reflectance", "intensity"},
    {"reflectivity", "intensity"},
    {"reflektanz", "intensity"},
    {"remission", "intensity"},
    {"class", "classification"},
    {"classid", "classification"},
    {"klasse", "classification"},
    {"klassifikation", "classification"},
    {"klassifizierung", "classification"},
    {"classe", "classification"},
    {"clase", "classification"},
    {"clasificacion", "classification"},
    {"classificacao", "classification"},
    {"classificazione", "classification"},
    {"classificatie", "classification"},
    {"klasa", "classification"},
    {"klasyfikacja", "classification"},
    {"класс", "classification"},
    {"классификация", "classification"},
    {"return", "return_number"},
    {"returnno", "return_number"},
    {"returnnum", "return_number"},
    {"returnnr", "return_number"},
    {"rn", "return_number"},
    {"numreturns", "number_of_returns"},
    {"nreturns", "number_of_returns"},
    {"returncount", "number_of_returns"},
    {"returns", "number_of_returns"},
    {"time", "gps_time"},
    {"zeit", "gps_time"},
    {"temps", "gps_time"},
    {"tiempo", "gps_time"},
    {"tempo", "gps_time"},
    {"tijd", "gps_time"},
    {"czas", "gps_time"},
    {"время", "gps_time"},
    {"pointsource", "point_source_id"},
    {"sourceid", "point_source_id"},
    {"infrared", "nir"},
    {"nearinfrared", "nir"},
};

constexpr std::string_view meanings_apart[] = {"r", "g", "b", "nx", "ny", "nz", "intensity", "scan_angle"};

constexpr std::string_view label_names[] = {
    "p",       "pt",          "ptno",        "ptnr",         "ptid",        "pointno",    "pointnr",  "pointnumber",
    "pointid", "pointname",   "point",       "id",           "name",        "no",         "nr",       "num",
    "number",  "punkt",       "punktnr",     "punktnummer",  "pktnr",       "pnr",        "nummer",   "numero",
    "punto",   "matricule",   "d",           "desc",         "description", "descriptor", "code",     "codes",
    "feature", "featurecode", "fcode",       "remark",       "remarks",     "comment",    "note",     "label",
    "layer",   "type",        "bezeichnung", "beschreibung", "bemerkung",   "kommentar",  "punktart", "descripcion",
    "codigo",  "descrizione", "codice",      "descricao",    "opis",        "kod",        "код",      "имя",
    "номер",   "описание",
};

// Words next to a name that do not change what it means: units, systems, "coordinate".
constexpr std::string_view qualifiers[] = {
    "m",          "mm",         "cm",     "km",         "ft",         "usft",       "ftus",   "feet",    "meter",
    "meters",     "metre",      "metres", "metri",      "metros",     "deg",        "degree", "degrees", "dd",
    "utm",        "wgs84",      "etrs89", "etrs",       "gk",         "lv95",       "lv03",   "nad83",   "nad27",
    "navd88",     "nhn",        "nn",     "dhhn92",     "dhhn2016",   "osgb",       "bng",    "l93",     "lambert93",
    "lambert",    "mga",        "gda94",  "gda2020",    "nztm",       "local",      "global", "world",   "coord",
    "coordinate", "koordinate", "coords", "coordonnee", "coordenada", "coordinata",
};

template <std::size_t Count>
bool has(const std::string_view (&names)[Count], std::string_view name)
{
    return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

struct Range {
    std::uint32_t first, last;
    std::string_view letters;
};
// Letters with diacritics, of both cases.
constexpr Range latin[] = {
    {0xC0, 0xC5, "a"},   {0xC6, 0xC6, "ae"},   {0xC7, 0xC7, "c"},   {0xC8, 0xCB, "e"},   {0xCC, 0xCF, "i"},
    {0xD0, 0xD0, "d"},   {0xD1, 0xD1, "n"},    {0xD2, 0xD6, "o"},   {0xD8, 0xD8, "o"},   {0xD9, 0xDC, "u"},
    {0xDD, 0xDD, "y"},   {0xDF, 0xDF, "ss"},   {0xE0, 0xE5, "a"},   {0xE6, 0xE6, "ae"},  {0xE7, 0xE7, "c"},
    {0xE8, 0xEB, "e"},   {0xEC, 0xEF, "i"},    {0xF0, 0xF0, "d"},   {0xF1, 0xF1, "n"},   {0xF2, 0xF6, "o"},
    {0xF8, 0xF8, "o"},   {0xF9, 0xFC, "u"},    {0xFD, 0xFD, "y"},   {0xFF, 0xFF, "y"},   {0x100, 0x105, "a"},
    {0x106, 0x10D, "c"}, {0x10E, 0x111, "d"},  {0x112, 0x11B, "e"}, {0x11C, 0x123, "g"}, {0x124, 0x127, "h"},
    {0x128, 0x131, "i"}, {0x134, 0x135, "j"},  {0x136, 0x138, "k"}, {0x139, 0x142, "l"}, {0x143, 0x14B, "n"},
    {0x14C, 0x151, "o"}, {0x152, 0x153, "oe"}, {0x154, 0x159, "r"}, {0x15A, 0x161, "s"}, {0x162, 0x167, "t"},
    {0x168, 0x173, "u"}, {0x174, 0x175, "w"},  {0x176, 0x178, "y"}, {0x179, 0x17E, "z"}, {0x218, 0x219, "s"},
    {0x21A, 0x21B, "t"},
};

// The character at `at`, which moves behind it; a byte that is not UTF-8 is Latin-1.
std::uint32_t take_character(std::string_view text, std::size_t& at)
{
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char first = byte(at);
    const std::size_t more = first >= 0xF0 && first < 0xF8 ? 3 : first >= 0xE0 ? 2 : first >= 0xC2 ? 1 : 0;
    std::uint32_t character = first & (0x3Fu >> more);
    bool whole = more && at + more < text.size() && first < 0xF8;
    for (std::size_t i = 1; whole && i <= more; ++i) {
        whole = (byte(at + i) & 0xC0) == 0x80;
        character = character << 6 | (byte(at + i) & 0x3Fu);
    }
    at += whole ? more + 1 : 1;
    return whole ? character : first;
}

// The words of a name: runs of letters and digits, in lower case and without diacritics.
std::vector<std::string> words_of(std::string_view name)
{
    name = name.substr(0, name.find_first_of("[("));
    std::vector<std::string> words(1);
    for (std::size_t at = 0; at < name.size();) {
        const std::size_t start = at;
        std::uint32_t c = take_character(name, at);
        if (c >= 'A' && c <= 'Z') c += 'a' - 'A';
        if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
            words.back() += static_cast<char>(c);
            continue;
        }
        if (c >= 0x300 && c < 0x370) continue;  // a diacritic of its own
        const auto letter = std::find_if(std::begin(latin), std::end(latin),
                                         [c](const Range& range) { return c >= range.first && c <= range.last; });
        if (letter != std::end(latin)) {
            words.back() += letter->letters;
        } else if (c >= 0x400 && c < 0x460) {  // Cyrillic
            c = c == 0x401 || c == 0x451 ? 0x435 : c >= 0x410 && c < 0x430 ? c + 0x20 : c;
            words.back() += static_cast<char>(0xC0 | c >> 6);
            words.back() += static_cast<char>(0x80 | (c & 0x3F));
        } else if (c >= 0x370 && (c < 0x2000 || c >= 0x3040)) {
            words.back() += name.substr(start, at - start);
        } else if (!words.back().empty()) {
            words.emplace_back();
        }
    }
    if (words.size() > 1 && words.back().empty()) words.pop_back();
    return words;
}

std::string joined(const std::vector<std::string>& words)
{
    std::string all;
    for (const std::string& word : words) all += word;
    if (all.size() > 6 && all.compare(0, 6, "scalar") == 0) all.erase(0, 6);  // CloudCompare's scalar fields
    return all;
}

// The name without units and systems next to it.
std::string unqualified(std::string_view name)
{
    std::vector<std::string> words = words_of(name);
    while (words.size() > 1 && has(qualifiers, words.back())) words.pop_back();
    while (words.size() > 1 && has(qualifiers, words.front())) words.erase(words.begin());
    return joined(words);
}

std::optional<AxisName> axis_of_bare(std::string_view bare)
{
    using Kind = AxisName::Kind;
    for (const PlainAxis& plain : plain_axes)
        if (bare == plain.name) return AxisName{plain.axis, Kind::plain, bare.size() == 1 ? 0u : 2u};
    if (has(east_names, bare)) return AxisName{0, Kind::projected, 4};
    if (has(north_names, bare)) return AxisName{1, Kind::projected, 4};
    if (has(longitude_names, bare)) return AxisName{0, Kind::geographic, 4};
    if (has(latitude_names, bare)) return AxisName{1, Kind::geographic, 4};
    if (has(height_names, bare)) return AxisName{2, Kind::plain, 4};
    if (has(weak_height_names, bare)) return AxisName{2, Kind::plain, 6};
    return std::nullopt;
}

std::string_view own_meaning_of_bare(std::string_view bare)
{
    for (const std::string_view meaning : meanings_apart)
        if (bare == bare_name(meaning)) return meaning;
    for (const KnownAttribute& known : known_attributes)
        if (bare == bare_name(known.name)) return known.name;
    return {};
}

}  // namespace

std::string bare_name(std::string_view name) { return joined(words_of(name)); }

std::string as_utf8(std::string_view text)
{
    std::string all;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t start = at;
        const std::uint32_t c = take_character(text, at);
        if (at - start == 1 && c >= 0x80) {
            all += static_cast<char>(0xC0 | c >> 6);
            all += static_cast<char>(0x80 | (c & 0x3F));
        } else {
            all += text.substr(start, at - start);
        }
    }
    return all;
}

std::optional<AxisName> axis_name(std::string_view name)
{
    if (const auto axis = axis_of_bare(bare_name(name))) return axis;
    auto axis = axis_of_bare(unqualified(name));
    if (axis) ++axis->rank;
    return axis;
}

std::string_view own_meaning(std::string_view name) { return own_meaning_of_bare(bare_name(name)); }

std::string_view other_meaning(std::string_view name)
{
    for (const std::string& bare : {bare_name(name), unqualified(name)}) {
        for (const Synonym& synonym : synonyms)
            if (bare == synonym.name) return synonym.meaning;
        if (const std::string_view own = own_meaning_of_bare(bare); !own.empty()) return own;
    }
    return {};
}

bool names_a_label(std::string_view name) { return has(label_names, bare_name(name)); }

}  // namespace pcm
