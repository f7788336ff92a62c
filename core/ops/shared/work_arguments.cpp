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
    arguments.add("threads", threads)
        .letter('t')
        .between(0, most_build_threads)
        .label("Threads")
        .help("Number of threads; 0: one per processor")
        .without("one per processor");
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

void note_memory(FilterReport& report, std::uint64_t limit)
{
    if (report.peak_memory_bytes > limit)
        report.notes.push_back("the memory limit of " + bytes_text(limit) +
                               " was exceeded: " + bytes_text(report.peak_memory_bytes) + " were taken");
}

}  // namespace pcm::ops
