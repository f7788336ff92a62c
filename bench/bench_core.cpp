// What a point costs on its way: read from LAS, built into a tree, decoded from it, found in the cache; compared with
// memcpy, which is what the machine can do. Run with --benchmark_repetitions=5
// --benchmark_enable_random_interleaving=true and compare medians.

#include "pcm/bpc/column_codec.h"
#include "pcm/build/builder.h"
#include "pcm/generate/scene.h"
#include "pcm/io/reader.h"
#include "pcm/point_cloud.h"

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t scene_points = 500000;

// One generated scene and its tree for all benchmarks of a run.
struct Scene {
    fs::path folder, las, tree;
    Scene()
    {
        std::string name = (fs::temp_directory_path() / "pcm-bench-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a temporary folder");
        folder = name;
        las = folder / "scene.las";
        tree = folder / "scene.pct";
        pcm::SceneOptions options;
        options.points = scene_points;
        pcm::generate_scene(las, options, false);
        pcm::build_tree({las}, tree);
    }
    ~Scene()
    {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }
};
const Scene& scene()
{
    static const Scene one;
    return one;
}

void points_per_second(benchmark::State& state, std::uint64_t points)
{
    state.SetItemsProcessed(static_cast<std::int64_t>(points) * state.iterations());
}

void Memcpy(benchmark::State& state)
{
    std::vector<char> from(64 << 20, 1), to(64 << 20);
    for (auto _ : state) {
        std::memcpy(to.data(), from.data(), from.size());
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(from.size()) * state.iterations());
}
BENCHMARK(Memcpy);

void ReadLas(benchmark::State& state)
{
    const fs::path las = scene().las;  // made before the clock starts
    pcm::PointBatch batch;
    for (auto _ : state) {
        const auto reader = pcm::open_reader(las);
        while (reader->read(batch, pcm::default_batch_points)) benchmark::DoNotOptimize(batch.size);
    }
    points_per_second(state, scene_points);
    state.SetBytesProcessed(static_cast<std::int64_t>(fs::file_size(scene().las)) * state.iterations());
}
BENCHMARK(ReadLas);

void BuildTree(benchmark::State& state)
{
    const fs::path output = scene().folder / "built.pct";
    pcm::BuildOptions options;
    options.overwrite = true;
    options.threads = static_cast<unsigned>(state.range(0));
    std::uint64_t bytes = 0;
    for (auto _ : state) bytes = pcm::build_tree({scene().las}, output, options).bytes;
    points_per_second(state, scene_points);
    state.counters["bytes_a_point"] = static_cast<double>(bytes) / scene_points;
}
BENCHMARK(BuildTree)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void DecodeChunks(benchmark::State& state)
{
    const auto tree = pcm::Tree::open(scene().tree);
    pcm::ColumnSet columns = pcm::ColumnSet::only_positions();
    if (state.range(0)) columns = pcm::ColumnSet::named(tree->info().schema, {"rgb"});
    for (auto _ : state)
        for (pcm::NodeId id = 0; id < tree->nodes().size(); ++id)
            benchmark::DoNotOptimize(tree->read_chunk(id, columns));
    points_per_second(state, scene_points);
    state.SetLabel(state.range(0) ? "positions and colours" : "positions");
}
BENCHMARK(DecodeChunks)->Arg(0)->Arg(1);

void WarmCacheHit(benchmark::State& state)
{
    const auto cloud = pcm::PointCloud::open(scene().tree);
    const auto columns = pcm::ColumnSet::only_positions();
    cloud->cache().get(0, columns);
    for (auto _ : state) benchmark::DoNotOptimize(cloud->cache().get(0, columns));
}
BENCHMARK(WarmCacheHit);

void Unpack(benchmark::State& state)
{
    const auto width = static_cast<int>(state.range(0));
    std::mt19937_64 random(1);
    std::vector<std::uint32_t> values(1 << 17);
    for (auto& v : values) v = static_cast<std::uint32_t>(random()) >> (32 - width);
    std::vector<std::byte> bytes;
    pcm::pack(values.data(), values.size(), bytes);
    const std::size_t size = bytes.size();
    bytes.resize(size + pcm::codec_slack);
    for (auto _ : state) {
        pcm::unpack(bytes.data(), size, values.data(), values.size(), {});
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(values.size()) * state.iterations());
}
BENCHMARK(Unpack)->Arg(4)->Arg(11)->Arg(20);

}  // namespace
