// Radii of all points of a tree on the processor and by compute shaders: time of each, and how far they are apart. The
// tree on disk is not changed.
//   bench_gpu_radii TREE --neighbours 16 --rounds 3
#include "pcm/gl/compute/gpu_radii.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/offscreen/offscreen.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Radii = std::vector<std::vector<float>>;  // of each node's points

// Of all threads.
double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Arguments {
    std::string tree;
    std::size_t neighbours = 16, rounds = 3;
    std::uint64_t l1_mb = 512, l2_mb = 2048;
    unsigned threads = 0;
    bool normals = false, no_cpu = false;
};

class RadiiVisitor final : public pcm::NeighbourhoodVisitor {
public:
    RadiiVisitor(const pcm::Schema& schema, bool normals, Radii& radii) : schema_(schema), radii_(radii)
    {
        if (normals) normal_ = schema.find(pcm::attribute_name::normal);
    }
    void visit(const pcm::NeighbourhoodUnit& unit, const pcm::Neighbourhoods& some) override
    {
        for (std::size_t i = 0; i < some.size(); ++i) {
            const auto& part = unit.part_of(some.number(i));
            const std::uint32_t index = part.indices[some.number(i) - part.first];
            pcm::Vec3d n{};
            if (normal_) {
                for (std::uint32_t c = 0; c < 3; ++c)
                    n[c] = part.chunk->attributes[*normal_]->value(index, c) * schema_[*normal_].scale +
                           schema_[*normal_].offset;
                const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
                for (double& c : n) c = length > 0 ? c / length : 0;
            }
            double largest = 0;
            for (std::size_t j = 0; j < some.count(i); ++j) {
                const double d[3] = {some.dx(i)[j], some.dy(i)[j], some.dz(i)[j]};
                const double along = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
                double square = 0;
                for (std::size_t a = 0; a < 3; ++a) square += (d[a] - n[a] * along) * (d[a] - n[a] * along);
                largest = std::max(largest, square);
            }
            radii_[part.node][index] = static_cast<float>(std::sqrt(largest));
        }
    }

private:
    const pcm::Schema& schema_;
    Radii& radii_;
    std::optional<std::size_t> normal_;
};

Radii empty_radii(const pcm::Tree& tree)
{
    Radii radii;
    for (const pcm::Node& node : tree.nodes()) radii.emplace_back(node.points, 0.0f);
    return radii;
}

double on_processor(pcm::PointCloud& cloud, const Arguments& arguments, Radii& radii)
{
    const auto start = Clock::now();
    pcm::NeighbourhoodOptions options;
    options.neighbours = arguments.neighbours;
    options.threads = arguments.threads;
    const pcm::Schema& schema = cloud.info().schema;
    if (arguments.normals) options.columns.attributes.set(*schema.find(pcm::attribute_name::normal));
    pcm::for_each_neighbourhood(cloud.cache(), options,
                                [&] { return std::make_unique<RadiiVisitor>(schema, arguments.normals, radii); });
    return seconds_since(start);
}

double on_device(const std::shared_ptr<pcm::PointCloud>& cloud, const Arguments& arguments, pcm::GpuRadiiReport& report)
{
    pcm::L1Options options;
    options.capacity_bytes = arguments.l1_mb << 20;
    const auto l1 = std::make_shared<pcm::L1Cache>(options);
    const auto start = Clock::now();
    pcm::GpuRadiiOptions radii;
    radii.neighbours = arguments.neighbours;
    radii.normals = arguments.normals;
    report = pcm::compute_radii_on_gpu(cloud, l1, radii);
    const double seconds = seconds_since(start);
    l1->release();
    return seconds;
}

