#include "pcm/ops/shared/cache_report.h"

#include "pcm/system/text.h"

#include <cstdio>

namespace pcm::ops {

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

void put_cache_lines(Result& result, const L2Statistics& s)
{
    const std::uint64_t misses = s.compulsory_misses + s.capacity_misses;
    const double asked = static_cast<double>(s.hits + misses);
    char share[16];
    std::snprintf(share, sizeof share, "%.1f", asked > 0 ? 100 * static_cast<double>(s.hits) / asked : 0.0);
    result.line("cache       " + grouped(s.hits) + " hits and " + grouped(misses) + " misses (" + share +
                " % hits): " + grouped(s.compulsory_misses) + " compulsory, " + grouped(s.capacity_misses) +
                " capacity; " + grouped(s.forced_misses) + " forced");
    result.line("loaded      " + bytes_text(s.loaded_bytes) + " in " + time_text(s.load_seconds) +
                ", summed over threads; a load took " + time_text(s.load_times.quantile(0.5)) + " (median), " +
                time_text(s.load_times.quantile(0.99)) + " (99th percentile)");
    result.line("held        " + bytes_text(s.resident_bytes) + " in " + grouped(s.resident_chunks) +
                " chunks at the end; " + grouped(s.evictions) + " evicted");
    if (s.written_chunks || s.failed_writes)
        result.line("written     " + bytes_text(s.written_bytes) + " of changed columns in " +
                    grouped(s.written_chunks) + " chunks, in " + time_text(s.write_seconds));
}

}  // namespace pcm::ops
