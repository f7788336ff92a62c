// The destination of the writer's LAS records: the file itself, or the chunks of LAZ, compressed.
#pragma once

#include "pcm/system/output_file.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm::las {

struct RecordRoom {
    std::byte* records = nullptr;  // zeros
    std::size_t count = 0;
};

// One thread. Records are appended to the file as it is when the sink is created.
class RecordSink {
public:
    virtual ~RecordSink() = default;
    // Room for the next 1 to `most` (> 0) records, to be filled before the next call.
    virtual RecordRoom room(std::size_t most) = 0;
    // Writes the remaining records to the file. To be called once.
    virtual void finish() = 0;
};

// `out` must outlive the sinks.
std::unique_ptr<RecordSink> plain_sink(OutputFile& out, std::size_t record_length);
// Compresses on up to `threads` threads (0: one per processor); the bytes are the same for any number. `laszip_vlr` is
// the payload of the VLR in the file.
std::unique_ptr<RecordSink> laz_sink(OutputFile& out, std::size_t record_length, std::vector<std::byte> laszip_vlr,
                                     unsigned threads);

// The payload of the laszip VLR for a point format. Throws Error(unsupported) where this build has no LAZ and for more
// extra bytes than can be compressed in bounded memory.
std::vector<std::byte> make_laszip_vlr(const std::filesystem::path& path, unsigned format, std::size_t record_length);

}  // namespace pcm::las
