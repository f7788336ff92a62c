#include "pcm/io/las/las_records.h"

#include "pcm/io/las/laz_layout.h"
#include "pcm/system/error.h"

#ifdef PCM_HAVE_DECODERS
#include "pcm/io/las/laz_chunks.h"
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

std::unique_ptr<RecordSource> laz_records(const File& file, std::uint64_t, const Header& header,
                                          const std::vector<Vlr>&, unsigned, std::vector<std::string>&)
{
    throw Error(
        ErrorCode::unsupported, file.path(),
        "this is LAZ (compressed LAS 1." + std::to_string(header.version_minor) + ", point format " +
            std::to_string(header.format) + "), which this build does not support",
        "install Rust's cargo, at least 1.87 (Debian: package cargo-web), and build again; or convert the file to "
        "LAS first, for example with laszip or PDAL");
}

#else

namespace {

namespace vlr_at = laz::vlr;

constexpr std::size_t stream_buffer_bytes = std::size_t{1} << 20;
constexpr std::size_t most_chunks = std::size_t{1} << 21;
// For a file that is decoded by several threads.
constexpr std::uint64_t most_ahead_bytes = std::uint64_t{112} << 20;
constexpr std::uint64_t chunk_table_pointer_bytes = 8;

// Decodes chunk by chunk in pieces: chunks of any size.
class LazStream final : public RecordSource {
public:
    explicit LazStream(Chunks chunks) : chunks_(std::move(chunks)) { from_byte_ = chunks_.begin; }

    RecordSpan next(std::size_t most) override
    {
        if (!decoder_) open();
        const std::size_t stride = chunks_.record_length;
        const auto left = static_cast<std::size_t>(std::min<std::uint64_t>(most, chunk_count_ - in_chunk_));
        const std::size_t count = std::clamp<std::size_t>(stream_buffer_bytes / stride, 1, left);
        if (buffer_.size() < count * stride) buffer_.resize(count * stride);
        chunks_.decode(decoder_.get(), buffer_.data(), count, chunk_, from_byte_, next_ - in_chunk_);
        next_ += count;
        in_chunk_ += count;
        if (in_chunk_ == chunk_count_) {
            from_byte_ = pcm_laz_decoder_position(decoder_.get());
            decoder_.reset();
            ++chunk_;
        }
        return {buffer_.data(), count};
    }

private:
    void open()
    {
        in_chunk_ = 0;
        std::uint64_t to_byte = chunks_.end;
        if (chunks_.has_table()) {
            const auto i = static_cast<std::size_t>(chunk_);
            from_byte_ = chunks_.starts[i];
            to_byte = chunks_.starts[i + 1];
            chunk_count_ = chunks_.first_points[i + 1] - chunks_.first_points[i];
        } else {
            const bool variable = chunks_.chunk_points == laz::variable_chunks;
            const std::uint64_t left = chunks_.points - next_;
            chunk_count_ = chunks_.compressor == laz::Compressor::pointwise ? left
                           : variable                                       ? 0
                                      : std::min<std::uint64_t>(chunks_.chunk_points, left);
        }
        decoder_ = chunks_.open(chunk_, from_byte_, to_byte, next_, chunk_count_);
    }

    Chunks chunks_;
    Decoder decoder_;
    std::vector<std::byte> buffer_;
    std::uint64_t next_ = 0;  // point
    std::uint64_t chunk_ = 0, from_byte_ = 0, chunk_count_ = 0, in_chunk_ = 0;
};

// Decodes whole chunks ahead on several threads. The threads start with the first read.
class LazCrew final : public RecordSource {
public:
    LazCrew(Chunks chunks, unsigned threads) : chunks_(std::move(chunks)), thread_count_(threads), slots_(threads + 1)
    {
    }
    ~LazCrew() override
    {
        {
            const std::lock_guard lock(mutex_);
            stopped_ = true;
        }
        wake_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }

    RecordSpan next(std::size_t most) override
    {
        if (threads_.empty()) start_threads();
        Slot& slot = slots_[consumed_ % slots_.size()];
        {
            std::unique_lock lock(mutex_);
            if (slot.ready && given_ == slot.count) {  // the caller has used all of it
                slot.ready = false;
                ++consumed_;
                given_ = 0;
                wake_.notify_all();
            }
        }
        Slot& now = slots_[consumed_ % slots_.size()];
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [&] { return now.ready; });
        }
        if (now.error) std::rethrow_exception(now.error);
        const std::size_t count = std::min(most, now.count - given_);
        const std::byte* records = now.records.data() + given_ * chunks_.record_length;
        given_ += count;
        return {records, count};
    }

