#include "pcm/system/page_allocator.h"

#include <sys/mman.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>

// The sanitizers check the C library's heap only.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PCM_PLAIN_HEAP
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define PCM_PLAIN_HEAP
#endif
#endif

namespace pcm {

#ifdef PCM_PLAIN_HEAP

std::size_t pages_in_use() noexcept { return 0; }
void* take_pages(std::size_t bytes) { return ::operator new(bytes); }
void give_pages(void* block, std::size_t) noexcept { ::operator delete(block); }

#else

namespace {

std::atomic<std::size_t> in_use{0};

// Sizes are rounded up to few classes, eight between two powers of two, so that a freed block often fits the next one.
std::size_t size_class(std::size_t bytes)
{
    std::size_t step = page_block_bytes / 8;
    while (step * 16 < bytes) step *= 2;
    return (bytes + step - 1) / step * step;
}

class Pool {
public:
    void* take(std::size_t bytes)
    {
        const std::size_t size = size_class(bytes);
        in_use += size;
        {
            const std::lock_guard lock(mutex_);
            const auto found = free_.find(size);
            if (found != free_.end()) {
                void* const block = found->second;
                free_.erase(found);
                kept_ -= size;
                return block;
            }
        }
        void* const block = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (block != MAP_FAILED) return block;
        in_use -= size;
        throw std::bad_alloc();
    }
    void give(void* block, std::size_t bytes) noexcept
    {
        const std::size_t size = size_class(bytes);
        in_use -= size;
        try {
            const std::lock_guard lock(mutex_);
            if (kept_ + size <= most_kept) {
                free_.emplace(size, block);
                kept_ += size;
                return;
            }
            // Blocks of a size that is not requested any more make room for this one.
            if (!free_.empty() && free_.count(size) == 0) {
                const auto other = std::prev(free_.end());
                ::munmap(other->second, other->first);
                kept_ -= other->first;
                free_.erase(other);
            }
        } catch (const std::bad_alloc&) {
        }
        ::munmap(block, size);
    }

private:
    static constexpr std::size_t most_kept = std::size_t(32) << 20;
    std::mutex mutex_;
    std::multimap<std::size_t, void*> free_;
    std::size_t kept_ = 0;
};

// Never destroyed: columns may outlive other static objects.
Pool& pool()
{
    static Pool* const pool = new Pool;
    return *pool;
}

}  // namespace

std::size_t pages_in_use() noexcept { return in_use; }
void* take_pages(std::size_t bytes) { return pool().take(bytes); }
void give_pages(void* block, std::size_t bytes) noexcept { pool().give(block, bytes); }

#endif

}  // namespace pcm
