// Memory for the columns of chunks: large, short-lived, allocated on one thread and freed on another. The C library's
// heaps return such blocks to the system late or never, so that a cache takes twice its bytes. These blocks are pages
// of their own, returned when freed except for a few kept for the next blocks.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace pcm {

// Blocks of at least `page_block_bytes`, aligned to pages. Any thread. take_pages() throws std::bad_alloc. give_pages()
// expects the size that was requested.
inline constexpr std::size_t page_block_bytes = std::size_t(64) << 10;
void* take_pages(std::size_t bytes);
void give_pages(void* block, std::size_t bytes) noexcept;
// Bytes of all blocks taken and not given back; 0 under a sanitizer, where the C library's heap is used instead.
std::size_t pages_in_use() noexcept;

template <class T>
struct PageAllocator {
    using value_type = T;
    PageAllocator() = default;
    template <class U>
    PageAllocator(const PageAllocator<U>&) noexcept
    {
    }
    T* allocate(std::size_t count)
    {
        if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
        const std::size_t bytes = count * sizeof(T);
        return static_cast<T*>(bytes < page_block_bytes ? ::operator new(bytes) : take_pages(bytes));
    }
    void deallocate(T* block, std::size_t count) noexcept
    {
        const std::size_t bytes = count * sizeof(T);
        if (bytes < page_block_bytes)
            ::operator delete(block);
        else
            give_pages(block, bytes);
    }
    template <class U>
    bool operator==(const PageAllocator<U>&) const noexcept
    {
        return true;
    }
    template <class U>
    bool operator!=(const PageAllocator<U>&) const noexcept
    {
        return false;
    }
};

template <class T>
using PageVector = std::vector<T, PageAllocator<T>>;

}  // namespace pcm
