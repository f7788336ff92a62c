#include "pcm/io/pcd/lzf_stream.h"

#include "tests/io/bytes.h"
#include "tests/io/lzf.h"

namespace pcm::test {
namespace {

TEST(LzfStream, AnyBytesInAnyPieces)
{
    std::mt19937_64 random(3);
    TemporaryFolder folder;
    for (int round = 0; round < 24; ++round) {
        std::string data;
        const std::size_t size = random() % 12000, alphabet = 1 + random() % 5;
        while (data.size() < size) data += static_cast<char>(random() % (round % 3 ? alphabet : 256));
        const std::string packed = lzf_compress(data, std::size_t{3} << random() % 7);
        const File file(write_file(folder / "a", "xx" + packed + "yy"), File::Mode::read);
        LzfStream stream(file, 2, 2 + packed.size());
        std::string found(data.size(), '\0');
        for (std::size_t done = 0; done < data.size();) {
            LzfStream copy = stream;
            const std::size_t now = std::min<std::size_t>(data.size() - done, 1 + random() % 9000);
            copy.take(nullptr, now);
            stream.take(reinterpret_cast<std::byte*>(found.data() + done), now);
            EXPECT_EQ(copy.at_end(), stream.at_end());
            done += now;
        }
        ASSERT_EQ(found, data);
        EXPECT_TRUE(stream.at_end());
        EXPECT_EQ(error_of([&] { stream.take(nullptr, 1); }).code(), ErrorCode::corrupt);
    }
}

TEST(LzfStream, BytesThatAreNotLzf)
{
    TemporaryFolder folder;
    const std::pair<std::string, const char*> cases[] = {{"", "byte 0"},
                                                         {std::string("\x05xyz", 4), "literal"},
                                                         {std::string("\x00x\x20", 3), "within a reference"},
                                                         {std::string("\x00x\xE0\x01", 4), "within a reference"},
                                                         {std::string("\x00x\x20\x01", 4), "before their beginning"},
                                                         {std::string("\x20\x00", 2), "before their beginning"}};
    for (const auto& [bytes, says] : cases) {
        const File file(write_file(folder / "a", bytes), File::Mode::read);
        LzfStream stream(file, 0, bytes.size());
        const Error error = error_of([&] { stream.take(nullptr, 1000); });
        EXPECT_EQ(error.code(), ErrorCode::corrupt);
        EXPECT_TRUE(mentions(error.what(), says)) << error.what();
    }
}

}  // namespace
}  // namespace pcm::test
