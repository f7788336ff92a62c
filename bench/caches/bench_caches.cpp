// Measures one configuration of the caches on one tree and prints one line of JSON; run.py starts it, each time as a
// process of its own.
//   bench_caches replay|scan|hits|neighbours|decoding|disk TREE [options]     see --help
//   bench_caches about                                                        what it draws with
#include "bench/caches/modes.h"

#include "pcm/build/builder.h"
#include "pcm/cache/l2_cache.h"
#include "pcm/tree/tree.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <functional>

namespace {

using namespace pcm::bench;

struct Arguments {
    Settings settings;
    double l1_mb = 512, l2_mb = 512, block_mb = 2;
    std::string storage = "warm", size = "1280x720";

    Settings get()
    {
        constexpr double megabyte = 1 << 20;
        settings.l1_bytes = static_cast<std::uint64_t>(l1_mb * megabyte);
        settings.l2_bytes = static_cast<std::uint64_t>(l2_mb * megabyte);
        settings.block_bytes = static_cast<std::uint32_t>(block_mb * megabyte);
        settings.cold = storage == "cold";
        if (std::sscanf(size.c_str(), "%dx%d", &settings.width, &settings.height) != 2 || settings.width < 1 ||
            settings.height < 1)
            throw CLI::ValidationError("--size", "WIDTHxHEIGHT in pixels was expected, not " + size);
        return settings;
    }
};

// What the library takes when nobody says otherwise.
void put_defaults(Row& row)
{
    constexpr double megabyte = 1 << 20;
    row["chunk_points"] = pcm::BuildOptions().chunk_points;
    row["l2_mb"] = static_cast<double>(pcm::L2Options().capacity_bytes) / megabyte;
    row["l2_threads"] = pcm::L2Options().threads;
    put_l1_defaults(row);
}

void add_l2(CLI::App& app, Arguments& a)
{
    app.add_option("--l2-mb", a.l2_mb, "Capacity of L2, MiB")->capture_default_str()->check(CLI::Range(1.0, 1e6));
    app.add_option("--l2-threads", a.settings.l2_threads, "Threads that load for L2")
        ->capture_default_str()
        ->check(CLI::Range(1, 64));
}

void add_replay(CLI::App& app, Arguments& a)
{
    Settings& s = a.settings;
    app.add_option("--path", s.path, "Camera path, JSON")->required()->check(CLI::ExistingFile);
    app.add_option("--passes", s.passes = 2, "Number of passes along the path")
        ->capture_default_str()
        ->check(CLI::Range(1, 100));
    app.add_option("--size", a.size, "Size of the picture, pixels")->capture_default_str();
    app.add_option("--pace-ms", s.pace_ms = 33, "A frame takes at least this long")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
    app.add_option("--rest-s", s.longest_rest_s = 30, "Longest wait for a complete picture")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    app.add_option("--point-budget", s.point_budget = 2'000'000, "Maximum points of a frame")->capture_default_str();
    app.add_option("--target-px", s.target_px = 1.4, "Maximum distance of points on screen")->capture_default_str();
    app.add_option("--upload-ms", s.upload_ms = 3, "Time of a frame for uploads")->capture_default_str();
    app.add_option("--l1-mb", a.l1_mb, "Capacity of L1, MiB")->capture_default_str()->check(CLI::Range(1.0, 1e6));
    app.add_option("--block-mb", a.block_mb, "Size of a VBO, MiB, 1 to 4")->capture_default_str();
    app.add_option("--policy", s.policy = "lru", "What L1 drops")
        ->capture_default_str()
        ->check(CLI::IsMember({"lru", "naive"}));
    app.add_option("--container", s.container = "hash", "Where L1 finds its entries")
        ->capture_default_str()
        ->check(CLI::IsMember({"hash", "ordered"}));
}

// What the command line asks for.
struct Chosen {
    std::string mode;
    std::function<void(const Settings&, Row&)> measure;
};

void add_modes(CLI::App& app, Arguments& arguments, Chosen& chosen)
{
    Settings& s = arguments.settings;
    const auto add = [&](const char* name, const char* what, void (*function)(const Settings&, Row&)) {
        CLI::App* const command = app.add_subcommand(name, what);
        command->add_option("tree", s.tree, "Tree folder")->required()->check(CLI::ExistingDirectory);
        command
            ->add_option("--storage", arguments.storage,
                         "cold: the system's cache of the tree's files is dropped before")
            ->capture_default_str()
            ->check(CLI::IsMember({"cold", "warm"}));
        command->callback([&chosen, name, function] {
            chosen.mode = name;
            chosen.measure = function;
        });
        return command;
    };
    add("disk", "What the disk gives of the tree's files, in MB/s", measure_disk);
    add("decoding", "Every chunk on one thread, past the cache", measure_decoding);
    CLI::App* const scan = add("scan", "Every point through L2, twice", measure_scan);
    scan->add_option("--reads", s.reads, "Chunks that are read at once")
        ->capture_default_str()
        ->check(CLI::Range(1, 64));
    CLI::App* const hits = add("hits", "Chunks that L2 holds, by one thread and by several", measure_hits);
    hits->add_option("--timed", s.timed_hits, "Hits that are timed one by one")
        ->capture_default_str()
        ->check(CLI::Range(1.0, 1e9));
    hits->add_option("--seconds", s.seconds = 0.2, "That each throughput is measured for, five times")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    CLI::App* const neighbours =
        add("neighbours", "Radii of points: mean distance of their nearest neighbours", measure_neighbours);
    neighbours->add_option("--points", s.queries, "That a radius is estimated of")
        ->capture_default_str()
        ->check(CLI::Range(1.0, 1e9));
    neighbours->add_option("--neighbours", s.neighbours = 8, "Neighbours of a point")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    neighbours->add_option("--threads", s.threads, "That search")->capture_default_str()->check(CLI::Range(1, 64));
    for (CLI::App* const command : {scan, hits, neighbours}) add_l2(*command, arguments);
    CLI::App* const replay = add("replay", "A camera path, drawn offscreen", measure_replay);
    add_l2(*replay, arguments);
    add_replay(*replay, arguments);
    app.add_subcommand("about", "What replay draws with, and the defaults of the library")->callback([&chosen] {
        chosen.mode = "about";
    });
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Measures the caches of a point cloud tree; prints one line of JSON.");
    app.require_subcommand(1);
    Arguments arguments;
    Chosen chosen;
    add_modes(app, arguments, chosen);
    CLI11_PARSE(app, argc, argv);
    try {
        Row row;
        if (chosen.mode == "about") {
            std::string why;
            row["gl"] = gl_renderer(why);
            if (!why.empty()) row["why_not"] = why;
            put_defaults(row);
        } else {
            const Settings settings = arguments.get();
            row["mode"] = chosen.mode;
            row["points"] = pcm::Tree::open(settings.tree)->info().points;
            chosen.measure(settings, row);
        }
        std::printf("%s\n", row.dump().c_str());
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_caches: %s\n", error.what());
        return 1;
    }
}
