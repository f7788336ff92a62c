#include "pcm/io/las/las_reader.h"

#include "tests/io/las_file.h"

#include <cmath>
#include <limits>

namespace pcm::test {
namespace {

void expect_record(const Whole& whole, std::size_t i, const LasRecord& p, int format)
{
    const auto& grid = whole.points.grid_xyz;
    ASSERT_EQ(grid[0][i], p.x);
    ASSERT_EQ(grid[1][i], p.y);
    ASSERT_EQ(grid[2][i], p.z);
    ASSERT_EQ(whole.raw<std::uint16_t>("intensity", i), p.intensity);
    const auto bits = [&](const char* name) { return unsigned{whole.raw<std::uint8_t>(name, i)}; };
    ASSERT_EQ(bits("return_number"), p.return_number);
    ASSERT_EQ(bits("number_of_returns"), p.number_of_returns);
    ASSERT_EQ(bits("scan_direction_flag"), p.scan_direction);
    ASSERT_EQ(bits("edge_of_flight_line"), p.edge);
    ASSERT_EQ(bits("classification"), p.classification);
    ASSERT_EQ(bits("synthetic"), p.synthetic);
    ASSERT_EQ(bits("key_point"), p.key_point);
    ASSERT_EQ(bits("withheld"), p.withheld);
    ASSERT_EQ(bits("user_data"), p.user_data);
    ASSERT_EQ(whole.raw<std::uint16_t>("point_source_id", i), p.source_id);
    if (format >= 6) {
        ASSERT_EQ(bits("overlap"), p.overlap);
        ASSERT_EQ(bits("scanner_channel"), p.channel);
        ASSERT_EQ(whole.raw<std::int16_t>("scan_angle", i), p.angle);
    } else {
        ASSERT_EQ(whole.raw<std::int8_t>("scan_angle_rank", i), p.angle_rank);
    }
    if (has_gps_time(format)) {
        ASSERT_EQ(whole.raw<double>("gps_time", i), p.gps_time);
    }
    for (std::uint32_t c = 0; has_rgb(format) && c < 3; ++c) ASSERT_EQ(whole.raw<std::uint16_t>("rgb", i, c), p.rgb[c]);
    if (has_nir(format)) {
        ASSERT_EQ(whole.raw<std::uint16_t>("nir", i), p.nir);
    }
    if (has_wave(format)) {
        ASSERT_EQ(whole.raw<std::uint8_t>("wave_packet_descriptor", i), p.wave_descriptor);
        ASSERT_EQ(whole.raw<std::uint64_t>("wave_packet_offset", i), p.wave_offset);
        ASSERT_EQ(whole.raw<std::uint32_t>("wave_packet_size", i), p.wave_size);
        ASSERT_EQ(whole.raw<float>("wave_return_location", i), p.wave_location);
        for (std::uint32_t c = 0; c < 3; ++c) ASSERT_EQ(whole.raw<float>("wave_direction", i, c), p.wave_direction[c]);
    }
    for (std::uint32_t b = 0; b < p.extra.size(); ++b)
        ASSERT_EQ(whole.raw<std::uint8_t>("extra_bytes", i, b), static_cast<std::uint8_t>(p.extra[b]));
}

class LasFormats : public testing::TestWithParam<std::tuple<int, int>> {};

TEST_P(LasFormats, EveryFieldComesBack)
{
    const auto [version, format] = GetParam();
    std::mt19937_64 random(static_cast<std::uint64_t>(version * 100 + format));
    TemporaryFolder folder;
    for (const std::size_t extra : {0, 5}) {
        LasFile file = random_las(random, version, format, 1500, extra);
        file.vlrs = {
            {"LASF_Projection", 34735, std::string("\0\1\2\3", 4)}, {"LASF_Projection", 2112, "WKT"}, {"empty", 0, ""}};
        if (version >= 4) file.evlrs = {{"far", 9, std::string(70000, 'e')}};
        const auto path = write_file(folder / "a.las", file.bytes());

        const Whole whole = read_whole(path, 700);
        ASSERT_EQ(whole.info.format, "LAS 1." + std::to_string(version) + ", point format " + std::to_string(format));
        ASSERT_EQ(whole.info.points, 1500u);
        ASSERT_EQ(whole.info.position_type, ScalarType::i32);
        EXPECT_EQ(whole.info.grid->scale, (Vec3d{0.001, 0.01, 0.25}));
        EXPECT_EQ(whole.info.grid->offset, (Vec3d{500000, -4800000, 12.5}));
        ASSERT_TRUE(whole.info.promised_box);
        EXPECT_EQ(whole.info.promised_box->min, (Vec3d{-10, -11, -12}));
        EXPECT_EQ(whole.info.promised_box->max, (Vec3d{10, 11, 12}));
        // Every byte of a record is part of exactly one attribute or bit field of one.
        std::size_t attributes = format <= 5 ? 12u : 15u;
        attributes += (format <= 5 && has_gps_time(format)) + has_rgb(format) + has_nir(format) + 5 * has_wave(format);
        EXPECT_EQ(whole.info.schema.size(), attributes + (extra ? 1 : 0));
        for (std::size_t i = 0; i < file.records.size(); ++i) expect_record(whole, i, file.records[i], format);

        std::vector<Metadata> metadata{{"las.header", {}}};
        for (const LasVlr& vlr : file.vlrs)
            metadata.push_back({"las.vlr/" + vlr.user_id + "/" + std::to_string(vlr.id) + "/described", {}});
        for (const LasVlr& vlr : file.evlrs)
            metadata.push_back({"las.evlr/" + vlr.user_id + "/" + std::to_string(vlr.id) + "/described", {}});
        ASSERT_EQ(whole.info.metadata.size(), metadata.size());
        std::vector<LasVlr> all{{"", 0, file.bytes().substr(0, file.header_size())}};
        all.insert(all.end(), file.vlrs.begin(), file.vlrs.end());
        all.insert(all.end(), file.evlrs.begin(), file.evlrs.end());
        for (std::size_t i = 0; i < metadata.size(); ++i) {
            EXPECT_EQ(whole.info.metadata[i].key, metadata[i].key);
            const std::vector<std::byte>& value = whole.info.metadata[i].value;
            EXPECT_EQ(std::string(reinterpret_cast<const char*>(value.data()), value.size()), all[i].payload);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, LasFormats, testing::Combine(testing::Range(0, 5), testing::Range(0, 11)),
                         [](const auto& p) {
                             return "LAS1_" + std::to_string(std::get<0>(p.param)) + "_format" +
                                    std::to_string(std::get<1>(p.param));
                         });

TEST(LasReader, ScanAngleOfWideFormatsIsInDegrees)
{
    std::mt19937_64 random(1);
    TemporaryFolder folder;
    const auto reader = open_reader(write_file(folder / "a.las", random_las(random, 4, 6, 1).bytes()));
    EXPECT_EQ(reader->info().schema[*reader->info().schema.find("scan_angle")].scale, 0.006);
}

TEST(LasReader, SeekGivesTheSamePointsAsReadingOn)
{
    std::mt19937_64 random(2);
    TemporaryFolder folder;
    const auto path = write_file(folder / "a.las", random_las(random, 2, 3, 1000).bytes());
    const Whole whole = read_whole(path);
    const auto reader = open_reader(path);
    ASSERT_TRUE(reader->seekable());
    PointBatch batch;
    for (int i = 0; i < 200; ++i) {
        const std::size_t start = random() % 1001, count = 1 + random() % 300;
        reader->seek(start);
        ASSERT_EQ(reader->read(batch, count), start < 1000);
        ASSERT_EQ(batch.size, std::min(count, 1000 - start));
        for (std::size_t k = 0; k < batch.size; ++k) {
            ASSERT_EQ(batch.grid_xyz[2][k], whole.points.grid_xyz[2][start + k]);
            ASSERT_EQ(batch.attributes.back().value(k, 1), whole.points.attributes.back().value(start + k, 1));
        }
    }
    EXPECT_EQ(error_of([&] { reader->seek(1001); }).code(), ErrorCode::invalid_argument);
}

TEST(LasReader, BatchesOfAnySizeGiveTheSame)
{
    std::mt19937_64 random(3);
    TemporaryFolder folder;
    const auto path = write_file(folder / "a.las", random_las(random, 4, 10, 3000, 1000).bytes());
    const Whole whole = read_whole(path);
    for (const std::size_t batch : {std::size_t{1}, std::size_t{7}, std::size_t{1024}, std::size_t{2999},
                                    std::size_t{3000}, std::size_t{1} << 40}) {
        const Whole other = read_whole(path, batch);
        ASSERT_EQ(other.points.grid_xyz, whole.points.grid_xyz);
        for (std::size_t a = 0; a < whole.points.attributes.size(); ++a)
            ASSERT_EQ(std::memcmp(other.points.attributes[a].data(), whole.points.attributes[a].data(),
                                  whole.points.attributes[a].bytes()),
                      0);
    }
}

// A caller's batch may come from another reader: none of its content may remain.
TEST(LasReader, TakesBatchesOfAnotherShape)
{
    std::mt19937_64 random(4);
    TemporaryFolder folder;
    const LasFile first = random_las(random, 2, 3, 50), second = random_las(random, 2, 0, 60);
    const auto one = open_reader(write_file(folder / "1.las", first.bytes()));
    const auto other = open_reader(write_file(folder / "2.las", second.bytes()));
    PointBatch batch;
    ASSERT_TRUE(one->read(batch, 100));
    ASSERT_TRUE(other->read(batch, 100));
    ASSERT_EQ(batch.attributes.size(), other->info().schema.size());
    for (std::size_t i = 0; i < 60; ++i) ASSERT_EQ(batch.grid_xyz[0][i], second.records[i].x);
    ASSERT_TRUE(batch.attributes.back().as<std::uint16_t>()[59] == second.records[59].source_id);
}

TEST(LasReader, EveryTruncationIsRefusedAtOpen)
{
    std::mt19937_64 random(5);
    TemporaryFolder folder;
    for (const auto& [version, format] : {std::pair{2, 2}, std::pair{4, 7}}) {
        LasFile file = random_las(random, version, format, 3);
        file.vlrs = {{"LASF_Projection", 34735, "abcdefgh"}};
        const std::string bytes = file.bytes();
        for (std::size_t length = 0; length < bytes.size(); ++length) {
            const auto path = write_file(folder / "a.las", bytes.substr(0, length));
            const Error error = error_of([&] { open_reader(path); });
            ASSERT_TRUE(mentions(error.what(), path.string())) << error.what();
            ASSERT_EQ(error.code(), length < 4 ? ErrorCode::bad_format : ErrorCode::truncated)
                << length << error.what();
        }
        EXPECT_EQ(read_whole(write_file(folder / "a.las", bytes)).points.size, 3u);
    }
}

TEST(LasReader, TruncationNamesWhatWasPromisedAndWhatIsThere)
{
    std::mt19937_64 random(6);
    TemporaryFolder folder;
    const std::string bytes = random_las(random, 2, 0, 10).bytes();
    const Error error = error_of([&] { open_reader(write_file(folder / "a.las", bytes.substr(0, 227 + 47))); });
    EXPECT_EQ(error.code(), ErrorCode::truncated);
    for (const char* part : {"10 points", "20 bytes", "byte 227", "byte 274", "holds 2"})
        EXPECT_TRUE(mentions(error.what(), part)) << error.what();
}

// A file that shrinks while it is read.
TEST(LasReader, ReportsAFileThatShrinks)
{
    std::mt19937_64 random(7);
    TemporaryFolder folder;
    const auto path = write_file(folder / "a.las", random_las(random, 2, 0, 1000).bytes());
    const auto reader = open_reader(path);
    std::filesystem::resize_file(path, 1000);
    PointBatch batch;
    EXPECT_EQ(error_of([&] { reader->read(batch, 1000); }).code(), ErrorCode::truncated);
}

TEST(LasReader, TrailingBytesAreNoted)
{
    std::mt19937_64 random(8);
    TemporaryFolder folder;
    const Whole whole = read_whole(write_file(folder / "a.las", random_las(random, 2, 0, 2).bytes() + "tail"));
    EXPECT_EQ(whole.points.size, 2u);
    EXPECT_TRUE(any_mentions(whole.info.notes, "4 bytes after the last point"));
}

struct Refusal {
    const char* name;
    std::function<void(Bytes&)> damage;
    ErrorCode code;
    const char* says;
};

TEST(LasReader, RefusesHeadersThatCannotBe)
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const Refusal refusals[] = {
        {"version 2.0", [](Bytes& b) { b.overwrite(24, std::uint8_t{2}); }, ErrorCode::unsupported, "2.2"},
        {"version 1.9", [](Bytes& b) { b.overwrite(25, std::uint8_t{9}); }, ErrorCode::unsupported, "1.9"},
        {"format 11", [](Bytes& b) { b.overwrite(104, std::uint8_t{11}); }, ErrorCode::unsupported, "format 11"},
        {"small header", [](Bytes& b) { b.overwrite(94, std::uint16_t{226}); }, ErrorCode::bad_format, "226"},
        {"large header", [](Bytes& b) { b.overwrite(94, std::uint16_t{60000}); }, ErrorCode::truncated, "60000"},
        {"points in the header", [](Bytes& b) { b.overwrite(96, std::uint32_t{226}); }, ErrorCode::bad_format, "226"},
        {"points behind the end", [](Bytes& b) { b.overwrite(96, 0xFFFFFFFFu); }, ErrorCode::truncated, "4294967295"},
        {"short records", [](Bytes& b) { b.overwrite(105, std::uint16_t{25}); }, ErrorCode::bad_format, "25 bytes"},
        {"no records", [](Bytes& b) { b.overwrite(105, std::uint16_t{0}); }, ErrorCode::bad_format, "0 bytes"},
        {"one point more", [](Bytes& b) { b.overwrite(107, std::uint32_t{6}); }, ErrorCode::truncated, "6 points"},
        {"all points", [](Bytes& b) { b.overwrite(107, 0xFFFFFFFFu); }, ErrorCode::truncated, "4294967295 points"},
        {"scale 0", [](Bytes& b) { b.overwrite(131, 0.0); }, ErrorCode::bad_format, "scale of x"},
        {"scale < 0", [](Bytes& b) { b.overwrite(131, -1.0); }, ErrorCode::bad_format, "scale of x"},
        {"scale nan", [=](Bytes& b) { b.overwrite(139, nan); }, ErrorCode::bad_format, "scale of y"},
        {"scale inf", [=](Bytes& b) { b.overwrite(147, infinity); }, ErrorCode::bad_format, "scale of z"},
        {"offset nan", [=](Bytes& b) { b.overwrite(155, nan); }, ErrorCode::bad_format, "offset of x"},
    };
    std::mt19937_64 random(9);
    TemporaryFolder folder;
    for (const Refusal& refusal : refusals) {
        Bytes bytes;
        bytes.raw(random_las(random, 2, 2, 5).bytes());
        refusal.damage(bytes);
        const auto path = write_file(folder / "a.las", bytes.data);
        const Error error = error_of([&] { open_reader(path); });
        EXPECT_EQ(error.code(), refusal.code) << refusal.name << ": " << error.what();
        EXPECT_TRUE(mentions(error.what(), refusal.says)) << refusal.name << ": " << error.what();
        EXPECT_TRUE(mentions(error.what(), path.string())) << refusal.name << ": " << error.what();
    }
}

TEST(LasReader, CountsOfLas14)
{
    std::mt19937_64 random(10);
    TemporaryFolder folder;
    LasFile file = random_las(random, 4, 6, 5);
    file.legacy_count = false;
    EXPECT_EQ(read_whole(write_file(folder / "a.las", file.bytes())).points.size, 5u);

    file.legacy_count = true;
    Bytes bytes;
    bytes.raw(file.bytes());
    bytes.overwrite(247, std::uint64_t{0});  // writers that fill only the old field
    EXPECT_EQ(read_whole(write_file(folder / "a.las", bytes.data)).points.size, 5u);

    bytes.overwrite(247, std::uint64_t{4});
    const Whole four = read_whole(write_file(folder / "a.las", bytes.data));
    EXPECT_EQ(four.points.size, 4u);
    EXPECT_TRUE(any_mentions(four.info.notes, "two point counts"));

    // count * record length is 20 modulo 2^64
    bytes.overwrite(247, std::uint64_t{0x8888888888888889u});
    EXPECT_EQ(error_of([&] { open_reader(write_file(folder / "a.las", bytes.data)); }).code(), ErrorCode::truncated);
}

TEST(LasReader, DamagedVlrsDoNotHideThePoints)
{
    std::mt19937_64 random(11);
    TemporaryFolder folder;
    LasFile file = random_las(random, 4, 6, 5);
    file.vlrs = {{"good", 1, "12345"}, {"bad", 2, "12345"}};
    file.evlrs = {{"good", 3, "12345"}, {"bad", 4, "12345"}};
    const std::string good = file.bytes();

    const auto read_damaged = [&](std::size_t at, auto value) {
        Bytes bytes;
        bytes.raw(good);
        bytes.overwrite(at, value);
        Whole whole = read_whole(write_file(folder / "a.las", bytes.data));
        EXPECT_EQ(whole.points.size, 5u);
        for (std::size_t i = 0; i < 5; ++i) expect_record(whole, i, file.records[i], 6);
        EXPECT_FALSE(whole.info.notes.empty());
        return whole.info.metadata.size() - 1;  // without the header
    };
    EXPECT_EQ(read_damaged(100, 0xFFFFFFFFu), 4u);                          // VLR count
    EXPECT_EQ(read_damaged(375 + 59 + 20, std::uint16_t{6}), 3u);           // length of the second VLR
    EXPECT_EQ(read_damaged(243, 0xFFFFFFFFu), 4u);                          // EVLR count
    EXPECT_EQ(read_damaged(235, std::uint64_t{0}), 2u);                     // EVLRs in the header
    EXPECT_EQ(read_damaged(235, ~std::uint64_t{0}), 2u);                    // EVLRs nowhere
    EXPECT_EQ(read_damaged(good.size() - 65 + 20, ~std::uint64_t{0}), 3u);  // length of the second EVLR
}

TEST(LasReader, ExtraBytesOfEveryType)
{
    static constexpr ScalarType types[] = {ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16,
                                           ScalarType::u32, ScalarType::i32, ScalarType::u64, ScalarType::i64,
                                           ScalarType::f32, ScalarType::f64};
    std::mt19937_64 random(12);
    TemporaryFolder folder;
    std::string descriptors;
    std::size_t extra = 0;
    for (int type = 1; type <= 30; ++type) {
        descriptors +=
            extra_descriptor(type, type % 3 ? 0x18 : 0, "field " + std::to_string(type), {0.5, 0.5, 0.5}, {-7, -7, -7});
        extra += size_of(types[(type - 1) % 10]) * static_cast<std::size_t>((type - 1) / 10 + 1);
    }
    descriptors += extra_descriptor(0, 3, "plain");
    extra += 3 + 2;  // two undescribed bytes
    for (const bool in_evlr : {false, true}) {
        LasFile file = random_las(random, 4, 6, 40, extra);
        (in_evlr ? file.evlrs : file.vlrs) = {{"LASF_Spec", 4, descriptors}};
        const Whole whole = read_whole(write_file(folder / "a.las", file.bytes()));
        std::size_t at = 0;
        const auto expect_bytes = [&](const std::string& name, ScalarType type, std::uint32_t components) {
            const auto index = whole.info.schema.find(name);
            ASSERT_TRUE(index) << name;
            const Attribute& attribute = whole.info.schema[*index];
            EXPECT_EQ(attribute.type, type);
            EXPECT_EQ(attribute.components, components);
            for (std::size_t i = 0; i < 40; ++i)
                ASSERT_EQ(std::memcmp(whole.points.attributes[*index].data() + i * attribute.bytes(),
                                      file.records[i].extra.data() + at, attribute.bytes()),
                          0)
                    << name;
            at += attribute.bytes();
        };
        for (int type = 1; type <= 30; ++type) {
            const std::string name = "field " + std::to_string(type);
            expect_bytes(name, types[(type - 1) % 10], static_cast<std::uint32_t>((type - 1) / 10 + 1));
            const Attribute& attribute = whole.info.schema[*whole.info.schema.find(name)];
            EXPECT_EQ(attribute.scale, type % 3 ? 0.5 : 1.0);
            EXPECT_EQ(attribute.offset, type % 3 ? -7.0 : 0.0);
            EXPECT_EQ(attribute.description, "about " + name);
        }
        expect_bytes("plain", ScalarType::u8, 3);
        expect_bytes("extra_bytes", ScalarType::u8, 2);
        EXPECT_TRUE(whole.info.notes.empty());
    }
}

TEST(LasReader, ExtraBytesNamesAndScalesThatClash)
{
    std::mt19937_64 random(13);
    TemporaryFolder folder;
    LasFile file = random_las(random, 2, 0, 3, 2 + 2 + 2 + 6 + 1);
    file.vlrs = {{"LASF_Spec", 4,
                  extra_descriptor(3, 0, "intensity") + extra_descriptor(3, 0, "same") +
                      extra_descriptor(3, 0, "same") + extra_descriptor(23, 0x08, "mixed", {1, 2, 3}) +
                      extra_descriptor(1, 0x08, std::string("ctl\x01", 4), {0, 0, 0})}};
    const Whole whole = read_whole(write_file(folder / "a.las", file.bytes()));
    for (const char* name : {"intensity", "intensity_2", "same", "same_2", "mixed[0]", "mixed[1]", "mixed[2]", "ctl_"})
        EXPECT_TRUE(whole.info.schema.find(name)) << name;
    EXPECT_EQ(whole.info.schema[*whole.info.schema.find("mixed[2]")].scale, 3.0);
    EXPECT_EQ(whole.info.schema[*whole.info.schema.find("ctl_")].scale, 1.0);
    EXPECT_TRUE(any_mentions(whole.info.notes, "scale or offset"));
    for (std::size_t i = 0; i < 3; ++i) {
        const auto low = static_cast<unsigned char>(file.records[i].extra[10]),
                   high = static_cast<unsigned char>(file.records[i].extra[11]);
        EXPECT_EQ(whole.raw<std::uint16_t>("mixed[2]", i), low | high << 8);
    }
}

// As CloudCompare and PDAL write them, and as this library did before.
TEST(LasReader, NormalsByTheNamesOfOtherPrograms)
{
    std::mt19937_64 random(15);
    TemporaryFolder folder;
    const auto schema_of_file = [&](const std::string& descriptors, std::size_t bytes) {
        LasFile file = random_las(random, 2, 0, 3, bytes);
        file.vlrs = {{"LASF_Spec", 4, descriptors}};
        return read_whole(write_file(folder / "a.las", file.bytes())).info.schema;
    };
    const auto named = [](const char* x, const char* y, const char* z) {
        return extra_descriptor(9, 0, x) + extra_descriptor(9, 0, y) + extra_descriptor(9, 0, z);
    };
    for (const std::string& descriptors : {named("NormalX", "NormalY", "NormalZ"),
                                           named("normalx", "normaly", "normalz"), extra_descriptor(29, 0, "normal")}) {
        const Schema schema = schema_of_file(descriptors + extra_descriptor(1, 0, "gap"), 13);
        const auto place = schema.find("normal");
        ASSERT_TRUE(place);
        EXPECT_EQ(schema[*place].type, ScalarType::f32);
        EXPECT_EQ(schema[*place].components, 3u);
        EXPECT_TRUE(schema.find("gap"));
    }
    // Not three numbers of one type in a row: separate attributes.
    for (const Schema& schema :
         {schema_of_file(named("NormalX", "NormalZ", "NormalY"), 12),
          schema_of_file(extra_descriptor(9, 0, "NormalX") + extra_descriptor(10, 0, "NormalY") +
                             extra_descriptor(9, 0, "NormalZ"),
                         16),
          schema_of_file(extra_descriptor(9, 0, "NormalX") + extra_descriptor(9, 0, "NormalY"), 8)}) {
        EXPECT_FALSE(schema.find("normal"));
        EXPECT_TRUE(schema.find("NormalX"));
    }
}

TEST(LasReader, MalformedExtraBytesStayAsBytes)
{
    std::mt19937_64 random(14);
    TemporaryFolder folder;
    const std::string u16 = extra_descriptor(3, 0, "ok");
    std::string three_hundred;
    for (int i = 0; i < 300; ++i) three_hundred += extra_descriptor(1, 0, "x");
    for (const std::string& descriptors : {u16 + u16 + u16, u16.substr(0, 191), u16 + "x", extra_descriptor(31, 0, "t"),
                                           u16 + extra_descriptor(0, 255, "t"), three_hundred}) {
        LasFile file = random_las(random, 2, 1, 4, descriptors == three_hundred ? 300 : 5);
        file.vlrs = {{"LASF_Spec", 4, descriptors}};
        const Whole whole = read_whole(write_file(folder / "a.las", file.bytes()));
        EXPECT_TRUE(any_mentions(whole.info.notes, "Extra Bytes VLR is malformed"));
        EXPECT_FALSE(whole.info.schema.find("ok"));
        for (std::size_t i = 0; i < 4; ++i) expect_record(whole, i, file.records[i], 1);
    }
}

// The longest records: a batch must stay small however many points are requested.
TEST(LasReader, LongRecords)
{
    std::mt19937_64 random(15);
    TemporaryFolder folder;
    const LasFile file = random_las(random, 2, 0, 1500, 65535 - 20);
    const auto path = write_file(folder / "a.las", file.bytes());
    const auto reader = open_reader(path);
    PointBatch batch;
    std::size_t points = 0;
    while (reader->read(batch, 1u << 30)) {
        EXPECT_LE(batch.size * 65535, std::size_t{65} << 20);
        points += batch.size;
    }
    EXPECT_EQ(points, 1500u);
    const Whole whole = read_whole(path);
    for (const std::size_t i : {0, 700, 1499})
        EXPECT_EQ(whole.raw<std::uint8_t>("extra_bytes", i, 65514),
                  static_cast<std::uint8_t>(file.records[i].extra[65514]));
}

}  // namespace
}  // namespace pcm::test
