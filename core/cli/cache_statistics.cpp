#include "pcm/cli/cache_statistics.h"

#include <cstdio>

namespace pcm::cli {

Json cache_json(const L2Statistics& s)
{
    Json json;
    json["hits"] = s.hits;
    json["compulsory_misses"] = s.compulsory_misses;
    json["capacity_misses"] = s.capacity_misses;
    json["forced_misses"] = s.forced_misses;
    json["evictions"] = s.evictions;
    json["failed_loads"] = s.failed_loads;
    json["loaded_bytes"] = s.loaded_bytes;
    json["load_seconds"] = s.load_seconds;
    json["load_seconds_median"] = s.load_times.quantile(0.5);
    json["load_seconds_99"] = s.load_times.quantile(0.99);
    json["load_times"] = s.load_times.buckets;
    json["resident_bytes"] = s.resident_bytes;
    json["resident_chunks"] = s.resident_chunks;
    json["written_chunks"] = s.written_chunks;
    json["written_bytes"] = s.written_bytes;
    json["failed_writes"] = s.failed_writes;
    json["write_seconds"] = s.write_seconds;
    return json;
}

void print(const L2Statistics& s)
{
    const std::uint64_t misses = s.compulsory_misses + s.capacity_misses;
    const double asked = static_cast<double>(s.hits + misses);
    std::printf("cache       %s hits and %s misses (%.1f %% hits): %s compulsory, %s capacity; %s forced\n",
                grouped(s.hits).c_str(), grouped(misses).c_str(),
                asked > 0 ? 100 * static_cast<double>(s.hits) / asked : 0.0, grouped(s.compulsory_misses).c_str(),
                grouped(s.capacity_misses).c_str(), grouped(s.forced_misses).c_str());
    std::printf("loaded      %s in %s, summed over threads; a load took %s (median), %s (99th percentile)\n",
                bytes_text(s.loaded_bytes).c_str(), time_text(s.load_seconds).c_str(),
                time_text(s.load_times.quantile(0.5)).c_str(), time_text(s.load_times.quantile(0.99)).c_str());
    std::printf("held        %s in %s chunks at the end; %s evicted\n", bytes_text(s.resident_bytes).c_str(),
                grouped(s.resident_chunks).c_str(), grouped(s.evictions).c_str());
    if (s.written_chunks || s.failed_writes)
        std::printf("written     %s of changed columns in %s chunks, in %s\n", bytes_text(s.written_bytes).c_str(),
                    grouped(s.written_chunks).c_str(), time_text(s.write_seconds).c_str());
}

}  // namespace pcm::cli