private:
    struct Slot {
        std::vector<std::byte> records;
        std::size_t count = 0;
        std::exception_ptr error;
        bool ready = false;
    };

    // Where the system gives fewer threads, those do the work.
    void start_threads()
    {
        try {
            for (unsigned i = 0; i < thread_count_; ++i) threads_.emplace_back([this] { work(); });
        } catch (const std::system_error& error) {
            if (threads_.empty())
                throw Error(ErrorCode::io, chunks_.file->path(),
                            std::string("no thread can be started to decode LAZ: ") + error.what());
        }
    }

    void work()
    {
        for (;;) {
            std::size_t chunk;
            {
                std::unique_lock lock(mutex_);
                wake_.wait(lock, [&] {
                    return stopped_ || started_ == chunks_.count() || started_ < consumed_ + slots_.size();
                });
                if (stopped_ || started_ == chunks_.count()) return;
                chunk = started_++;
            }
            Slot& slot = slots_[chunk % slots_.size()];
            try {
                decode(chunk, slot);
            } catch (...) {
                slot.error = std::current_exception();
            }
            {
                const std::lock_guard lock(mutex_);
                slot.ready = true;
            }
            wake_.notify_all();
        }
    }

    void decode(std::size_t chunk, Slot& slot) const
    {
        std::uint64_t count = chunks_.first_points[chunk + 1] - chunks_.first_points[chunk];
        slot.count = static_cast<std::size_t>(count);
        if (slot.records.size() < slot.count * chunks_.record_length)
            slot.records.resize(slot.count * chunks_.record_length);
        const std::uint64_t from = chunks_.starts[chunk], first = chunks_.first_points[chunk];
        const Decoder decoder = chunks_.open(chunk, from, chunks_.starts[chunk + 1], first, count);
        chunks_.decode(decoder.get(), slot.records.data(), slot.count, chunk, from, first);
    }

    Chunks chunks_;
    unsigned thread_count_;
    std::size_t given_ = 0;  // records already returned of the current slot
    std::mutex mutex_;
    std::condition_variable wake_;
    // Guarded by mutex_. Chunk i is in slot i % slots: started_ - consumed_ never exceeds the number of slots.
    std::vector<Slot> slots_;
    std::size_t started_ = 0, consumed_ = 0;
    bool stopped_ = false;
    std::vector<std::thread> threads_;
};

class LazOpener {
public:
    LazOpener(const File& file, std::uint64_t file_size, const Header& header, std::vector<std::string>& notes)
        : file_(file), file_size_(file_size), header_(header), notes_(notes)
    {
    }

    std::unique_ptr<RecordSource> open(const std::vector<Vlr>& vlrs, unsigned threads)
    {
        read_vlr(vlrs);
        chunks_.file = &file_;
        chunks_.record_length = header_.record_length;
        chunks_.coder_bytes = coder_bytes();
        chunks_.points = header_.points;
        chunks_.begin = header_.point_offset;
        chunks_.end = file_size_;
        if (header_.evlr_count && header_.evlr_start > header_.point_offset)
            chunks_.end = std::min(file_size_, header_.evlr_start);
        if (header_.points && chunks_.compressor != laz::Compressor::pointwise) find_chunks();
        const unsigned crew = chunks_.has_table() ? threads_in_bounds(thread_count(threads)) : 1;
        if (crew > 1) return std::make_unique<LazCrew>(std::move(chunks_), crew);
        return std::make_unique<LazStream>(std::move(chunks_));
    }

private:
    [[noreturn]] void fail(ErrorCode code, const std::string& what, const std::string& hint = {}) const
    {
        throw Error(code, file_.path(), what, hint);
    }

    void read_vlr(const std::vector<Vlr>& vlrs);
    void check_items(const Vlr& vlr, std::size_t count) const;
    void find_chunks();
    std::uint64_t table_position() const;
    std::string read_table(std::uint64_t position);
    unsigned threads_in_bounds(unsigned wanted) const;
    std::size_t coder_bytes() const
    {
        return laz::coder_bytes(header_.format, header_.record_length - record_bytes[header_.format]);
    }

    const File& file_;
    std::uint64_t file_size_;
    const Header& header_;
    std::vector<std::string>& notes_;
    Chunks chunks_;
};

// The place in the file, for the beginning of a message.
std::string byte_of(const Vlr& vlr, std::size_t in_value)
{
    return "byte " + std::to_string(vlr.offset + in_value) + ": ";
}

