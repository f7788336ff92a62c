// Coordinate systems, decoded from GeoTIFF keys, well-known text and comments, and compared.
#include "pcm/io/crs/coordinate_system.h"

#include "pcm/io/crs/wkt.h"
#include "tests/io/crs_records.h"

namespace pcm::test {
namespace {

constexpr const char* keys = "las.vlr/LASF_Projection/34735";
constexpr const char* doubles = "las.vlr/LASF_Projection/34736/GeoTiff doubles";
constexpr const char* ascii = "las.vlr/LASF_Projection/34737/GeoTiff text";
constexpr const char* wkt_key = "las.evlr/LASF_Projection/2112/WKT";

CoordinateSystem system_of(const std::vector<Metadata>& metadata)
{
    const auto system = coordinate_system_of(metadata);
    EXPECT_TRUE(system);
    return system.value_or(CoordinateSystem());
}

CoordinateSystem of_wkt(const std::string& text) { return system_of({block(wkt_key, text)}); }

TEST(CoordinateSystem, GeoTiffKeysOfAProjectedSystem)
{
    const std::string text = "UTM Zone 15, Northern Hemisphere|NAD83|NAVD88|";
    const CoordinateSystem system = system_of({block("las.header", "short"),
                                               block(keys, geo_directory({{1024, 0, 1, 1},
                                                                          {1026, 34737, 33, 0},
                                                                          {2049, 34737, 6, 33},
                                                                          {3072, 0, 1, 26915},
                                                                          {3076, 0, 1, 9001},
                                                                          {4096, 0, 1, 5103},
                                                                          {4097, 34737, 7, 39},
                                                                          {4099, 0, 1, 9003}})),
                                               block(ascii, text)});
    EXPECT_EQ(system.kind, CrsKind::projected);
    EXPECT_EQ(system.name, "UTM Zone 15, Northern Hemisphere");
    EXPECT_EQ(system.horizontal.authority, "EPSG");
    EXPECT_EQ(system.horizontal.code, 26915u);
    EXPECT_EQ(system.horizontal.unit.name, "metre");
    EXPECT_EQ(system.vertical.code, 5703u) << "5103 is GeoTIFF's number of NAVD88";
    EXPECT_EQ(system.vertical.name, "NAVD88");
    EXPECT_EQ(system.vertical.unit.name, "US survey foot");
    EXPECT_EQ(system.source, "GeoTIFF keys");
    EXPECT_EQ(describe(system),
              "UTM Zone 15, Northern Hemisphere (EPSG:26915), metre; heights NAVD88 (EPSG:5703), US "
              "survey foot");
}

TEST(CoordinateSystem, GeoTiffKeysOfOtherKinds)
{
    const CoordinateSystem degrees =
        system_of({block(keys, geo_directory({{1024, 0, 1, 2}, {2048, 0, 1, 4269}, {2054, 0, 1, 9102}}))});
    EXPECT_EQ(degrees.kind, CrsKind::geographic);
    EXPECT_EQ(degrees.horizontal.code, 4269u);
    EXPECT_EQ(degrees.horizontal.unit.name, "degree");

    EXPECT_EQ(system_of({block(keys, geo_directory({{1024, 0, 1, 3}, {2048, 0, 1, 4978}}))}).kind, CrsKind::geocentric);

    // Defined by the user, with a unit of its own size.
    Bytes sizes;
    sizes.put(1.0).put(0.3048);
    const CoordinateSystem own = system_of({block(keys, geo_directory({{1024, 0, 1, 1},
                                                                       {3072, 0, 1, 32767},
                                                                       {3073, 34737, 19, 0},
                                                                       {3076, 0, 1, 32767},
                                                                       {3077, 34736, 1, 1}})),
                                            block(doubles, sizes.data), block(ascii, "PCS Name = My plan|")});
    EXPECT_EQ(own.horizontal.code, 0u);
    EXPECT_EQ(own.name, "My plan");
    EXPECT_EQ(own.horizontal.unit.name, "foot");

    EXPECT_FALSE(coordinate_system_of({block(keys, geo_directory({{1025, 0, 1, 1}}))}));
    EXPECT_FALSE(coordinate_system_of({block(keys, "")}));
    EXPECT_FALSE(coordinate_system_of({}));
}

TEST(CoordinateSystem, WktOfVersionOne)
{
    const CoordinateSystem utm = of_wkt(wkt_utm(32) + std::string(2, '\0'));
    EXPECT_EQ(utm.kind, CrsKind::projected);
    EXPECT_EQ(utm.name, "WGS 84 / UTM zone 32N");
    EXPECT_EQ(utm.horizontal.code, 32632u) << "not that of the geographic system within";
    EXPECT_EQ(utm.horizontal.unit.name, "metre") << "not the degree of the geographic system within";

    const CoordinateSystem both =
        of_wkt("COMPD_CS[\"UTM + heights\",\n  " + wkt_utm(32) +
               ",\n VERT_CS[\"DHHN2016 \"\"new\"\"\",VERT_DATUM[\"d\",2005],UNIT[\"ft\",0.3048],AXIS[\"H\",UP],"
               "AUTHORITY[\"EPSG\",\"7837\"]]]");
    EXPECT_EQ(both.name, "UTM + heights");
    EXPECT_EQ(both.horizontal.code, 32632u);
    EXPECT_EQ(both.vertical.code, 7837u);
    EXPECT_EQ(both.vertical.name, "DHHN2016 \"new\"");
    EXPECT_EQ(both.vertical.unit.name, "foot");

    const CoordinateSystem local = of_wkt("LOCAL_CS(\"site\", UNIT(\"metre\", 1))");
    EXPECT_EQ(local.kind, CrsKind::local);
    EXPECT_EQ(local.horizontal.unit.name, "metre");
    EXPECT_EQ(of_wkt("GEOCCS[\"WGS 84\",UNIT[\"metre\",1],AUTHORITY[\"EPSG\",\"4978\"]]").kind, CrsKind::geocentric);
    EXPECT_EQ(of_wkt("PROJCS[\"a\",UNIT[\"pace\",0.75]]").horizontal.unit.name, "pace");
    const CoordinateSystem esri = of_wkt("PROJCS[\"a\",AUTHORITY[\"esri\",\"102008\"]]");
    EXPECT_EQ(esri.horizontal.authority, "ESRI");
    EXPECT_EQ(esri.horizontal.code, 102008u);
}

TEST(CoordinateSystem, WktOfVersionTwo)
{
    const std::string projected =
        "PROJCRS[\"ETRS89 / UTM zone 32N\",BASEGEOGCRS[\"ETRS89\",DATUM[\"d\",ELLIPSOID[\"GRS "
        "1980\",6378137,298.257222101,LENGTHUNIT[\"metre\",1]]],ID[\"EPSG\",4258]],CONVERSION[\"UTM zone "
        "32N\",METHOD[\"Transverse "
        "Mercator\",ID[\"EPSG\",9807]]],CS[Cartesian,2],AXIS[\"(E)\",east,ORDER[1],LENGTHUNIT["
        "\"US survey foot\",0.304800609601219]],AXIS[\"(N)\",north,ORDER[2],LENGTHUNIT[\"US survey "
        "foot\",0.304800609601219]],USAGE[SCOPE[\"any, [all]\"],AREA[\"a\"]],ID[\"EPSG\",25832]]";
    const CoordinateSystem utm = of_wkt(projected);
    EXPECT_EQ(utm.kind, CrsKind::projected);
    EXPECT_EQ(utm.horizontal.code, 25832u);
    EXPECT_EQ(utm.horizontal.unit.name, "US survey foot");

    const CoordinateSystem both = of_wkt("COMPOUNDCRS[\"both\"," + projected +
                                         ",VERTCRS[\"NN\",VDATUM[\"v\"],CS[vertical,1],AXIS[\"H\",up],LENGTHUNIT["
                                         "\"metre\",1.0],ID[\"EPSG\",5941]]]");
    EXPECT_EQ(both.horizontal.code, 25832u);
    EXPECT_EQ(both.vertical.code, 5941u);
    EXPECT_EQ(both.vertical.unit.name, "metre");

    const CoordinateSystem bound = of_wkt("BOUNDCRS[SOURCECRS[" + projected + "],TARGETCRS[GEOGCRS[\"WGS 84\"]]]");
    EXPECT_EQ(bound.horizontal.code, 25832u);

    const CoordinateSystem centric = of_wkt(
        "GEODCRS[\"WGS 84\",DATUM[\"d\"],CS[Cartesian,3],AXIS[\"(X)\",geocentricX],LENGTHUNIT[\"metre\",1],ID[\"EPSG\","
        "4978]]");
    EXPECT_EQ(centric.kind, CrsKind::geocentric);
    const CoordinateSystem three = of_wkt(
        "GEOGCRS[\"WGS "
        "84\",DATUM[\"d\"],CS[ellipsoidal,3],AXIS[\"lat\",north,ANGLEUNIT[\"degree\",0.0174532925199433]],"
        "AXIS[\"lon\",east,ANGLEUNIT[\"degree\",0.0174532925199433]],AXIS[\"h\",up,LENGTHUNIT[\"foot\",0.3048]]]");
    EXPECT_EQ(three.kind, CrsKind::geographic);
    EXPECT_EQ(three.horizontal.unit.name, "degree");
    EXPECT_EQ(three.vertical.unit.name, "foot");
}

TEST(CoordinateSystem, AVerticalSystemAloneHasItsName)
{
    const auto heights = decode_wkt(R"(VERT_CS["NAVD88 height",VERT_DATUM["NAVD88",2005],UNIT["metre",1]])");
    ASSERT_TRUE(heights);
    EXPECT_EQ(heights->name, "NAVD88 height");
    EXPECT_EQ(heights->vertical.unit.name, "metre");
}

TEST(CoordinateSystem, TextThatIsNoWktIsRefused)
{
    const std::string whole = wkt_utm(32);
    for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_FALSE(decode_wkt(whole.substr(0, size))) << size;
    std::string deep;
    for (int i = 0; i < 100000; ++i) deep += "A[";
    for (const std::string& text : {std::string("["), std::string("PROJCS"), std::string("PROJCS[]"),
                                    std::string("DATUM[\"d\"]"), whole + "x", whole + "]", deep})
        EXPECT_FALSE(decode_wkt(text)) << text.substr(0, 40);
}

TEST(CoordinateSystem, TheHeadersBitChoosesBetweenKeysAndWkt)
{
    const auto header = [](bool wkt) {
        LasFile file;
        file.version = 4;
        file.format = 6;
        file.encoding = wkt ? 16 : 0;
        return block("las.header", file.bytes().substr(0, 375));
    };
    for (const bool wkt : {false, true}) {
        // They contradict each other.
        const CoordinateSystem system =
            system_of({header(wkt), block(keys, geo_projected(32631)), block(wkt_key, wkt_utm(32))});
        EXPECT_EQ(system.horizontal.code, wkt ? 32632u : 32631u);
        // They complete each other.
        const CoordinateSystem one =
            system_of({header(wkt), block(keys, geo_projected(32632)), block(wkt_key, wkt_utm(32))});
        EXPECT_EQ(one.horizontal.code, 32632u);
        EXPECT_EQ(one.horizontal.unit.name, "metre");
        EXPECT_EQ(one.name, "WGS 84 / UTM zone 32N");
    }
}

TEST(CoordinateSystem, OtherSources)
{
    EXPECT_EQ(system_of({block("e57.coordinateMetadata", wkt_utm(33))}).horizontal.code, 32633u);
    EXPECT_EQ(system_of({block("e57.coordinateMetadata", "EPSG:25832")}).horizontal.code, 25832u);
    EXPECT_EQ(system_of({block("liblas", ""), block("las.vlr/liblas/2112/OGR", wkt_utm(33))}).horizontal.code, 32633u);
    const CoordinateSystem comment =
        system_of({block("crs", "epsg:25832+7837 ETRS89 / UTM zone 32N + DHHN2016 height")});
    EXPECT_EQ(comment.horizontal.authority, "EPSG");
    EXPECT_EQ(comment.horizontal.code, 25832u);
    EXPECT_EQ(comment.vertical.code, 7837u);
    EXPECT_EQ(comment.name, "ETRS89 / UTM zone 32N + DHHN2016 height");
    EXPECT_EQ(system_of({block("crs", "Soldner Berlin")}).name, "Soldner Berlin");
    EXPECT_FALSE(coordinate_system_of({block("crs", " ")}));
}

TEST(CoordinateSystem, CommentsAreWrittenAndRead)
{
    const std::vector<Metadata> metadata = {block(keys, geo_projected(32632)), block(wkt_key, wkt_utm(32))};
    const std::string line = crs_comment_line(metadata);
    EXPECT_EQ(line, "crs: EPSG:32632 WGS 84 / UTM zone 32N");
    for (const std::string& mark : {"# ", "//", "% ", "  ## "}) {
        const auto found = crs_block_of_lines({"# x y z", mark + line, "# crs: later"});
        ASSERT_TRUE(found) << mark;
        EXPECT_EQ(system_of({*found}).horizontal.code, 32632u);
    }
    EXPECT_FALSE(crs_block_of_lines({"x y z crs: a", "", "# crs", "# crs:", "#", "crs: 5"}));
    EXPECT_EQ(crs_comment_line({}), "");
}

TEST(CoordinateSystem, Comparison)
{
    const auto of_keys = [](const std::string& payload) { return system_of({block(keys, payload)}); };
    const auto expect = [](CrsRelation relation, const CoordinateSystem& a, const CoordinateSystem& b) {
        EXPECT_EQ(compare(a, b), relation) << describe(a) << " and " << describe(b);
        EXPECT_EQ(compare(b, a), relation) << describe(b) << " and " << describe(a);
    };
    const CoordinateSystem utm = of_wkt(wkt_utm(32));
    expect(CrsRelation::same, utm, utm);
    expect(CrsRelation::same, utm, of_keys(geo_projected(32632)));
    expect(CrsRelation::same, utm, of_keys(geo_projected(32632, 9001)));
    expect(CrsRelation::different, utm, of_keys(geo_projected(32632, 9002)));
    expect(CrsRelation::different, utm, of_keys(geo_projected(32633)));
    expect(CrsRelation::different, of_keys(geo_projected(2229, 9002)), of_keys(geo_projected(2229, 9003)));
    expect(CrsRelation::different, utm, of_wkt(wkt_utm(33)));
    expect(CrsRelation::different, utm, of_keys(geo_directory({{1024, 0, 1, 2}, {2048, 0, 1, 4326}})));

    // The same text in another layout.
    const std::string own = "PROJCS[\"our plan\",UNIT[\"metre\",1]]";
    expect(CrsRelation::same, of_wkt(own), of_wkt("projcs (\"our plan\" ,\n UNIT[\"metre\", 1] )"));
    expect(CrsRelation::different, of_wkt(own), of_wkt("PROJCS[\"their plan\",UNIT[\"metre\",1]]"));
    expect(CrsRelation::different, of_wkt(own), of_wkt("PROJCS[\"our plan\",UNIT[\"foot\",0.3048]]"));

    // ESRI's names, without codes.
    const CoordinateSystem esri = of_wkt("PROJCS[\"WGS_1984_UTM_Zone_32N\",UNIT[\"Meter\",1.0]]");
    expect(CrsRelation::same, utm, esri);
    expect(CrsRelation::unclear, of_keys(geo_projected(32632)), esri);
    expect(CrsRelation::unclear, of_wkt(wkt_utm(33)), esri);

    // Heights: both must state them to differ.
    const auto heights = [&](const std::string& vertical) {
        return of_wkt("COMPD_CS[\"c\"," + wkt_utm(32) + vertical + "]");
    };
    const std::string metres = ",VERT_CS[\"a\",UNIT[\"metre\",1],AUTHORITY[\"EPSG\",\"7837\"]]";
    expect(CrsRelation::unclear, utm, heights(metres));
    expect(CrsRelation::same, heights(metres), heights(metres + " "));
    expect(CrsRelation::different, heights(metres), heights(",VERT_CS[\"a\",UNIT[\"foot\",0.3048]]"));
    expect(CrsRelation::different, heights(metres),
           heights(",VERT_CS[\"b\",UNIT[\"m\",1],AUTHORITY[\"EPSG\",\"5783\"]]"));
    const auto unit_only = [&](int unit) {
        return of_keys(geo_directory({{1024, 0, 1, 1}, {3072, 0, 1, 32632}, {4099, 0, 1, unit}}));
    };
    expect(CrsRelation::same, unit_only(9001), unit_only(9001));
    expect(CrsRelation::different, unit_only(9001), unit_only(9002));
}

// A record of a file may be longer than its text, which ends at the first zero byte.
TEST(CoordinateSystem, TextsAreComparedUpToTheFirstZeroByte)
{
    const std::string one = "geogcs (\"a\1 B\" , 1.5\t)", kept = "GEOGCS[\"a\1 B\",1.5]";
    EXPECT_EQ(compact_wkt(one), kept);
    EXPECT_EQ(compact_wkt(one + '\0' + " rest"), kept);
    EXPECT_EQ(compact_wkt(std::string(1, '\0') + one), "");
}

TEST(CoordinateSystem, OfSamples)
{
    const auto expect = [](const std::string& name, unsigned code, unsigned vertical, const std::string& unit) {
        const auto path = sample("las/" + name);
        if (!std::filesystem::exists(path)) return;
        const auto system = coordinate_system_of(open_reader(path)->info().metadata);
        ASSERT_TRUE(system) << name;
        EXPECT_EQ(system->horizontal.code, code) << name;
        EXPECT_EQ(system->vertical.code, vertical) << name;
        EXPECT_EQ(system->horizontal.unit.name, unit) << name;
    };
    PCM_REQUIRE_SAMPLE("las/1.2_0.las");
    expect("1.2_0.las", 26915, 0, "metre");
    expect("certainty3d-color-utm-feet-navd88.las", 2229, 0, "");
    expect("no-points.las", 4269, 0, "degree");
}

}  // namespace
}  // namespace pcm::test
