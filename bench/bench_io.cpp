// How fast our readers are, and what the machine allows. Driven by bench/io/run.py; lines (fields separated by tabs):
//     read PATH THREADS     all points into batches
//     memcpy PATH           the file's bytes, from memory to memory
//     disk PATH             the file's bytes from the disk, past the cache of the operating system
//     compare PATH FILE     the largest distance of the doubles x y z in FILE from the positions of PATH, on any axis
//     clock                 seconds = the core's clock in GHz, by a chain of dependent multiplications
#include "bench/io/serve.h"
#include "pcm/io/reader.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>

namespace {

using pcm::bench::Answer;
using pcm::bench::Stopwatch;

std::uint64_t values_of(const pcm::FileInfo& info)
{
    std::uint64_t values = 3;
    for (const pcm::Attribute& attribute : info.schema) values += attribute.components;
    return values;
}

Answer read(const std::string& path, unsigned threads)
{
    Answer answer;
    pcm::ReadOptions options;
    options.threads = threads;
    const Stopwatch watch;
    const auto reader = pcm::open_reader(path, options);
    for (pcm::PointBatch batch; reader->read(batch, pcm::default_batch_points);) answer.points += batch.size;
    watch.stop(answer);
    answer.values = values_of(reader->info());
    return answer;
}

std::vector<char> bytes_of(const std::string& path)
{
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw std::runtime_error("cannot read " + path);
    std::vector<char> bytes(static_cast<std::size_t>(file.tellg()));
    file.seekg(0);
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return bytes;
}

Answer copy(const std::string& path)
{
    const std::vector<char> from = bytes_of(path);
    std::vector<char> to(from.size());  // touched: no page is new while the clock runs
    Answer answer;
    const Stopwatch watch;
    if (!from.empty()) std::memcpy(to.data(), from.data(), from.size());
    watch.stop(answer);
    if (!from.empty() && to.back() != from.back()) throw std::runtime_error("the copy is another");
    return answer;
}

Answer from_disk(const std::string& path)
{
    constexpr std::size_t block = std::size_t{4} << 20;
    const std::unique_ptr<void, void (*)(void*)> buffer(std::aligned_alloc(4096, block), std::free);
    const int file = open(path.c_str(), O_RDONLY | O_DIRECT | O_CLOEXEC);
    if (file < 0) throw std::runtime_error("the file system has no direct reading");
    Answer answer;
    const Stopwatch watch;
    ssize_t got = 0;
    while ((got = ::read(file, buffer.get(), block)) > 0) {
    }
    watch.stop(answer);
    close(file);
    if (got < 0) throw std::runtime_error("reading from the disk failed");
    return answer;
}

Answer compare(const std::string& path, const std::string& positions)
{
    std::ifstream file(positions, std::ios::binary);
    if (!file) throw std::runtime_error("cannot read " + positions);
    const auto reader = pcm::open_reader(path);
    Answer answer;
    std::vector<double> other;
    for (pcm::PointBatch batch; reader->read(batch, pcm::default_batch_points);) {
        other.resize(batch.size * 3);
        const auto bytes = static_cast<std::streamsize>(other.size() * sizeof(double));
        if (!file.read(reinterpret_cast<char*>(other.data()), bytes))
            throw std::runtime_error("fewer points than the file has");
        for (std::size_t i = 0; i < batch.size; ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                const double ours =
                    batch.gridded ? reader->info().grid->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i];
                const double distance = std::abs(ours - other[i * 3 + a]);
                if (distance > answer.error || std::isnan(distance) != std::isnan(ours)) answer.error = distance;
            }
        answer.points += batch.size;
    }
    if (file.peek() != std::ifstream::traits_type::eof()) throw std::runtime_error("more points than the file has");
    return answer;
}

// A 64-bit multiplication that waits for the one before it takes 3 cycles on every x86-64 since 2008 and on current ARM
// cores.
Answer clock_rate()
{
    constexpr std::uint64_t steps = 100'000'000;
    volatile std::uint64_t seed = 3;
    std::uint64_t value = seed;
    const std::uint64_t factor = seed;
    const Stopwatch watch;
    for (std::uint64_t i = 0; i < steps; ++i) value *= factor;
    Answer answer;
    watch.stop(answer);
    seed = value;
    answer.seconds = 3.0 * static_cast<double>(steps) / answer.cpu_seconds * 1e-9;
    return answer;
}

Answer work(const std::vector<std::string>& fields)
{
    if (fields[0] == "clock") return clock_rate();
    if (fields.size() < 2) throw std::runtime_error("which file?");
    if (fields[0] == "memcpy") return copy(fields[1]);
    if (fields[0] == "disk") return from_disk(fields[1]);
    if (fields[0] == "read" && fields.size() == 3) return read(fields[1], static_cast<unsigned>(std::stoul(fields[2])));
    if (fields[0] == "compare" && fields.size() == 3) return compare(fields[1], fields[2]);
    throw std::runtime_error("unknown line: " + fields[0]);
}

}  // namespace

int main() { return pcm::bench::serve(work); }
