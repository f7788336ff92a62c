// Where the reader's raw LAS records come from: the file as it is, or the chunks of LAZ.
#pragma once

#include "pcm/io/las/las_header.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace pcm::las {

struct RecordSpan {
    const std::byte* records = nullptr;
    std::size_t count = 0;
};

// One thread.
class RecordSource {
public:
    virtual ~RecordSource() = default;

    // The next records in file order, 1 to `most` (> 0) of them, valid until the next call. Not called behind the last
    // one. Throws Error(truncated | corrupt | io).
    virtual RecordSpan next(std::size_t most) = 0;
    virtual bool seekable() const { return false; }
    virtual void seek(std::uint64_t) {}
};

// Both need `file` and `header` as long as they live.
std::unique_ptr<RecordSource> plain_records(const File& file, const Header& header);
// Checks the laszip VLR and the chunk table. `threads`: most to decode with. Throws Error(bad_format | truncated |
// corrupt | unsupported), the last one also where LAZ was left out of this build.
std::unique_ptr<RecordSource> laz_records(const File& file, std::uint64_t file_size, const Header& header,
                                          const std::vector<Vlr>& vlrs, unsigned threads,
                                          std::vector<std::string>& notes);

}  // namespace pcm::las
