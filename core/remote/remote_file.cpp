#include "pcm/remote/remote_file.h"

#include "pcm/system/error.h"
#include "pcm/system/work_done.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t blocks_in_memory = 64;

BlockMemory& memory()
{
    static BlockMemory blocks(blocks_in_memory);
    return blocks;
}

}  // namespace

RemoteFile::RemoteFile(const std::filesystem::path& address, const BlockFolder& folder)
    : object_(address), folder_(folder)
{
}

RemoteFile::~RemoteFile() { memory().forget(this); }

// Where blocks of an earlier time are on disk, they serve if the file is still the one that they are of.
void RemoteFile::find_version() const
{
    std::call_once(asked_, [&] {
        const std::optional<RemoteVersion> last = folder_.last_version(path());
        if (!last) return;
        try {
            object_.assume(object_.ask());
        } catch (const Error& error) {
            if (!is_unreachable(error)) throw;
            object_.assume(*last);
        }
    });
}

std::uint64_t RemoteFile::size() const
{
    find_version();
    if (!object_.known()) memory().get(this, 0, 1, [&](const BlockMemory::Numbers& numbers) { return fetch(numbers); });
    return object_.known()->size;
}

bool RemoteFile::keeps_its_name() const
{
    try {
        const std::optional<RemoteVersion> known = object_.known();
        return !known || object_.ask() == *known;
    } catch (const Error&) {
        return false;
    }
}

std::vector<RemoteBlock> RemoteFile::download(const std::vector<std::uint64_t>& numbers) const
{
    const std::optional<RemoteVersion> before = object_.known();
    std::vector<std::vector<std::byte>> pieces;  // runs of blocks
    std::vector<RemoteRange> ranges;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t count = 1;
        while (i + count < numbers.size() && numbers[i + count] == numbers[i] + count && count < most_blocks_of_request)
            ++count;
        pieces.emplace_back(count * block_bytes);
        ranges.push_back({numbers[i] * block_bytes, pieces.back().size(), pieces.back().data(), 0});
        i += count;
    }
    object_.read(ranges);
    const std::optional<RemoteVersion> version = object_.known();
    if (!before) folder_.remember(path(), *version);
    std::vector<RemoteBlock> blocks;
    for (std::size_t piece = 0; piece < ranges.size(); ++piece) {
        const RemoteRange& range = ranges[piece];
        for (std::size_t at = 0; at < range.bytes; at += block_bytes) {
            const auto begin = pieces[piece].begin() + static_cast<std::ptrdiff_t>(std::min(at, range.got));
            const auto end =
                pieces[piece].begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(at + block_bytes, range.got));
            blocks.push_back(std::make_shared<const std::vector<std::byte>>(begin, end));
            if (!blocks.back()->empty())
                folder_.write(path(), *version, (range.offset + at) / block_bytes, *blocks.back());
        }
    }
    return blocks;
}

BlockMemory::Fetched RemoteFile::fetch(const BlockMemory::Numbers& numbers) const
{
    BlockMemory::Fetched fetched;
    BlockMemory::Numbers missing;
    const std::optional<RemoteVersion> version = object_.known();
    for (const std::uint64_t number : numbers) {
        auto kept = version ? folder_.read(path(), *version, number) : std::nullopt;
        if (kept)
            fetched.emplace_back(number, std::make_shared<const std::vector<std::byte>>(std::move(*kept)));
        else
            missing.push_back(number);
    }
    if (missing.empty()) return fetched;
    const std::uint64_t end = missing.back() + 1;
    memory().claim(this, end, end + blocks_ahead(missing.front(), end), missing);
    const std::vector<RemoteBlock> blocks = download(missing);
    for (std::size_t i = 0; i < missing.size(); ++i) fetched.emplace_back(missing[i], blocks[i]);
    return fetched;
}

// How many blocks to fetch after these, which are about to be asked for.
std::uint64_t RemoteFile::blocks_ahead(std::uint64_t first, std::uint64_t end) const
{
    const auto known = object_.known();
    const std::lock_guard lock(run_mutex_);
    const bool continues = run_blocks_ > 0 && first <= run_end_ && end > run_end_;
    const bool begins = !known && first == 0;
    if (begins) run_end_ = 0;
    run_blocks_ = begins      ? blocks_of_beginning
                  : continues ? std::min(2 * run_blocks_, most_blocks_of_request)
                              : end - first;
    run_end_ = std::max(end, begins || continues ? run_end_ + run_blocks_ : 0);
    if (known) run_end_ = std::min(run_end_, (known->size + block_bytes - 1) / block_bytes);
    return run_end_ > end ? run_end_ - end : 0;
}

std::size_t RemoteFile::read_some_at(void* to, std::size_t bytes, std::uint64_t offset) const
{
    find_version();
    if (const auto known = object_.known()) {
        if (offset >= known->size) return 0;
        bytes = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, known->size - offset));
    }
    if (bytes == 0) return 0;
    const std::uint64_t first = offset / block_bytes, last = (offset + bytes - 1) / block_bytes;
    const std::vector<RemoteBlock> blocks =
        memory().get(this, first, static_cast<std::size_t>(last - first + 1),
                     [&](const BlockMemory::Numbers& numbers) { return fetch(numbers); });
    std::size_t done = 0;
    for (const RemoteBlock& block : blocks) {
        const auto start = static_cast<std::size_t>(done == 0 ? offset % block_bytes : 0);
        if (start >= block->size()) break;
        const std::size_t part = std::min(bytes - done, block->size() - start);
        std::memcpy(static_cast<std::byte*>(to) + done, block->data() + start, part);
        done += part;
    }
    count_read(done);
    return done;
}

}  // namespace pcm
