// Blocks of files behind addresses in memory: a few, used last, of all files together. A block that one thread is
// fetching is awaited by the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace pcm {

using RemoteBlock = std::shared_ptr<const std::vector<std::byte>>;

// Any number of threads.
class BlockMemory {
public:
    explicit BlockMemory(std::size_t most_blocks);
    ~BlockMemory();

    // Fetches the blocks with these numbers, all of one file, in their order. What it throws goes to its caller; others
    // that wait for the blocks fetch them themselves.
    using Fetch = std::function<std::vector<RemoteBlock>(const std::vector<std::uint64_t>& numbers)>;

    // The blocks [first, first + count) of the file that `file` stands for.
    std::vector<RemoteBlock> get(const void* file, std::uint64_t first, std::size_t count, const Fetch& fetch);
    // Forgets the blocks of a file that no thread reads.
    void forget(const void* file);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pcm
