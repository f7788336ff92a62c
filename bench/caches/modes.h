// What bench_caches measures. Each function opens the tree itself, in the state that the settings ask for, and adds its
// figures to the row. They throw pcm::Error and std::runtime_error.
#pragma once

#include "bench/caches/row.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace pcm::bench {

struct Settings {
    std::filesystem::path tree;
    bool cold = false;  // the system's cache of the tree's files is dropped before, else they are read before
    std::uint64_t l2_bytes = 0;
    unsigned l2_threads = 1;             // threads that load for the cache
    unsigned reads = 8;                  // chunks that a scan reads at once
    unsigned threads = 1;                // threads that ask for neighbours
    std::uint64_t queries = 20'000;      // number of neighbour queries
    std::uint64_t timed_hits = 200'000;  // one by one
    unsigned neighbours = 0;             // neighbours of a query
    double seconds = 0;                  // time for measuring a throughput

    std::filesystem::path path;  // file of the camera path
    unsigned passes = 1;         // passes along the path
    int width = 0, height = 0;
    double pace_ms = 0;         // a frame takes at least this long, as on a display
    double longest_rest_s = 0;  // a picture that is not complete by then is given up
    std::uint64_t point_budget = 0;
    double target_px = 0;
    double upload_ms = 0;
    std::uint64_t l1_bytes = 0;
    std::uint32_t block_bytes = 0;
    std::string policy, container;
};

void prepare_storage(const Settings& settings, Row& row);

void measure_disk(const Settings& settings, Row& row);        // what the disk gives of the tree's files
void measure_decoding(const Settings& settings, Row& row);    // reading every chunk on one thread, past the cache
void measure_scan(const Settings& settings, Row& row);        // every point with all attributes, through L2; then again
void measure_hits(const Settings& settings, Row& row);        // chunks that L2 holds, asked for at random
void measure_neighbours(const Settings& settings, Row& row);  // radii: mean distance of the nearest neighbours
void measure_replay(const Settings& settings, Row& row);      // a camera path, drawn

// The renderer that measure_replay() would use; empty, with the reason, when there is none.
std::string gl_renderer(std::string& why);

// Defaults of L1 and of the renderer; none in builds that cannot draw offscreen.
void put_l1_defaults(Row& row);

}  // namespace pcm::bench
