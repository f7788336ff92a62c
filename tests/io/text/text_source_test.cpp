#include "pcm/io/text/text_source.h"

#include "tests/io/bytes.h"

#include <random>

namespace pcm::test {
namespace {

TEST(TextSource, BlocksAndLinesOfAllLengths)
{
    std::mt19937_64 random(3);
    TemporaryFolder folder;
    for (const std::string end : {"\n", "\r\n", "\r"})
        for (int round = 0; round < 20; ++round) {
            std::vector<std::string> lines(1 + random() % 40);
            std::string text;
            for (std::string& line : lines) {
                line.assign(random() % 10 ? random() % 100 : random() % 400000, 'a');
                text += line + end;
            }
            if (round % 2 && !lines.back().empty()) text.resize(text.size() - end.size());
            const File file(write_file(folder / "a", text), File::Mode::read);
            TextSource source(file);
            std::string_view line;
            std::size_t count = 0;
            while (source.next(line)) {
                ASSERT_LT(count, lines.size());
                ASSERT_EQ(line, lines[count++]);
                ASSERT_EQ(source.lines_read(), count);
                ASSERT_LE(source.bytes_read(), text.size());
            }
            ASSERT_EQ(count, lines.size());
            ASSERT_EQ(source.bytes_read(), text.size());
        }
}

}  // namespace
}  // namespace pcm::test
