// The names of columns in the languages of the field.
#include "pcm/io/text/text_names.h"
#include "pcm/io/text/text_header.h"

#include "tests/io/text/read_text.h"

namespace pcm::test {
namespace {

// The columns that a header means: "y x z intensity"; "?" when it does not name x, y and z.
std::string meaning(const std::string& line, char separator = ',')
{
    const auto header = read_header(line, {separator, '.'});
    if (!header) return "?";
    std::string text;
    for (const TextColumn& column : header->columns) text += (text.empty() ? "" : " ") + column.name;
    return text;
}

TEST(TextNames, AxesInTheLanguagesOfTheField)
{
    const char* const north_east[] = {
        "N,E,Z",
        "Northing,Easting,Elevation",
        "NORTHING (m),EASTING (m),HEIGHT (m)",
        "n_m,e_m,h_m",
        "North,East,Alt",
        "Hochwert,Rechtswert,Höhe",
        "Nordwert,Ostwert,Hoehe [m]",
        "Hoch,Rechts,H",
        "HW,RW,Z",
        "Nord,Ost,Höhe",
        "Nord,Est,Altitude",
        "Nord,Est,Quota",
        "Norte,Este,Cota",
        "Norte,Este,Altura",
        "norte,leste,elevação",
        "Noord,Oost,Hoogte",
        "Północ,Wschód,Wysokość",
        "Север,Восток,Высота",
        "СЕВЕР,ВОСТОК,ОТМЕТКА",
        "Lat,Lon,Alt",
        "Latitude,Longitude,Elevation",
        "Breite,Länge,Höhe",
        "широта,долгота,высота",
        "Y,X,Z",
        "Y_UTM,X_UTM,Z",
        "Y-coord,X-coord,Z-coord",
        "northing_utm,easting_utm,elev_ft",
        "UTM Northing,UTM Easting,Z",
        "北坐标,东坐标,高程",
        "H\xF6he,Rechtswert,Hochwert",       // Latin-1
        "Ho\xCC\x88he,Rechtswert,Hochwert",  // ö of two characters
    };
    for (const std::string line : north_east)
        EXPECT_EQ(meaning(line), line[0] == 'H' && line[1] != 'o' && line[1] != 'W' ? "z x y"
                                 : line.find("\xCC\x88") != std::string::npos       ? "z x y"
                                                                                    : "y x z")
            << line;
    EXPECT_EQ(meaning("P,N,E,Z,D"), "P y x z D");
    EXPECT_EQ(meaning("P,E,N,Z,D"), "P x y z D");
    EXPECT_EQ(meaning("Pt;Est;Nord;Quota;Codice", ';'), "Pt x y z Codice");
    EXPECT_EQ(meaning("// Rechtswert Hochwert Höhe", ' '), "x y z");
    EXPECT_EQ(meaning("Northing [m] Easting (m) Height [m]", ' '), "y x z");
}

TEST(TextNames, TheAxesOfOneKindAreTaken)
{
    // x and y before east and north before longitude and latitude, never one of each.
    EXPECT_EQ(meaning("Lat,Lon,X,Y,Z"), "Lat Lon x y z");
    EXPECT_EQ(meaning("Lat,Lon,N,E,H"), "Lat Lon y x z");
    EXPECT_EQ(meaning("N,E,Z,X,Y"), "N E z x y");
    EXPECT_EQ(meaning("X,North,Z"), "?");
    EXPECT_EQ(meaning("Lon,North,Z"), "?");
    EXPECT_EQ(meaning("X_utm,Y_utm,Z,X,Y"), "X_utm Y_utm z x y");
    EXPECT_EQ(meaning("E,N,Height,Z"), "x y Height z");
    EXPECT_EQ(meaning("E,N,H,Elevation"), "x y H z");
    // What means several things means nothing: R and H are right and high in one country, red and height in another.
    EXPECT_EQ(meaning("R,H,Z"), "?");
    EXPECT_EQ(meaning("A,B,C"), "?");
    EXPECT_TRUE(read_header("Lat,Lon,Alt", {',', '.'})->geographic);
    EXPECT_FALSE(read_header("N,E,Alt", {',', '.'})->geographic);
    EXPECT_EQ(read_header("N,E,Alt,Rot,Grün,Blau", {',', '.'})->renamed(), "N→y, E→x, Alt→z, Rot→r, Grün→g, Blau→b");
    EXPECT_EQ(read_header("X (m),Y,Z,Intensity", {',', '.'})->renamed(), "");
    const auto notes = notes_after("Lat,Lon,Alt\n48,9,300\n", "a.csv");
    EXPECT_TRUE(any_mentions(notes, "x and y are longitude and latitude"));
}

TEST(TextNames, OtherColumns)
{
    EXPECT_EQ(meaning("X,Y,Z,Rot,Grün,Blau,Intensität,Klasse"), "x y z r g b intensity classification");
    EXPECT_EQ(meaning("X,Y,Z,Rouge,Vert,Bleu,Intensité,Classe"), "x y z r g b intensity classification");
    EXPECT_EQ(meaning("X,Y,Z,Rojo,Verde,Azul,Intensidad,Clase"), "x y z r g b intensity classification");
    EXPECT_EQ(meaning("X,Y,Z,Rosso,Verde,Blu,Intensità"), "x y z r g b intensity");
    EXPECT_EQ(meaning("X,Y,Z,R,G,B,Reflectance,Return,Time,GPS Time [s]"),
              "x y z r g b intensity return_number Time gps_time");
    EXPECT_EQ(meaning("X,Y,Z,Reflectance,Intensity"), "x y z Reflectance intensity");
    // A colour is three columns.
    EXPECT_EQ(meaning("X,Y,Z,Vert"), "x y z Vert");
    EXPECT_EQ(meaning("X,Y,Z,G"), "x y z g");
    EXPECT_EQ(meaning("x,y,z,2019,2020"), "x y z 2019 2020");
    EXPECT_EQ(meaning("# x y z 1 2 3", ' '), "?");
    EXPECT_EQ(bare_name("GPS Time [s]"), "gpstime");
    EXPECT_EQ(bare_name("scalar_Intensity"), "intensity");
    EXPECT_EQ(bare_name("ÉLÉVATION"), "elevation");
    EXPECT_EQ(bare_name("Ł"), "l");
    EXPECT_EQ(bare_name("ВЫСОТА"), "высота");
    EXPECT_EQ(bare_name("\xE2\x82"), "a");  // not UTF-8: Latin-1
    EXPECT_EQ(as_utf8("H\xF6he"), "Höhe");
    EXPECT_EQ(as_utf8("Höhe"), "Höhe");
}

// Easting before northing and the other way round is the same cloud, never its mirror image.
TEST(TextNames, CloudsAreNotMirrored)
{
    const Whole a = read_text("N;E;Z\n10;20;3\n11;21;4\n", "a.csv"),
                b = read_text("E;N;Z\n20;10;3\n21;11;4\n", "b.csv");
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(a.position(i), b.position(i));
    EXPECT_EQ(a.position(0), (Vec3d{20, 10, 3}));
}

}  // namespace
}  // namespace pcm::test
