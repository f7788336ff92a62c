// Reads bytes to the end as a file that exists only in memory.
#pragma once

#include "pcm/io/reader.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

namespace pcm::fuzz {

// Any pcm::Error is a valid result. Any other exception, and a wrong number of points, is a finding.
inline void read_all(std::unique_ptr<PointReader> (*open)(const std::filesystem::path&, const ReadOptions&),
                     const std::uint8_t* bytes, std::size_t size, const ReadOptions& options = {})
{
    static const int descriptor = memfd_create("input", MFD_CLOEXEC);
    if (descriptor < 0 || ftruncate(descriptor, 0) != 0 ||
        pwrite(descriptor, bytes, size, 0) != static_cast<ssize_t>(size))
        std::abort();
    try {
        const auto reader = open("/proc/self/fd/" + std::to_string(descriptor), options);
        PointBatch batch;
        std::uint64_t points = 0;
        while (reader->read(batch, 1000)) points += batch.size;
        if (reader->info().points_known && points != reader->info().points) std::abort();
        if (reader->seekable() && points) {
            reader->seek(points - 1);
            if (!reader->read(batch, 10) || batch.size != 1) std::abort();
        }
    } catch (const Error&) {
    }
}

}  // namespace pcm::fuzz
