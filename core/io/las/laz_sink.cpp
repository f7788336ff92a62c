#include "pcm/io/las/las_sink.h"

#include "pcm/io/las/laz_layout.h"
#include "pcm/system/error.h"

#ifdef PCM_HAVE_DECODERS
#include "pcm/decoders/decoders.h"
#include "pcm/threads/thread_count.h"
#endif

#include <algorithm>
#include <array>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

namespace pcm::las {

#ifndef PCM_HAVE_DECODERS

std::unique_ptr<RecordSink> laz_sink(OutputFile& out, std::size_t, std::vector<std::byte>, unsigned)
{
    throw Error(ErrorCode::unsupported, out.path(), "this build does not support LAZ");
}

std::vector<std::byte> make_laszip_vlr(const std::filesystem::path& path, unsigned, std::size_t)
{
    throw Error(ErrorCode::unsupported, path, "this build does not support LAZ",
                "install Rust's cargo, at least 1.87 (Debian: package cargo-web), and build again; or write LAS");
}

#else

namespace {

namespace vlr_at = laz::vlr;

constexpr std::size_t message_bytes = 512;
constexpr std::size_t most_chunk_bytes = std::size_t{8} << 20;
constexpr std::size_t most_pending_bytes = std::size_t{112} << 20;

struct FreeBytes {
    void operator()(pcm_laz_bytes* bytes) const { pcm_laz_bytes_free(bytes); }
};
using Bytes = std::unique_ptr<pcm_laz_bytes, FreeBytes>;

// Chunk i is filled and compressed in slot i % slots, and written in order.
class LazSink final : public RecordSink {
public:
    LazSink(OutputFile& out, std::size_t record_length, std::vector<std::byte> vlr, std::size_t coder_bytes,
            unsigned threads)
        : out_(out),
          record_length_(record_length),
          coder_bytes_(coder_bytes),
          vlr_(std::move(vlr)),
          chunk_points_(load<std::uint32_t>(&vlr_[vlr_at::chunk_points])),
          thread_count_(threads),
          slots_(threads > 1 ? threads + 1 : 1)
    {
        table_pointer_at_ = out_.size();
        const std::int64_t unknown = -1;
        out_.append(&unknown, sizeof unknown);
    }
    ~LazSink() override { stop(); }

    RecordRoom room(std::size_t most) override
    {
        if (filled_ == chunk_points_) end_chunk();
        if (filled_ == 0) begin_chunk();
        const std::size_t block = std::max<std::size_t>(1, 16384 / record_length_);
        const std::size_t count = std::min({most, block, chunk_points_ - filled_});
        std::byte* const records = slot(submitted_).records.data() + filled_ * record_length_;
        std::memset(records, 0, count * record_length_);
        filled_ += count;
        return {records, count};
    }

    void finish() override
    {
        if (filled_) end_chunk();
        while (written_ < submitted_) write_one();
        stop();
        const auto table = static_cast<std::int64_t>(out_.size());
        std::array<char, message_bytes> message{};
        const Bytes bytes(
            pcm_laz_encode_chunk_table(chunk_bytes_.data(), chunk_bytes_.size(), message.data(), message.size()));
        if (!bytes) fail(message.data());
        out_.append(pcm_laz_bytes_data(bytes.get()), pcm_laz_bytes_size(bytes.get()));
        out_.rewrite(&table, sizeof table, table_pointer_at_);
    }

private:
    struct Slot {
        std::vector<std::byte> records;
        std::size_t size = 0;  // bytes of the records to compress
        Bytes compressed;
        std::exception_ptr error;
        bool done = false;
    };

    // `message`: see decoders.h.
    [[noreturn]] void fail(const std::string& message) const
    {
        if (message.empty())
            throw Error(ErrorCode::io, out_.path(), "the system has too little memory to compress the points",
                        "close other programs, or use fewer threads");
        throw Error(ErrorCode::unsupported, out_.path(), "the points cannot be compressed: " + message,
                    "write LAS instead");
    }
    Slot& slot(std::uint64_t chunk) { return slots_[static_cast<std::size_t>(chunk % slots_.size())]; }

    void begin_chunk()
    {
        while (submitted_ - written_ >= slots_.size()) write_one();
        slot(submitted_).records.resize(chunk_points_ * record_length_);
    }

    void end_chunk()
    {
        Slot& full = slot(submitted_);
        full.size = filled_ * record_length_;
        full.done = false;
        filled_ = 0;
        if (thread_count_ <= 1) {
            compress(full);
            full.done = true;
            ++submitted_;
            return write_one();
        }
        {
            const std::lock_guard lock(mutex_);
            ++submitted_;
        }
        wake_.notify_all();
        // Starts one more thread per chunk, up to the maximum: small files need few.
        if (threads_.size() < thread_count_) start_thread();
    }

    // Where the system gives fewer threads, those do the work.
    void start_thread()
    {
        try {
            threads_.emplace_back([this] { work(); });
        } catch (const std::system_error& error) {
            if (threads_.empty())
                throw Error(ErrorCode::io, out_.path(),
                            std::string("no thread can be started to compress LAZ: ") + error.what());
        }
    }

