// Fits of one shape by our estimators, PCL's and CGAL's, in turns, with exact truth: a line of JSON for each fit.
// bench/fit/run.py runs it over scenes and reports.
#include "bench/fit/methods.h"
#include "bench/fit/verdict_scenes.h"
#include "bench/sweep/sweep.h"
#include "pcm/fit/pcl_fit.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <malloc.h>
#include <ctime>
#include <fstream>
#include <iostream>
#include <string>

namespace {

using namespace pcm;
using namespace pcm::bench;
using nlohmann::json;

double cpu_seconds()
{
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Memory of this process, in MB: "VmRSS:" now, "VmHWM:" the maximum since forget_peak().
double memory_mb(const std::string& name)
{
    std::ifstream status("/proc/self/status");
    std::string word;
    double kilobytes = 0;
    while (status >> word)
        if (word == name && status >> kilobytes) break;
    return kilobytes / 1e3;
}
void forget_peak()
{
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";
}

json errors_of(const FitScene& scene, const Shape& shape)
{
    const FitError error = error_of(scene, shape);
    return {{"surface", error.surface}, {"angle", error.angle}, {"position", error.position}, {"radius", error.radius}};
}

void print(const FitScene& scene, const std::string& name, std::uint32_t iterations, double cpu,
           const MethodResult& result)
{
    json line{{"seed", scene.options.seed},  {"method", name},
              {"iterations", iterations},    {"cpu_ms", 1e3 * cpu},
              {"found", bool(result.shape)}, {"samples", result.samples}};
    if (result.shape) line.update(errors_of(scene, *result.shape));
    if (!result.verdict.empty()) {
        line["verdict"] = result.verdict;
        line["issue"] = result.issue;
        line["threshold"] = result.threshold;
        line["inliers"] = result.inliers;
        // JSON has no infinity.
        if (std::isfinite(result.radius_sigma)) line["radius_sigma"] = result.radius_sigma;
    }
    std::cout << line.dump() << '\n';
}

struct Arguments {
    std::string kind = "plane";
    FitSceneOptions scene;
    ShapeFitOptions fit;
    double degrees = 360;
    bool without_normals = false, memory = false;
    std::uint64_t seeds = 100, first_seed = 1;
    std::vector<std::string> methods, sweeps;
    std::vector<std::uint32_t> iterations{10000};
    std::vector<double> offset;
};

void add_options(CLI::App& app, Arguments& a)
{
    app.add_option("--kind", a.kind, "plane, cylinder, sphere, cone");
    app.add_option("--points", a.scene.points, "of the scene, outliers included");
    app.add_option("--outliers", a.scene.outliers, "their share, 0 to 1");
    app.add_option("--sigma", a.scene.sigma, "noise along the normal, m");
    app.add_option("--radius", a.scene.radius, "of cylinder, sphere and the cone's end, m");
    app.add_option("--size", a.scene.size, "side of the plane, length of cylinder and cone, m");
    app.add_option("--arc", a.degrees, "of cylinder and cone, degrees");
    app.add_option("--patch", a.scene.patch, "diameter of the sphere's part that has points, m; 0: all of it");
    app.add_option("--offset", a.offset, "X Y Z of the scene, m")->expected(3);
    app.add_flag("--without-normals", a.without_normals, "estimating them is part of what is measured");
    app.add_option("--threshold", a.fit.threshold, "m; 0: our automatic one");
    app.add_option("--probability", a.fit.probability, "that a sample without outliers was drawn");
    app.add_option("--seconds", a.fit.seconds, "time budget; 0: none");
    app.add_option("--iterations", a.iterations, "maximum number of samples; several: each in turn");
    app.add_option("--seeds", a.seeds, "scenes");
    app.add_option("--first-seed", a.first_seed, "of the scenes");
    app.add_option("--methods", a.methods, "names, all of them by default; 'list' prints them");
    app.add_flag("--memory", a.memory, "instead of an oracle's: the last line is the peak memory of the fits, in MB");
    app.add_option("--sweep", a.sweeps,
                   "tuned values, NAME or NAME=FROM:TO:STEPS: verdicts on scenes of --first-seed and --seeds; 'list' "
                   "prints the names");
}

void run(Arguments& a)
{
    const auto kind = shape_kind(a.kind);
    if (!kind || *kind == ShapeKind::torus) throw std::invalid_argument("no scenes of the kind " + a.kind);
    a.scene.kind = a.fit.kind = *kind;
    a.scene.arc = a.degrees * pi / 180;
    a.scene.with_normals = !a.without_normals;
    if (!a.offset.empty()) a.scene.offset = {a.offset[0], a.offset[1], a.offset[2]};
    std::vector<Method> methods = fit_methods();
    if (!a.methods.empty()) {
        std::vector<Method> chosen;
        for (const std::string& name : a.methods)
            for (const Method& method : methods)
                if (method.name == name) chosen.push_back(method);
        methods = chosen;
    }
    double before = 0;
    for (std::uint64_t i = 0; i < a.seeds; ++i) {
        a.scene.seed = a.first_seed + i;
        const FitScene scene = make_scene(a.scene);
        MethodResult result;
        if (!a.memory) {
            const double begin = cpu_seconds();
            result.shape = oracle(scene);
            print(scene, "oracle", 0, cpu_seconds() - begin, result);
        }
        forget_peak();
        before = memory_mb("VmRSS:");
        for (const std::uint32_t iterations : a.iterations) {
            a.fit.iterations = iterations;
            a.fit.seed = a.scene.seed;
            // Each is first in its turn.
            for (std::size_t k = 0; k < methods.size(); ++k) {
                const Method& method = methods[(k + i) % methods.size()];
                const double start = cpu_seconds();
                result = method.run(scene, a.fit);
                print(scene, method.name, iterations, cpu_seconds() - start, result);
            }
        }
    }
    if (a.memory) std::cout << json{{"taken_mb", memory_mb("VmHWM:") - before}}.dump() << '\n';
}

}  // namespace

int main(int argc, char** argv)
try {
    Arguments arguments;
    CLI::App app("Error against run time of fits: ours, PCL's, CGAL's");
    add_options(app, arguments);
    CLI11_PARSE(app, argc, argv);
    if (arguments.methods == std::vector<std::string>{"list"}) {
        for (const Method& method : fit_methods()) std::cout << method.name << '\n';
        if (!why_no_pcl().empty()) std::cerr << "PCL is not here: " << why_no_pcl() << '\n';
        return 0;
    }
    if (!arguments.sweeps.empty()) {
        const std::vector<Sweep> sweeps = read_sweeps(arguments.sweeps);
        if (sweeps.empty()) return 0;
        const auto scenes = verdict_scenes(arguments.first_seed, arguments.seeds);
        for (const Sweep& sweep : sweeps)
            print_sweep(sweep, heads_of_verdicts(), [&] { return cells_of(judge(scenes)); });
        return 0;
    }
    run(arguments);
    return 0;
} catch (const std::exception& failure) {
    std::cerr << "bench_fit: " << failure.what() << '\n';
    return 1;
}
