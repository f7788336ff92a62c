#include "pcm/io/las/las_reader.h"
#include "tests/fuzz/reader_input.h"

// With one thread or several, depending on the input's size: both see the whole corpus.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    pcm::ReadOptions options;
    options.threads = 1 + 2 * static_cast<unsigned>(size % 2);
    pcm::fuzz::read_all(pcm::open_las, bytes, size, options);
    return 0;
}
