// Damaged and hostile E57 files are refused with the place and the cause, in bounded memory.
#include "tests/io/e57/e57_test.h"

#include <cmath>
#include <limits>

namespace pcm::test {
namespace {

using Field = E57TestField;

TEST_F(E57, PointsThatTakeNoBytes)
{
    E57TestScan scan;
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
        scan.fields.push_back(Field::integer(name, 5, 5, {5}));
    EXPECT_EQ(read({scan}).position(0), (Vec3d{5, 5, 5}));
    scan.promised = std::uint64_t{1} << 60;
    EXPECT_EQ(refusal(e57_file({scan})).code(), ErrorCode::truncated);
}

TEST_F(E57, PromisesAreNotBelieved)
{
    E57TestScan scan = simple_scan(100);
    for (const std::uint64_t promised : {std::uint64_t{101}, std::uint64_t{44000000}, ~std::uint64_t{0}}) {
        scan.promised = promised;
        const Error error = refusal(e57_file({scan}));
        EXPECT_EQ(error.code(), ErrorCode::truncated) << error.what();
    }
}

// Each scan alone fits in the file, all of them together do not.
TEST_F(E57, ScansInOnePlace)
{
    std::vector<E57TestScan> scans = {simple_scan(10000), simple_scan(10), simple_scan(10), simple_scan(10)};
    for (std::size_t i = 1; i < scans.size(); ++i) scans[i].promised = 10000;
    std::string bytes = e57_file(scans);
    std::string content;
    for (std::size_t at = 0; at < bytes.size(); at += 1024) content += bytes.substr(at, 1020);
    const std::string label = "fileOffset=\"";
    for (std::size_t at = content.find(label); at != std::string::npos; at = content.find(label, at + 1)) {
        const std::size_t number = at + label.size(), digits = content.find('"', number) - number;
        content.replace(number, digits, std::string(digits - 2, '0') + "48");
    }
    const Error error = refusal(e57_pages(content));
    EXPECT_EQ(error.code(), ErrorCode::bad_format);
    EXPECT_TRUE(mentions(error.what(), "scan 2 promise points of 480000 bytes")) << error.what();
}

TEST_F(E57, AWrongByteIsFound)
{
    const std::string good = e57_file({simple_scan(300)});
    for (const std::size_t at : {std::size_t{100}, std::size_t{1500}, std::size_t{3071}, good.size() - 1}) {
        std::string bytes = good;
        bytes[at] = static_cast<char>(bytes[at] ^ 4);
        const Error error = refusal(bytes);
        EXPECT_EQ(error.code(), ErrorCode::corrupt) << error.what();
        EXPECT_TRUE(mentions(error.what(), "page " + std::to_string(at / 1024))) << error.what();
        EXPECT_TRUE(mentions(error.what(), "byte " + std::to_string(at / 1024 * 1024))) << error.what();
    }
}

TEST_F(E57, TruncatedFiles)
{
    const std::string good = e57_file({simple_scan(200, colours(255, std::vector<std::int64_t>(200, 9)))});
    for (std::size_t size = 0; size < good.size(); size += size < 1100 ? 1 : 97) refusal(good.substr(0, size));
    for (std::size_t pages = 1; pages < good.size() / 1024; ++pages)
        EXPECT_EQ(refusal(good.substr(0, pages * 1024)).code(), ErrorCode::truncated);
}

TEST_F(E57, HostileXml)
{
    const auto with = [&](const std::string& xml) { return e57_file({simple_scan(1)}, 1, xml); };
    std::string many;
    for (int i = 0; i < 400000; ++i) many += "<a/>";
    EXPECT_EQ(refusal(with(many)).code(), ErrorCode::unsupported);
    many = "<a ";
    for (int i = 0; i < 2000; ++i) many += "b" + std::to_string(i) + "=\"\" ";
    EXPECT_EQ(refusal(with(many + "/>")).code(), ErrorCode::unsupported);
    many.clear();
    for (int i = 0; i < 300; ++i) many += "<a xmlns:b" + std::to_string(i) + "=\"u\"/>";
    EXPECT_EQ(refusal(with(many)).code(), ErrorCode::unsupported);
    // Depth alone is harmless.
    many.clear();
    for (int i = 0; i < 100000; ++i) many += "<a>";
    for (int i = 0; i < 100000; ++i) many += "</a>";
    EXPECT_EQ(read_whole(write_file(folder_ / "a.e57", with(many))).points.size, 1u);
    EXPECT_EQ(refusal(with("<unclosed>")).code(), ErrorCode::bad_format);
}

TEST_F(E57, SaysWhatIsWrong)
{
    E57TestScan scan;
    scan.fields = {Field::f64("cartesianX", {1}), Field::f64("cartesianY", {1})};
    EXPECT_TRUE(mentions(refusal(e57_file({scan})).what(), "three cartesian"));
    EXPECT_TRUE(mentions(refusal(e57_file({simple_scan(1, {}, E57TestScan::pose(1, 0, 0, 0, {0, NAN, 0}))})).what(),
                         "translation"));
    std::string bytes = e57_file({simple_scan(1)});
    bytes[8] = 2;
    EXPECT_TRUE(mentions(refusal(e57_with_right_checksums(bytes)).what(), "version 2.0"));
    bytes = e57_file({simple_scan(1)});
    bytes[48] = 3;  // the type of the section of points
    const Error error = refusal(e57_with_right_checksums(bytes));
    EXPECT_TRUE(mentions(error.what(), "byte 48") && mentions(error.what(), "type 3")) << error.what();
    bytes = e57_file({simple_scan(1)});
    bytes[80] = 9;  // type of the first packet
    EXPECT_TRUE(mentions(refusal(e57_with_right_checksums(bytes)).what(), "byte 80: a packet of type 9"));
}

// Mutated content with correct checksums is read or refused.
TEST_F(E57, Mutations)
{
    std::mt19937_64 random(5);
    const std::vector<std::int64_t> small = {0, 1, 2, 0, 1, 2, 0, 1};
    const std::string seeds[] = {
        e57_file({simple_scan(8,
                              {Field::integer("cartesianInvalidState", 0, 2, small),
                               Field::f32("intensity", {1, 2, 3, 4, 5, 6, 7, 8})},
                              E57TestScan::pose(1, 0, 1, 0, {1, 2, 3})),
                  simple_scan(8, colours(255, small))}),
        e57_file({simple_scan(8, {Field::integer("nor:a", 0, 5, small, "scale=\"0.1\"")})}, 2)};
    int read = 0, refused = 0;
    for (int round = 0; round < 3000; ++round) {
        std::string bytes = seeds[round % 2];
        const std::size_t xml = bytes.find("<?xml");
        for (std::uint64_t change = 0; change <= random() % 3; ++change) {
            // The header, the sections of points, the XML: numbers in it above all.
            std::size_t at = random() % (random() % 2 ? xml : bytes.size());
            if (at >= xml)
                while (at + 1 < bytes.size() && (bytes[at] < '0' || bytes[at] > '9') && random() % 8) ++at;
            const bool digit = bytes[at] >= '0' && bytes[at] <= '9';
            bytes[at] = digit && random() % 4 ? static_cast<char>('0' + random() % 10) : static_cast<char>(random());
        }
        const auto path = write_file(folder_ / "a.e57", e57_with_right_checksums(bytes));
        try {
            const auto reader = open_reader(path);
            PointBatch batch;
            std::uint64_t points = 0;
            while (reader->read(batch, 1u << 30)) points += batch.size;
            ASSERT_LE(points, reader->info().points);
            if (reader->info().points_known) ASSERT_EQ(points, reader->info().points);
            ++read;
        } catch (const Error& error) {
            ASSERT_TRUE(mentions(error.what(), path.string())) << error.what();
            ++refused;
        }
    }
    EXPECT_GT(read, 150);
    EXPECT_GT(refused, 150);
}

}  // namespace
}  // namespace pcm::test
