#include "pcm/io/pts/pts_reader.h"
#include "tests/fuzz/reader_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    pcm::fuzz::read_all(pcm::open_pts, bytes, size);
    pcm::ReadOptions skipping;
    skipping.skip_bad_lines = true;
    pcm::fuzz::read_all(pcm::open_pts, bytes, size, skipping);
    return 0;
}
