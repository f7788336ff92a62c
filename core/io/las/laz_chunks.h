// How the points of a LAZ file are split into chunks, and how one is decoded. Only where PCM_HAVE_DECODERS is defined.
#pragma once

#include "pcm/decoders/decoders.h"
#include "pcm/io/las/laz_layout.h"
#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pcm::las {

inline constexpr std::size_t laz_message_bytes = 512;

struct CloseDecoder {
    void operator()(pcm_laz_decoder* decoder) const { pcm_laz_decoder_close(decoder); }
};
using Decoder = std::unique_ptr<pcm_laz_decoder, CloseDecoder>;

struct Chunks {
    const File* file = nullptr;
    std::vector<std::byte> vlr;
    std::size_t record_length = 0;
    std::size_t coder_bytes = 0;  // laz::coder_bytes()
    std::uint64_t points = 0;
    laz::Compressor compressor = laz::Compressor::none;
    std::uint32_t chunk_points = 0;    // laz::variable_chunks: as the table states
    std::uint64_t begin = 0, end = 0;  // bytes of all chunks

    // For every chunk, and one past the end; empty without a chunk table.
    std::vector<std::uint64_t> starts;
    std::vector<std::uint64_t> first_points;

    bool has_table() const { return !starts.empty(); }
    std::size_t count() const { return starts.size() - 1; }
    bool layered() const { return compressor == laz::Compressor::layered_chunked; }

    // Both throw Error(corrupt), which names the chunk, and Error(io) when there is too little memory.
    // `chunk_count`: the points that the chunk should hold; when 0, it is set to what the chunk states.
    Decoder open(std::uint64_t chunk, std::uint64_t from_byte, std::uint64_t to_byte, std::uint64_t first_point,
                 std::uint64_t& chunk_count) const;
    void decode(pcm_laz_decoder* decoder, std::byte* to, std::size_t points_now, std::uint64_t chunk,
                std::uint64_t from_byte, std::uint64_t first_point) const;

    [[noreturn]] void throw_no_memory() const;

private:
    [[noreturn]] void fail(std::uint64_t chunk, std::uint64_t from_byte, std::uint64_t first_point,
                           const std::string& what) const;
};

}  // namespace pcm::las
