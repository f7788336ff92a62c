#include "pcm/system/byte_source.h"

#include "pcm/system/error.h"

#include <string>

namespace pcm {

void ByteSource::read_at(void* to, std::size_t bytes, std::uint64_t offset) const
{
    const std::size_t got = read_some_at(to, bytes, offset);
    if (got < bytes)
        throw Error(ErrorCode::truncated, path(),
                    "the file ends at byte " + std::to_string(offset + got) + ", " + std::to_string(bytes) +
                        " bytes were expected from byte " + std::to_string(offset));
}

}  // namespace pcm
