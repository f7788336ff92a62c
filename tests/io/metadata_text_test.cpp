// Blocks of metadata, as people read them.

#include "pcm/io/metadata_text.h"

#include "tests/io/bytes.h"

namespace {

using namespace pcm;
using namespace pcm::test;

Metadata block(const std::string& key, const std::string& value)
{
    const auto* bytes = reinterpret_cast<const std::byte*>(value.data());
    return {key, {bytes, bytes + value.size()}};
}

TEST(MetadataText, TextIsShownAsItIs)
{
    const std::string wkt = "PROJCS[\"NAD83 / UTM zone 17N\",GEOGCS[\"NAD83\"]]";
    EXPECT_EQ(text_of(block("las.vlr/LASF_Projection/2112", wkt + std::string(3, '\0'))), wkt);
    EXPECT_EQ(text_of(block("ply.comment", "two\nlines\n")), "two lines");
    EXPECT_EQ(text_of(block("empty", "")), "");
}

TEST(MetadataText, BytesAreNot)
{
    EXPECT_EQ(text_of(block("las.vlr/someone/1", std::string("a\0b", 3))), "");
    EXPECT_EQ(text_of(block("las.vlr/someone/1", "\x80\x81")), "");
    EXPECT_EQ(text_of(block("las.vlr/someone/1", "\x1b[2J")), "");
}

TEST(MetadataText, GeoKeysHaveNames)
{
    Bytes directory;
    for (const int n : {1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 26917, 1026, 34737, 22, 0})
        directory.put(static_cast<std::uint16_t>(n));
    const std::string key = "las.vlr/LASF_Projection/34735";
    EXPECT_EQ(text_of(block(key, directory.data)), "GTModelType 1, ProjectedCSType 26917, GTCitation");
    // Cut at any byte it says less, and never reads beyond.
    for (std::size_t size = 0; size < directory.data.size(); ++size) {
        const std::string whole = text_of(block(key, directory.data));
        EXPECT_EQ(whole.rfind(text_of(block(key, directory.data.substr(0, size))), 0), 0u);
    }
}

}  // namespace
