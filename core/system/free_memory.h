#pragma once

namespace pcm {

// Gives memory that was freed back to the system, as far as the C library keeps it: its heaps keep what lies between
// blocks that are still in use, so that work in many parts takes more with each of them. Some milliseconds: after a
// part that used many megabytes, not after each block. Any thread. Does nothing with C libraries that cannot.
void return_free_memory() noexcept;

}  // namespace pcm
