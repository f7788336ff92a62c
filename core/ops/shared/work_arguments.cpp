#include "pcm/ops/shared/work_arguments.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/text.h"

namespace pcm::ops {

void WorkArguments::declare(Arguments& arguments, std::uint64_t least)
{
    least_ = least;
    arguments.add("memory", memory)
        .letter('m')
        .as(ValueKind::bytes)
        .script("MemoryMB")
        .label("Memory")
        .help("Memory limit, such as 2G; " + std::to_string(least >> 20) + "M is the least. More makes it faster");
    declare_threads(arguments);
}

void WorkArguments::declare_threads(Arguments& arguments)
{
    arguments.add("threads", threads)
        .letter('t')
        .between(0, most_build_threads)
        .label("Threads")
        .advanced()
        .help("Number of threads; 0: one per processor")
        .without("one per processor");
}

void WorkArguments::declare(Arguments& arguments, std::uint64_t amount, const std::string& use)
{
    memory = amount;
    arguments.add("memory", memory)
        .letter('m')
        .as(ValueKind::bytes)
        .script("MemoryMB")
        .label("Memory")
        .help("Memory for " + use + ", such as 512M");
    declare_threads(arguments);
}

void WorkArguments::keep_memory_limit(const std::string& called) const
{
    if (memory < least_)
        throw Error(ErrorCode::invalid_argument, {},
                    "the memory limit is " + bytes_text(memory) + ": neighbours of a part of a cloud take " +
                        bytes_text(least_) + " at least",
                    "give " + called + " " + std::to_string(least_ >> 20) + "M or more");
    return_large_blocks();
}

void chunk_points_argument(Arguments& arguments, std::uint32_t& chunk_points)
{
    arguments.add("chunk_points", chunk_points)
        .between(least_chunk_points, most_chunk_points)
        .label("Points per chunk")
        .help("Maximum number of points in a chunk, the unit that is read and drawn")
        .advanced();
}

void note_memory(FilterReport& report, std::uint64_t limit)
{
    if (report.peak_memory_bytes > limit)
        report.notes.push_back("the memory limit of " + bytes_text(limit) +
                               " was exceeded: " + bytes_text(report.peak_memory_bytes) + " were taken");
}

}  // namespace pcm::ops
