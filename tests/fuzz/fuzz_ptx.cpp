#include "pcm/io/ptx/ptx_reader.h"
#include "tests/fuzz/reader_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    pcm::fuzz::read_all(pcm::open_ptx, bytes, size);
    pcm::ReadOptions skipping;
    skipping.skip_bad_lines = true;
    pcm::fuzz::read_all(pcm::open_ptx, bytes, size, skipping);
    return 0;
}
