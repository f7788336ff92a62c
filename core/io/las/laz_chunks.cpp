#ifdef PCM_HAVE_DECODERS

#include "pcm/io/las/laz_chunks.h"

#include "pcm/system/error.h"

#include <array>

namespace pcm::las {

void Chunks::fail(std::uint64_t chunk, std::uint64_t from_byte, std::uint64_t first_point,
                  const std::string& what) const
{
    if (what.empty()) throw_no_memory();
    throw Error(ErrorCode::corrupt, file->path(),
                "LAZ chunk " + std::to_string(chunk + 1) + " at byte " + std::to_string(from_byte) +
                    ", which starts with point " + std::to_string(first_point) + ", cannot be decoded: " + what,
                "the file is damaged: copy it again from its source");
}

void Chunks::throw_no_memory() const
{
    throw Error(ErrorCode::io, file->path(), "the system has too little memory to decode LAZ",
                "close other programs, or use fewer threads");
}

Decoder Chunks::open(std::uint64_t chunk, std::uint64_t from_byte, std::uint64_t to_byte, std::uint64_t first_point,
                     std::uint64_t& chunk_count) const
{
    std::array<char, laz_message_bytes> message{};
    Decoder decoder(pcm_laz_decoder_open(reinterpret_cast<const std::uint8_t*>(vlr.data()), vlr.size(), coder_bytes,
                                         file->descriptor(), from_byte, to_byte, message.data(), message.size()));
    if (!decoder) fail(chunk, from_byte, first_point, message.data());
    if (pcm_laz_decoder_record_bytes(decoder.get()) != record_length)
        fail(chunk, from_byte, first_point, "its records have another length");
    if (layered()) {
        const std::uint64_t stated = pcm_laz_decoder_chunk_points(decoder.get());
        if (chunk_count == 0) chunk_count = stated;
        if (stated != chunk_count || stated == 0)
            fail(chunk, from_byte, first_point,
                 "it states " + std::to_string(stated) + " points, " + std::to_string(chunk_count) + " were expected");
    }
    return decoder;
}

void Chunks::decode(pcm_laz_decoder* decoder, std::byte* to, std::size_t points_now, std::uint64_t chunk,
                    std::uint64_t from_byte, std::uint64_t first_point) const
{
    std::array<char, laz_message_bytes> message{};
    if (pcm_laz_decode(decoder, reinterpret_cast<std::uint8_t*>(to), points_now, message.data(), message.size()) != 0)
        fail(chunk, from_byte, first_point, message.data());
}

}  // namespace pcm::las

#endif
