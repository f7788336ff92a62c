// Blocks of files behind addresses in memory: a few, used last, of all files together. A block that one thread is
// fetching is awaited by the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace pcm {

using RemoteBlock = std::shared_ptr<const std::vector<std::byte>>;

// Any number of threads.
class BlockMemory {
public:
    explicit BlockMemory(std::size_t most_blocks);
    ~BlockMemory();

    // Fetches the blocks with these numbers, and others of the same file that it has claimed. What it throws goes to
    // its caller; others that wait for the blocks fetch them themselves.
    using Numbers = std::vector<std::uint64_t>;
    using Fetched = std::vector<std::pair<std::uint64_t, RemoteBlock>>;
    using Fetch = std::function<Fetched(const Numbers& numbers)>;

    // The blocks [first, first + count) of the file that `file` stands for.
    std::vector<RemoteBlock> get(const void* file, std::uint64_t first, std::size_t count, const Fetch& fetch);
    // For Fetch: adds to `numbers` those of [first, end) that are not in memory and that no thread is fetching.
    void claim(const void* file, std::uint64_t first, std::uint64_t end, Numbers& numbers);
    // Forgets the blocks of a file that no thread reads.
    void forget(const void* file);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace pcm