void LazOpener::read_vlr(const std::vector<Vlr>& vlrs)
{
    const auto vlr = std::find_if(vlrs.begin(), vlrs.end(), [](const Vlr& v) {
        return v.user_id == laszip_user_id && v.id == laszip_record_id && !v.extended;
    });
    if (vlr == vlrs.end())
        fail(ErrorCode::bad_format, "the header marks the points as compressed (LAZ), but there is no VLR '" +
                                        std::string(laszip_user_id) + "' " + std::to_string(laszip_record_id) +
                                        " that describes the compression");
    const std::size_t size = vlr->value.size();
    const std::size_t count = size >= vlr_at::items ? load<std::uint16_t>(&vlr->value[vlr_at::item_count]) : 0;
    if (size < vlr_at::items + count * vlr_at::item_bytes)
        fail(ErrorCode::bad_format, "the laszip VLR at byte " + std::to_string(vlr->offset) + " has " +
                                        std::to_string(size) + " bytes, at least " +
                                        std::to_string(vlr_at::items + count * vlr_at::item_bytes) + " were expected");
    const auto compressor = load<std::uint16_t>(&vlr->value[vlr_at::compressor]);
    if (compressor < 1 || compressor > 3)
        fail(ErrorCode::unsupported, byte_of(*vlr, vlr_at::compressor) + "the laszip VLR names compressor " +
                                         std::to_string(compressor) + "; 1 to 3 can be read");
    const auto coder = load<std::uint16_t>(&vlr->value[vlr_at::coder]);
    if (coder != 0)
        fail(ErrorCode::unsupported, byte_of(*vlr, vlr_at::coder) + "the laszip VLR names coder " +
                                         std::to_string(coder) + "; 0, the arithmetic coder, can be read");
    chunks_.vlr = vlr->value;
    chunks_.compressor = static_cast<laz::Compressor>(compressor);
    chunks_.chunk_points = load<std::uint32_t>(&vlr->value[vlr_at::chunk_points]);
    if (chunks_.chunk_points == 0) chunks_.chunk_points = laz::variable_chunks;
    check_items(*vlr, count);
}

void LazOpener::check_items(const Vlr& vlr, std::size_t count) const
{
    const std::size_t extra = header_.record_length - record_bytes[header_.format];
    const std::vector<laz::Item> expected = laz::items_of(header_.format, extra);
    if (count != expected.size())
        fail(ErrorCode::bad_format, byte_of(vlr, vlr_at::item_count) + "the laszip VLR lists " + std::to_string(count) +
                                        " items; records of " + std::to_string(header_.record_length) +
                                        " bytes of point format " + std::to_string(header_.format) + " have " +
                                        std::to_string(expected.size()));
    const bool layered = is_extended(header_.format);
    for (std::size_t i = 0; i < count; ++i) {
        const std::byte* from = &vlr.value[vlr_at::items + i * vlr_at::item_bytes];
        const laz::Item item{load<std::uint16_t>(from), load<std::uint16_t>(from + 2), load<std::uint16_t>(from + 4)};
        const std::string name = byte_of(vlr, vlr_at::items + i * vlr_at::item_bytes) + "item " +
                                 std::to_string(i + 1) + " of the laszip VLR";
        if (item.type != expected[i].type || item.size != expected[i].size)
            fail(ErrorCode::bad_format, name + " is of type " + std::to_string(item.type) + " and " +
                                            std::to_string(item.size) + " bytes; type " +
                                            std::to_string(expected[i].type) + " and " +
                                            std::to_string(expected[i].size) + " bytes were expected");
        const unsigned least = layered ? 3 : 1;
        if (item.version < least || item.version > least + 1)
            fail(ErrorCode::unsupported, name + " is compressed by version " + std::to_string(item.version) + "; " +
                                             std::to_string(least) + " and " + std::to_string(least + 1) +
                                             " can be read");
    }
    if ((chunks_.compressor == laz::Compressor::layered_chunked) != layered)
        fail(ErrorCode::bad_format, byte_of(vlr, vlr_at::compressor) +
                                        "the laszip VLR names a compressor that is not for point format " +
                                        std::to_string(header_.format));
    if (laz::coder_bytes(header_.format, extra) > laz::most_coder_bytes)
        fail(ErrorCode::unsupported,
             "the points have " + std::to_string(extra) + " extra bytes, too many to decompress in bounded memory");
}

void LazOpener::find_chunks()
{
    chunks_.begin += chunk_table_pointer_bytes;
    if (chunks_.begin > file_size_)
        fail(ErrorCode::truncated, "the header places the points at byte " + std::to_string(header_.point_offset) +
                                       ", the file ends at byte " + std::to_string(file_size_));
    const std::uint64_t position = table_position();
    std::string wrong = position ? read_table(position) : "missing";
    if (wrong.empty()) return;
    chunks_.starts.clear();
    chunks_.first_points.clear();
    if (position && position < chunks_.end) chunks_.end = position;
    if (chunks_.chunk_points == laz::variable_chunks && !chunks_.layered())
        fail(ErrorCode::corrupt,
             "the chunk table is " + wrong + "; without it chunks of variable size cannot be found");
    add_note(notes_, "the chunk table is " + wrong + "; the chunks are read in order without it");
}

