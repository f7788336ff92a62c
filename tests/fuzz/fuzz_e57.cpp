#include "pcm/io/e57/e57_pages.h"
#include "pcm/io/e57/e57_reader.h"
#include "tests/fuzz/reader_input.h"

#include <vector>

// Corrects the checksums of the pages: otherwise the fuzzer would never reach the code after their check.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    using pcm::E57Pages;
    std::vector<std::uint8_t> file(bytes, bytes + size);
    for (std::size_t at = 0; at + E57Pages::page_bytes <= size; at += E57Pages::page_bytes) {
        const std::uint32_t crc = pcm::crc32c(reinterpret_cast<const std::byte*>(&file[at]), E57Pages::content_bytes);
        for (std::size_t k = 0; k < 4; ++k)
            file[at + E57Pages::content_bytes + k] = static_cast<std::uint8_t>(crc >> (24 - 8 * k));
    }
    pcm::fuzz::read_all(pcm::open_e57, file.data(), size);
    return 0;
}