    void compress(Slot& slot) const
    {
        std::array<char, message_bytes> message{};
        slot.compressed.reset(pcm_laz_encode_chunk(
            reinterpret_cast<const std::uint8_t*>(vlr_.data()), vlr_.size(), coder_bytes_,
            reinterpret_cast<const std::uint8_t*>(slot.records.data()), slot.size, message.data(), message.size()));
        if (!slot.compressed) fail(message.data());
    }

    void write_one()
    {
        Slot& next = slot(written_);
        if (thread_count_ > 1) {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [&] { return next.done; });
        }
        if (next.error) std::rethrow_exception(next.error);
        const std::size_t size = pcm_laz_bytes_size(next.compressed.get());
        out_.append(pcm_laz_bytes_data(next.compressed.get()), size);
        chunk_bytes_.push_back(size);
        next.compressed.reset();
        ++written_;
    }

    void work()
    {
        for (;;) {
            Slot* mine;
            {
                std::unique_lock lock(mutex_);
                wake_.wait(lock, [&] { return stopped_ || begun_ < submitted_; });
                if (stopped_) return;
                mine = &slot(begun_++);
            }
            try {
                compress(*mine);
            } catch (...) {
                mine->error = std::current_exception();
            }
            {
                const std::lock_guard lock(mutex_);
                mine->done = true;
            }
            wake_.notify_all();
        }
    }

    void stop()
    {
        {
            const std::lock_guard lock(mutex_);
            stopped_ = true;
        }
        wake_.notify_all();
        for (std::thread& thread : threads_) thread.join();
        threads_.clear();
    }

    OutputFile& out_;
    std::size_t record_length_;
    std::size_t coder_bytes_;
    std::vector<std::byte> vlr_;
    std::size_t chunk_points_;
    unsigned thread_count_;
    std::uint64_t table_pointer_at_ = 0;
    std::size_t filled_ = 0;                  // records in the chunk that is being filled
    std::vector<std::uint64_t> chunk_bytes_;  // sizes of the written ones
    std::uint64_t written_ = 0;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::vector<Slot> slots_;
    std::uint64_t submitted_ = 0, begun_ = 0;  // under mutex_
    bool stopped_ = false;
    std::vector<std::thread> threads_;
};

std::uint32_t chunk_points_of(std::size_t record_length)
{
    return static_cast<std::uint32_t>(
        std::clamp<std::size_t>(most_chunk_bytes / record_length, 1, laz::default_chunk_points));
}

}  // namespace

std::unique_ptr<RecordSink> laz_sink(OutputFile& out, std::size_t record_length, std::vector<std::byte> laszip_vlr,
                                     unsigned threads)
{
    // A chunk, its compressed bytes (at worst about as many) and the coder's models, for each thread and one more
    // chunk.
    const std::size_t items = load<std::uint16_t>(&laszip_vlr[vlr_at::item_count]);
    const std::byte* last = &laszip_vlr[vlr_at::items + (items - 1) * vlr_at::item_bytes];
    const auto type = load<std::uint16_t>(last);
    const std::size_t extra = type == laz::byte || type == laz::byte14 ? load<std::uint16_t>(last + 2) : std::size_t{0};
    const unsigned format = load<std::uint16_t>(&laszip_vlr[vlr_at::compressor]) == 3 ? 6 : 0;
    const std::size_t coder_bytes = laz::coder_bytes(format, extra);
    const std::size_t each = 2 * chunk_points_of(record_length) * record_length + coder_bytes;
    const std::size_t wanted = thread_count(threads);
    const std::size_t fit = std::max<std::size_t>(1, most_pending_bytes / each);
    return std::make_unique<LazSink>(out, record_length, std::move(laszip_vlr), coder_bytes,
                                     static_cast<unsigned>(std::min(wanted, fit)));
}

std::vector<std::byte> make_laszip_vlr(const std::filesystem::path& path, unsigned format, std::size_t record_length)
{
    const std::size_t extra = record_length - record_bytes[format];
    if (laz::coder_bytes(format, extra) > laz::most_coder_bytes)
        throw Error(ErrorCode::unsupported, path,
                    "the points have " + std::to_string(extra) + " extra bytes, too many to compress in bounded memory",
                    "write LAS instead, or fewer attributes");
    const std::vector<laz::Item> items = laz::items_of(format, extra);
    std::vector<std::byte> vlr(vlr_at::items + items.size() * vlr_at::item_bytes);
    const auto compressor = is_extended(format) ? laz::Compressor::layered_chunked : laz::Compressor::pointwise_chunked;
    store(&vlr[vlr_at::compressor], static_cast<std::uint16_t>(compressor));
    store(&vlr[vlr_at::version], std::uint8_t{3});
    store(&vlr[vlr_at::version + 1], std::uint8_t{4});
    store(&vlr[vlr_at::version + 2], std::uint16_t{3});
    store(&vlr[vlr_at::chunk_points], chunk_points_of(record_length));
    store(&vlr[vlr_at::special_evlrs], std::int64_t{-1});
    store(&vlr[vlr_at::special_evlrs + 8], std::int64_t{-1});
    store(&vlr[vlr_at::item_count], static_cast<std::uint16_t>(items.size()));
    for (std::size_t i = 0; i < items.size(); ++i) {
        std::byte* to = &vlr[vlr_at::items + i * vlr_at::item_bytes];
        store(to, items[i].type);
        store(to + 2, items[i].size);
        store(to + 4, items[i].version);
    }
    return vlr;
}

#endif

}  // namespace pcm::las
