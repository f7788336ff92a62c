// What `pcmlab info` says about files and trees, and --ignore-crs of the commands that combine clouds.
#include "tests/cli/command.h"
#include "tests/io/crs_records.h"

namespace pcm::test {
namespace {

class InfoTest : public CommandTest {
protected:
    Json info(const std::string& arguments)
    {
        const Result asked = pcmlab("info --json " + arguments);
        EXPECT_EQ(asked.code, 0) << asked.err;
        return asked.code == 0 ? Json::parse(asked.out) : Json();
    }
    void write(const std::string& name, const LasFile& file) { write_file(folder_ / name, file.bytes()); }
    static LasFile las(int version, int format, std::size_t points, const std::vector<LasVlr>& vlrs)
    {
        std::mt19937_64 random(9);
        LasFile file = random_las(random, version, format, points);
        file.vlrs = vlrs;
        return file;
    }
};

TEST_F(InfoTest, HeaderSystemAndTimesOfAFileAndOfItsTree)
{
    LasFile file = las(2, 1, 500, {{"LASF_Projection", 34735, geo_projected(32632, 9001)}});
    file.encoding = 1;
    Bytes bytes;
    bytes.raw(file.bytes());
    for (std::uint32_t r = 0; r < 3; ++r) bytes.overwrite(111 + 4 * r, std::uint32_t{300 - 100 * r});
    for (std::size_t i = 0; i < 16; ++i) bytes.overwrite(8 + i, static_cast<std::uint8_t>(i + 1));
    write_file(folder_ / "a.las", bytes.data);
    ASSERT_EQ(pcmlab("build -q " + path("a.las")).code, 0);
    for (const char* name : {"a.las", "a.pct"}) {
        SCOPED_TRACE(name);
        const Json json = info(path(name));
        const Json& header = json["las"];
        EXPECT_EQ(header["version"], "1.2");
        EXPECT_EQ(header["point_format"], 1);
        EXPECT_EQ(header["generating_software"], "by hand");
        EXPECT_EQ(header["system_identifier"], "test");
        EXPECT_EQ(header["creation_day"], 59);
        EXPECT_EQ(header["creation_year"], 2020);
        EXPECT_EQ(header["file_source_id"], 7);
        EXPECT_EQ(header["project_id"], "04030201-0605-0807-090a-0b0c0d0e0f10");
        EXPECT_EQ(header["points_by_return"], Json({300, 200, 100}));
        EXPECT_EQ(header["record_bytes"], 28);
        EXPECT_EQ(header["vlrs"], 1);
        EXPECT_EQ(json["crs"]["epsg"], 32632);
        EXPECT_EQ(json["crs"]["unit"], "metre");
        EXPECT_EQ(json["crs"]["kind"], "projected");
        EXPECT_EQ(json["crs"]["vertical"], nullptr);
        EXPECT_EQ(json["gps_time"]["type"], "standard");
        EXPECT_EQ(json["gps_time"]["offset"], 1e9);
        const std::string text = pcmlab("info " + path(name)).out;
        for (const char* line : {"crs         EPSG:32632, metre; projected, from GeoTIFF keys",
                                 "gps time    standard GPS time minus 1000 million seconds (adjusted standard)",
                                 "returns     1: 300  2: 200  3: 100", "header      LAS 1.2, point format 1, 227 bytes",
                                 "\nscale       0.001  0.01  0.25\n"})
            EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
    }
}

TEST_F(InfoTest, OfLas15AndOfFilesWithoutASystem)
{
    LasFile file = las(5, 6, 10, {{"LASF_Projection", 2112, wkt_utm(32)}});
    file.encoding = 1 | 16 | 64;
    file.time_offset = 1500;
    file.least_time = 1;
    file.most_time = 2;
    write("a.las", file);
    const Json json = info(path("a.las"));
    EXPECT_EQ(json["las"]["version"], "1.5");
    EXPECT_EQ(json["las"]["gps_time_range"], Json({1.0, 2.0}));
    EXPECT_EQ(json["gps_time"]["offset"], 1.5e9);
    EXPECT_EQ(json["crs"]["name"], "WGS 84 / UTM zone 32N");

    write("b.las", las(2, 0, 10, {}));
    EXPECT_EQ(info(path("b.las"))["crs"], nullptr);
    EXPECT_EQ(info(path("b.las"))["gps_time"], nullptr);
    EXPECT_NE(pcmlab("info " + path("b.las")).out.find("crs         none stated"), std::string::npos);
}

TEST_F(InfoTest, StatisticsOfAFileAndOfItsTreeAreThoseOfThePoints)
{
    LasFile file = las(2, 1, 3000, {});
    for (std::size_t i = 0; i < file.records.size(); ++i) {
        auto& p = file.records[i];
        p.x = p.y = p.z = static_cast<std::int32_t>(i / 2);  // each position twice
        p.intensity = static_cast<std::uint16_t>(i);
        p.classification = i % 3 == 0 ? 2 : 6;
        p.return_number = 1 + i % 2;
        p.number_of_returns = 2;
    }
    write("a.las", file);
    ASSERT_EQ(pcmlab("build -q " + path("a.las")).code, 0);
    for (const char* name : {"a.las", "a.pct"}) {
        SCOPED_TRACE(name);
        const Json json = info("--statistics " + path(name));
        const Json& statistics = json["statistics"];
        EXPECT_EQ(statistics["points"], 3000);
        EXPECT_EQ(statistics["duplicates"]["points"], 1500);
        EXPECT_EQ(statistics["duplicates"]["exact"], true);
        const Json& intensity = statistics["attributes"]["intensity"][0];
        EXPECT_EQ(intensity["min"], 0);
        EXPECT_EQ(intensity["max"], 2999);
        EXPECT_EQ(intensity["mean"], 1499.5);
        EXPECT_EQ(statistics["position"]["z"]["max"], 12.5 + 0.25 * 1499);
        EXPECT_EQ(statistics["classes"], Json::parse(R"([{"class":2,"name":"ground","points":1000},
                                                         {"class":6,"name":"building","points":2000}])"));
        EXPECT_EQ(statistics["return_numbers"], Json({{"1", 1500}, {"2", 1500}}));
        EXPECT_EQ(statistics["numbers_of_returns"], Json({{"2", 3000}}));
        const std::string text = pcmlab("info --statistics " + path(name)).out;
        for (const char* words : {"1,500 points at the position of another", "ground", "1499.5"})
            EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
    }
    EXPECT_EQ(info("--statistics " + path("a.las"))["scanned"]["points"], 3000);
}

TEST_F(InfoTest, DifferentSystemsAreShownByInfoAndRefusedByTheOthers)
{
    write("a.las", las(2, 0, 10, {{"LASF_Projection", 34735, geo_projected(32632, 9001)}}));
    write("b.las", las(2, 0, 10, {{"LASF_Projection", 34735, geo_projected(2229, 9003)}}));
    const std::string both = path("a.las") + " " + path("b.las");
    const Json json = info(both);
    EXPECT_EQ(json["crs"]["epsg"], 32632);
    EXPECT_NE(json["notes"].dump().find("EPSG:2229"), std::string::npos) << json["notes"];

    ASSERT_EQ(pcmlab("build -q " + path("a.las") + " -o " + path("t.pct")).code, 0);
    for (const std::string& command :
         {"build -q " + both + " -o " + path("o.pct"), "convert -q " + both + " " + path("o.las"),
          "convert -q " + both + " " + path("o.xyz"), "append -q " + path("t.pct") + " " + path("b.las")}) {
        const Result refused = pcmlab(command);
        EXPECT_EQ(refused.code, 1) << command;
        for (const char* word : {"b.las", "EPSG:2229, US survey foot", "EPSG:32632, metre", "--ignore-crs"})
            EXPECT_NE(refused.err.find(word), std::string::npos) << command << "\n" << refused.err;
        const Result done = pcmlab(command + " --ignore-crs");
        EXPECT_EQ(done.code, 0) << command << "\n" << done.err;
        EXPECT_NE(done.out.find("the difference is ignored"), std::string::npos) << command << "\n" << done.out;
    }
    EXPECT_EQ(info(path("o.las"))["crs"]["epsg"], 32632);
    EXPECT_EQ(info(path("t.pct"))["crs"]["epsg"], 32632);
}

// Through a tree and back: every record, byte for byte.
TEST_F(InfoTest, ATreeKeepsAllRecords)
{
    LasFile file = las(4, 6, 200, {{"LASF_Projection", 2112, wkt_utm(32)}, {"someone", 1, "one"}, {"someone", 2, ""}});
    file.evlrs = {{"far", 9, std::string(70000, 'e')}, {"LASF_Spec", 3, "text area"}};
    file.encoding = 16;
    write("a.las", file);
    ASSERT_EQ(pcmlab("build -q " + path("a.las")).code, 0);
    ASSERT_EQ(pcmlab("convert -q " + path("a.pct") + " " + path("b.las")).code, 0);
    const auto records_of = [&](const char* name) {
        std::vector<Metadata> found = open_reader(folder_ / name)->info().metadata;
        found.erase(found.begin());  // the header
        return found;
    };
    EXPECT_EQ(records_of("a.las").size(), 5u);
    EXPECT_EQ(records_of("a.las"), records_of("b.las"));
}

}  // namespace
}  // namespace pcm::test
