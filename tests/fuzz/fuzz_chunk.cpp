// The records of a tree's data file: chunks, whole and in parts, and commit records.

#include "pcm/bpc/batch_chunk.h"
#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_encoder.h"
#include "pcm/bpc/commit_record.h"
#include "pcm/system/error.h"
#include "tests/fuzz/seal_tree_chunk.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace {

using namespace pcm;

void require(bool holds)
{
    if (!holds) std::abort();
}

void check_part(const File& file, std::uint64_t offset, const BpcHeader& header, const DecodedChunk& whole,
                unsigned pick)
{
    const ColumnSet columns = ColumnSet::whole(header.schema);
    std::uint32_t asked = 0;
    const DecodedPart part = read_chunk_part(file, offset, header.total_bytes, header.header_bytes, columns,
                                             [&](const Box3i&, std::uint16_t) { return asked++ % pick == 0; });
    std::size_t at = 0;
    for (const std::uint32_t s : part.kept) {
        const BpcSegment& segment = header.segments[s];
        for (std::uint32_t i = 0; i < segment.count; ++i, ++at) {
            const Vec3i p = part.chunk.positions->grid(at);
            require(segment.box.contains(p) && p == whole.chunk.positions->grid(segment.first + i));
            if (header.sizes) require(part.chunk.sizes->data()[at] == whole.chunk.sizes->data()[segment.first + i]);
            for (std::size_t k = 0; k < header.schema.size(); ++k) {
                const std::size_t size = header.schema[k].bytes();
                require(std::memcmp(part.chunk.attributes[k]->data() + at * size,
                                    whole.chunk.attributes[k]->data() + (segment.first + i) * size, size) == 0);
            }
        }
    }
    require(at == part.chunk.points);
}

// Returns the length of the record.
std::uint64_t check_record(const File& file, std::uint64_t offset, std::uint64_t available)
{
    std::uint64_t bytes = 0;
    if (const auto commit = read_commit(file, offset, available, bytes)) {
        std::vector<std::byte> stored(static_cast<std::size_t>(bytes));
        file.read_at(stored.data(), stored.size(), offset);
        require(encode_commit(*commit) == stored);
        return bytes;
    }
    const BpcHeader header = read_header(file, offset, available);
    if (decoded_bytes(header) > 16 << 20) return header.total_bytes;
    const DecodedChunk whole = read_chunk(file, offset, header.total_bytes, 0, ColumnSet::whole(header.schema),
                                          ChunkPositionsMayBe::on_grid_or_doubles);
    require(whole.chunk.points == header.points);
    if (header.identity) {
        for (const unsigned pick : {1u, 2u}) check_part(file, offset, header, whole, pick);
        if (header.points > 0) {
            // A chunk that was read can be written and read again.
            Box3i box;
            for (std::size_t i = 0; i < header.points; ++i) box.extend(whole.chunk.positions->grid(i));
            if (box == header.box) {
                const auto again = encode_chunk(whole.chunk, header.schema, header.grid, *header.identity);
                const BpcHeader back = decode_header(again.data(), again.size(), {});
                require(*back.identity == *header.identity && back.box == box &&
                        back.schema.size() == header.schema.size() &&
                        back.sizes.has_value() == header.sizes.has_value());
            }
        }
    }
    return header.total_bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    std::vector<std::uint8_t> sealed(bytes, bytes + size);
    for (std::size_t at = 0; sealed.size() - at >= 44;) {
        const std::uint64_t record = fuzz::seal_record_of_tree(sealed, at);
        if (record == 0 || record > sealed.size() - at) break;
        at += static_cast<std::size_t>(record);
    }
    static const int descriptor = memfd_create("input", MFD_CLOEXEC);
    if (descriptor < 0 || ftruncate(descriptor, 0) != 0 ||
        pwrite(descriptor, sealed.data(), sealed.size(), 0) != static_cast<ssize_t>(sealed.size()))
        std::abort();
    const File file("/proc/self/fd/" + std::to_string(descriptor), File::Mode::read);
    try {
        for (std::uint64_t at = 0; at < size;) at += check_record(file, at, size - at);
    } catch (const Error&) {
    }
    return 0;
}