// Whether the point's neighbour number k and the one after it are equally far, but for the rounding of doubles. Then
// either may be taken, and radii across normals depend on which one is.
bool has_tie(pcm::PointCloud& cloud, pcm::NodeId node, std::uint32_t index, std::size_t k)
{
    const auto place = [&](pcm::NodeId id, std::uint32_t i) {
        return cloud.cache().get(id, pcm::ColumnSet::only_positions())->positions->grid(i);
    };
    const pcm::Vec3i at = place(node, index);
    const pcm::Grid& grid = cloud.info().grid;
    std::vector<double> squares;
    for (const pcm::Neighbour& found : cloud.nearest(grid.to_source(at), k + 10).points) {
        const pcm::Vec3i other = place(found.node, found.index);
        double d[3];
        for (std::size_t a = 0; a < 3; ++a) d[a] = static_cast<double>(other[a] - at[a]) * grid.scale[a];
        squares.push_back((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
    }
    std::sort(squares.begin(), squares.end());  // the first is the point itself
    return squares.size() > k + 1 && squares[k + 1] <= squares[k] * (1 + 1e-14);
}

struct Differences {
    double largest = 0;    // relative, without ties
    std::size_t ties = 0;  // points that differ by more than 1e-5 because of one
};

Differences differences(pcm::PointCloud& cloud, const Radii& radii, std::size_t k)
{
    const std::size_t place = *cloud.info().schema.find(pcm::attribute_name::radius);
    pcm::ColumnSet columns;
    columns.positions = false;
    columns.attributes.set(place);
    Differences result;
    for (pcm::NodeId id = 0; id < radii.size(); ++id) {
        if (radii[id].empty()) continue;
        const auto chunk = cloud.cache().get(id, columns);
        for (std::uint32_t i = 0; i < radii[id].size(); ++i) {
            const double exact = static_cast<double>(radii[id][i]), r = chunk->attributes[place]->value(i);
            const double difference = exact == r ? 0 : std::abs(r - exact) / std::max(exact, r);
            if (difference > 1e-5 && has_tie(cloud, id, i, k))
                ++result.ties;
            else
                result.largest = std::max(result.largest, difference);
        }
    }
    return result;
}

double median_of(std::vector<double> values)
{
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

int run(const Arguments& arguments)
{
    const pcm::Offscreen screen;
    pcm::L2Options l2;
    l2.capacity_bytes = arguments.l2_mb << 20;
    const auto cloud = pcm::PointCloud::open(arguments.tree, l2, pcm::Access::write);
    Radii radii = empty_radii(*cloud->tree());
    std::vector<double> cpu, gpu, cpu_work, gpu_work;
    pcm::GpuRadiiReport report;
    for (std::size_t round = 0; round < arguments.rounds; ++round) {
        double before = processor_seconds();
        if (!arguments.no_cpu) {
            cpu.push_back(on_processor(*cloud, arguments, radii));
            cpu_work.push_back(processor_seconds() - before);
        }
        before = processor_seconds();
        gpu.push_back(on_device(cloud, arguments, report));
        gpu_work.push_back(processor_seconds() - before);
    }
    nlohmann::ordered_json json;
    json["tree"] = arguments.tree;
    json["points"] = cloud->info().points;
    json["nodes"] = cloud->tree()->nodes().size();
    json["neighbours"] = arguments.neighbours;
    json["normals"] = arguments.normals;
    json["device"] = screen.renderer();
    json["gpu_seconds"] = median_of(gpu);
    json["gpu_processor_seconds"] = median_of(gpu_work);  // nearly all of a software renderer's work
    json["batches"] = report.batches;
    json["dispatches"] = report.dispatches;
    if (!arguments.no_cpu) {
        const Differences found = differences(*cloud, radii, arguments.neighbours);
        json["cpu_seconds"] = median_of(cpu);
        json["cpu_processor_seconds"] = median_of(cpu_work);
        json["largest_difference"] = found.largest;
        json["ties"] = found.ties;
    }
    std::printf("%s\n", json.dump().c_str());
    cloud->abandon();
    return 0;
}

}  // namespace

int main(int argc, char** argv)
try {
    Arguments arguments;
    CLI::App app("Radii on the processor and by compute shaders");
    app.add_option("tree", arguments.tree)->required();
    app.add_option("-k,--neighbours", arguments.neighbours)->capture_default_str();
    app.add_option("--rounds", arguments.rounds, "Of both, taking turns; the medians are printed")
        ->capture_default_str();
    app.add_option("--l1", arguments.l1_mb, "Video memory, MB")->capture_default_str();
    app.add_option("--l2", arguments.l2_mb, "Cache, MB")->capture_default_str();
    app.add_option("-t,--threads", arguments.threads, "Of the processor (default: one each)");
    app.add_flag("--normals", arguments.normals, "Measure across the points' normals");
    app.add_flag("--no-cpu", arguments.no_cpu, "Only by compute shaders");
    CLI11_PARSE(app, argc, argv);
    return run(arguments);
} catch (const std::exception& error) {
    return std::fprintf(stderr, "bench_gpu_radii: %s\n", error.what()), 1;
}