// 0 when the file has none.
std::uint64_t LazOpener::table_position() const
{
    std::array<std::byte, 8> bytes;
    file_.read_at(bytes.data(), bytes.size(), header_.point_offset);
    auto position = load<std::int64_t>(bytes.data());
    if (position == -1) {  // written as a stream: at the end of the file
        file_.read_at(bytes.data(), bytes.size(), file_size_ - bytes.size());
        position = load<std::int64_t>(bytes.data());
        if (position < static_cast<std::int64_t>(chunks_.begin) ||
            static_cast<std::uint64_t>(position) > file_size_ - bytes.size())
            return 0;
    }
    if (position < static_cast<std::int64_t>(chunks_.begin)) return 0;
    const auto start = static_cast<std::uint64_t>(position);
    if (start > file_size_ || file_size_ - start < 8)
        fail(ErrorCode::truncated, "the header places the chunk table at byte " + std::to_string(start) +
                                       ", the file ends at byte " + std::to_string(file_size_));
    return start;
}

// Empty, or what is wrong with the table.
std::string LazOpener::read_table(std::uint64_t position)
{
    std::array<std::byte, 8> head;
    file_.read_at(head.data(), head.size(), position);
    const std::uint64_t count = load<std::uint32_t>(&head[4]);
    const std::uint64_t data_bytes = position - chunks_.begin;
    const bool variable = chunks_.chunk_points == laz::variable_chunks;
    if (load<std::uint32_t>(head.data()) != 0)
        return "of the unknown version " + std::to_string(load<std::uint32_t>(head.data()));
    // Every chunk begins with an uncompressed point.
    if (count > data_bytes / header_.record_length + 1)
        return "damaged (" + std::to_string(count) + " chunks in " + std::to_string(data_bytes) + " bytes)";
    if (count > most_chunks)
        fail(ErrorCode::unsupported, "the file has " + std::to_string(count) + " chunks; at most " +
                                         std::to_string(most_chunks) + " can be read");
    std::vector<std::uint64_t> points(static_cast<std::size_t>(count)), bytes(points.size());
    std::array<char, laz_message_bytes> message{};
    if (pcm_laz_chunk_table_read(file_.descriptor(), position, file_size_, variable, points.data(), bytes.data(),
                                 points.size(), message.data(), message.size()) != 0) {
        if (message[0] == 0) chunks_.throw_no_memory();
        return "damaged (" + std::string(message.data()) + ")";
    }

    chunks_.starts = {chunks_.begin};
    chunks_.first_points = {0};
    for (std::size_t i = 0; i < points.size() && chunks_.first_points.back() < header_.points; ++i) {
        const std::uint64_t left = header_.points - chunks_.first_points.back();
        const std::uint64_t here = variable ? points[i] : chunks_.chunk_points;
        const std::uint64_t end = chunks_.starts.back() + bytes[i];
        if (end > position) return "damaged (chunk " + std::to_string(i + 1) + " overlaps the table)";
        if (here == 0) {
            if (bytes[i]) return "damaged (chunk " + std::to_string(i + 1) + " has bytes, but no points)";
            continue;
        }
        chunks_.starts.push_back(end);
        chunks_.first_points.push_back(chunks_.first_points.back() + std::min(left, here));
        if (here > left && variable)
            return "damaged (it has more points than the " + std::to_string(header_.points) + " of the header)";
    }
    if (chunks_.first_points.back() < header_.points)
        fail(ErrorCode::truncated, "the header promises " + std::to_string(header_.points) +
                                       " points; the chunks hold at most " +
                                       std::to_string(chunks_.first_points.back()));
    return {};
}

unsigned LazOpener::threads_in_bounds(unsigned wanted) const
{
    std::uint64_t most_points = 0, most_bytes = 0;
    for (std::size_t i = 0; i < chunks_.count(); ++i) {
        most_points = std::max(most_points, chunks_.first_points[i + 1] - chunks_.first_points[i]);
        most_bytes = std::max(most_bytes, chunks_.starts[i + 1] - chunks_.starts[i]);
    }
    if (most_points > most_ahead_bytes / header_.record_length || most_bytes > most_ahead_bytes) return 1;
    const std::uint64_t decoded = most_points * header_.record_length;
    const std::uint64_t each = decoded + (chunks_.layered() ? most_bytes : 0) + chunks_.coder_bytes;
    if (each + decoded > most_ahead_bytes) return 1;
    const std::uint64_t fit = (most_ahead_bytes - decoded) / each;
    return static_cast<unsigned>(std::min<std::uint64_t>({wanted, fit, chunks_.count()}));
}

}  // namespace

std::unique_ptr<RecordSource> laz_records(const File& file, std::uint64_t file_size, const Header& header,
                                          const std::vector<Vlr>& vlrs, unsigned threads,
                                          std::vector<std::string>& notes)
{
    return LazOpener(file, file_size, header, notes).open(vlrs, threads);
}

#endif

}  // namespace pcm::las
