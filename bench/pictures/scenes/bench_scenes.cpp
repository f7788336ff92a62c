// Scenes with known pictures; truth.py starts it.
//   bench_scenes about                                                    the scenes and their views, as JSON
//   bench_scenes scan SCENE --points N -o FILE --labels FILE              its cloud, in colours and in labels
//   bench_scenes truth SCENE --path FILE --out FOLDER --size WxH          its true pictures along a camera path:
//       0001-colours.png, 0001-labels.png, 0001-facts.png (true_picture.h), ...
#include "bench/caches/row.h"
#include "bench/pictures/scenes/scan.h"
#include "bench/pictures/scenes/true_picture.h"

#include "pcm/system/error.h"
#include "pcm/threads/thread_count.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <map>

namespace {

using namespace pcm;
using namespace pcm::bench;

struct Arguments {
    std::string scene, path, size = "960x720";
    std::filesystem::path cloud, labels, out;
    std::uint64_t points = 1000000, seed = 1;
    unsigned threads = 0;
};

Scene scene_of(const Arguments& a)
{
    for (const SceneRow& row : all_scenes)
        if (a.scene == row.name) return row.make(a.seed);
    throw std::runtime_error("there is no scene " + a.scene);
}

Row about(const Arguments& a)
{
    Row row;
    for (const SceneRow& each : all_scenes) {
        const Scene scene = each.make(a.seed);
        for (const View& view : scene.views)
            row["views"].push_back({{"name", view.name},
                                    {"scene", scene.name},
                                    {"eye", scene_origin + view.eye},
                                    {"target", scene_origin + view.target},
                                    {"angle", view.angle}});
    }
    return row;
}

Row make_clouds(const Arguments& a)
{
    const Scene scene = scene_of(a);
    const Eye eye(scene);
    const std::vector<ScanPoint> points = scan(scene, eye, a.points, thread_count(a.threads));
    write_cloud(a.cloud, points, false);
    write_cloud(a.labels, points, true);
    return {{"points", points.size()}, {"shapes", scene.site.shapes.size()}};
}

Row draw_truth(const Arguments& a)
{
    int width = 0, height = 0;
    if (std::sscanf(a.size.c_str(), "%5dx%5d", &width, &height) != 2 || width < 1 || height < 1)
        throw std::runtime_error("--size: WIDTHxHEIGHT in pixels was expected, not " + a.size);
    const Scene scene = scene_of(a);
    const Eye eye(scene);
    std::filesystem::create_directories(a.out);
    std::vector<CameraFrame> frames = CameraPath::read(a.path).frames;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        if (!frames[i].angle) throw std::runtime_error("the frames of " + a.path + " must be perspective");
        frames[i].eye = frames[i].eye - scene_origin;
        frames[i].target = frames[i].target - scene_origin;
        const TruePicture picture = true_picture(eye, frames[i], width, height, thread_count(a.threads));
        char number[16];
        std::snprintf(number, sizeof number, "%04zu", i + 1);
        const std::string name = number;
        write_png(a.out / (name + "-colours.png"), picture.colours);
        write_png(a.out / (name + "-labels.png"), picture.labels);
        write_png(a.out / (name + "-facts.png"), picture.facts);
    }
    return {{"pictures", frames.size()}};
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Scenes whose true pictures are known; prints one line of JSON.");
    app.require_subcommand(1);
    Arguments a;
    app.add_option("--seed", a.seed, "Seed of the scenes")->capture_default_str();
    CLI::App* const list = app.add_subcommand("about", "The scenes and their views");
    CLI::App* const clouds = app.add_subcommand("scan", "The cloud of a scene, in colours and in labels");
    CLI::App* const truth = app.add_subcommand("truth", "True pictures along a camera path");
    for (CLI::App* const command : {clouds, truth}) {
        command->add_option("scene", a.scene, "Name of the scene")->required();
        command->add_option("--threads", a.threads, "0: one per processor")->capture_default_str();
    }
    clouds->add_option("--points", a.points, "About this number of points")
        ->capture_default_str()
        ->check(CLI::Range(1000, 1000000000));
    clouds->add_option("-o", a.cloud, "File in colours")->required();
    clouds->add_option("--labels", a.labels, "File in labels")->required();
    truth->add_option("--path", a.path, "Camera path, JSON")->required()->check(CLI::ExistingFile);
    truth->add_option("--out", a.out, "Folder for the pictures")->required();
    truth->add_option("--size", a.size, "Size of the pictures, pixels")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        const Row row = list->parsed() ? about(a) : clouds->parsed() ? make_clouds(a) : draw_truth(a);
        std::printf("%s\n", row.dump().c_str());
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_scenes: %s\n", error.what());
        return 1;
    }
}
