#include "pcm/io/las/las_reader.h"
#include "tests/fuzz/reader_input.h"

// By one thread and by several, as the input's size has it: both see the whole corpus.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    static unsigned threads;
    threads = 1 + 2 * static_cast<unsigned>(size % 2);
    pcm::fuzz::read_all(
        [](const std::filesystem::path& path) {
            pcm::ReadOptions options;
            options.threads = threads;
            return pcm::open_las(path, options);
        },
        bytes, size);
    return 0;
}
