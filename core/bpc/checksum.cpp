#include "pcm/bpc/checksum.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <new>

namespace pcm {

std::uint64_t checksum(const void* data, std::size_t bytes) { return XXH3_64bits(data, bytes); }

void RunningChecksum::Free::operator()(XXH3_state_s* state) const { XXH3_freeState(state); }

RunningChecksum::RunningChecksum() : state_(XXH3_createState())
{
    if (!state_) throw std::bad_alloc();
    XXH3_64bits_reset(state_.get());
}

void RunningChecksum::add(const void* data, std::size_t bytes) { XXH3_64bits_update(state_.get(), data, bytes); }

std::uint64_t RunningChecksum::value() const { return XXH3_64bits_digest(state_.get()); }

}  // namespace pcm
