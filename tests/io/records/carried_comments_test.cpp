// What comments of a header carry comes back as it was.

#include "pcm/io/records/carried_comments.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace pcm;

// Printable characters of ASCII, of which many have to be encoded.
std::string random_text(std::mt19937_64& random, std::size_t most)
{
    std::string text;
    for (std::size_t n = random() % (most + 1); n > 0; --n) text += static_cast<char>(' ' + random() % 95);
    return text;
}

TEST(CarriedComments, RandomOnesComeBack)
{
    std::mt19937_64 random(11);
    for (int round = 0; round < 300; ++round) {
        Carried carried;
        for (std::size_t n = random() % 4; n > 0; --n) {
            CarriedAttribute attribute;
            attribute.field = "f" + std::to_string(n);
            attribute.attribute.name = "a" + random_text(random, 20) + "z";
            attribute.attribute.type = static_cast<ScalarType>(static_cast<int>(ScalarType::i8) + random() % 10);
            attribute.attribute.components = static_cast<std::uint32_t>(1 + random() % 5);
            attribute.attribute.scale = static_cast<double>(random() % 1000) / 7;
            attribute.attribute.offset = static_cast<double>(random()) - 0x1p63;
            attribute.attribute.description = random() % 3   ? "b" + random_text(random, 30) + "y"
                                              : random() % 2 ? "-"
                                                             : "";
            attribute.step = random() % 2 ? static_cast<unsigned>(random() % 300) : 0;
            carried.attributes.push_back(attribute);
        }
        for (std::size_t n = random() % 4; n > 0; --n) {
            Metadata block{random_text(random, 20), {}};
            for (std::size_t bytes = random() % 200; bytes > 0; --bytes)
                block.value.push_back(static_cast<std::byte>(random()));
            carried.metadata.push_back(block);
        }
        for (std::size_t n = random() % 3; n > 0; --n)
            carried.repeated.push_back({"r" + std::to_string(n), static_cast<std::uint32_t>(1 + random() % 9), "f1"});
        if (random() % 2) carried.shift = Vec3d{1e6 / 3, -static_cast<double>(random() % 100000), 0.1};
        std::vector<std::string> notes;
        std::vector<std::string> lines = carried_comments(carried, notes);
        for (const std::string& line : lines) {
            EXPECT_LT(line.size(), 512u);
            EXPECT_EQ(line.find('\n'), std::string::npos);
        }
        lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(random() % (lines.size() + 1)), "made by hand");
        const Carried found = read_carried_comments(lines, notes);
        EXPECT_TRUE(notes.empty()) << notes[0];
        ASSERT_EQ(found.attributes.size(), carried.attributes.size());
        for (std::size_t i = 0; i < found.attributes.size(); ++i) {
            EXPECT_EQ(found.attributes[i].field, carried.attributes[i].field);
            EXPECT_EQ(found.attributes[i].attribute, carried.attributes[i].attribute) << lines[i];
            EXPECT_EQ(found.attributes[i].step, carried.attributes[i].step);
        }
        EXPECT_EQ(found.metadata, carried.metadata);
        ASSERT_EQ(found.repeated.size(), carried.repeated.size());
        for (std::size_t i = 0; i < found.repeated.size(); ++i) {
            EXPECT_EQ(found.repeated[i].field, carried.repeated[i].field);
            EXPECT_EQ(found.repeated[i].count, carried.repeated[i].count);
            EXPECT_EQ(found.repeated[i].exact, carried.repeated[i].exact);
        }
        EXPECT_EQ(found.shift, carried.shift);
    }
}

TEST(CarriedComments, DamagedLinesAreCountedAndSkipped)
{
    for (const char* line :
         {"pcm attribute f u8 1 1 0 a%2 -", "pcm attribute f u8 1 1 0 a%zz -", "pcm attribute f u8 1 1 0 a %4",
          "pcm attribute f u8 0 1 0 a -", "pcm attribute f u8 1 inf 0 a -", "pcm attribute f u9 1 1 0 a -",
          "pcm attribute f u8 1 1 0 a - x", "pcm repeated f x g", "pcm shift 1 2", "pcm shift 1 2 nan",
          "pcm metadata k%1 0", "pcm metadata k x", "pcm metadata k 3", "pcm data AAAA"}) {
        std::vector<std::string> notes;
        const Carried found = read_carried_comments({line}, notes);
        EXPECT_EQ(notes.size(), 1u) << line;
        EXPECT_TRUE(found.attributes.empty() && found.metadata.empty() && found.repeated.empty() && !found.shift)
            << line;
    }
}

}  // namespace
