// The source of the reader's raw LAS records: the file itself, or the chunks of LAZ.
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

    // The next records in file order, 1 to `most` (> 0) of them, valid until the next call. Must not be called
    // after the last one. Throws Error(truncated | corrupt | io).
    virtual RecordSpan next(std::size_t most) = 0;
    virtual bool seekable() const { return false; }
    virtual void seek(std::uint64_t) {}
};

// `file` and `header` must outlive both.
std::unique_ptr<RecordSource> plain_records(const File& file, const Header& header);
// Checks the laszip VLR and the chunk table. `threads`: maximum number of decoding threads. Throws Error(bad_format |
// truncated | corrupt | unsupported), also Error(unsupported) where this build has no LAZ.
std::unique_ptr<RecordSource> laz_records(const File& file, std::uint64_t file_size, const Header& header,
                                          const std::vector<Vlr>& vlrs, unsigned threads,
                                          std::vector<std::string>& notes);

}  // namespace pcm::las
