#include "pcm/bpc/checksum.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace pcm {

std::uint64_t checksum(const void* data, std::size_t bytes) { return XXH3_64bits(data, bytes); }

struct RunningChecksum::State {
    XXH3_state_t xxh{};
};

RunningChecksum::RunningChecksum() : state_(std::make_unique<State>()) { XXH3_64bits_reset(&state_->xxh); }
RunningChecksum::~RunningChecksum() = default;

void RunningChecksum::add(const void* data, std::size_t bytes) { XXH3_64bits_update(&state_->xxh, data, bytes); }

std::uint64_t RunningChecksum::value() const { return XXH3_64bits_digest(&state_->xxh); }

}  // namespace pcm
