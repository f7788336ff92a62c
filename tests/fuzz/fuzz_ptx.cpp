#include "pcm/io/text/ptx_reader.h"
#include "tests/fuzz/reader_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    pcm::fuzz::read_all([](const std::filesystem::path& path) { return pcm::open_ptx(path); }, bytes, size);
    return 0;
}
