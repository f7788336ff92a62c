#include "pcm/generate/scene.h"

#include "pcm/generate/determinism.h"
#include "pcm/generate/ray_cast.h"
#include "pcm/generate/site.h"
#include "pcm/generate/surface.h"
#include "pcm/io/writer.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_file.h"
#include "pcm/system/output_group.h"
#include "pcm/threads/ordered.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>
#include <vector>

namespace pcm {
namespace {

using namespace scene;

constexpr double points_per_square_metre = 2500;
constexpr double nearest_range = 0.6, farthest_range = 150;                       // metres
constexpr double lowest_elevation = -50.0 / 360, highest_elevation = 50.0 / 360;  // turns
constexpr std::uint64_t block_points = 8192;
constexpr const char* stage = "Scanning the scene";

struct ScannedPoint {
    std::int32_t x = 0, y = 0, z = 0;  // on the grid
    std::uint16_t intensity = 0;
    std::uint8_t classification = 0;
    std::uint16_t source_id = 0;
    std::uint16_t red = 0, green = 0, blue = 0;
};

// Generates any point of the scan from its number alone.
class Scanner {
public:
    Scanner(const Site& site, const Grid& grid, const SceneOptions& options)
        : site_(site), caster_(site), grid_(grid), options_(options), corner_(options.origin - grid.offset)
    {
    }

    ScannedPoint point(std::uint64_t number) const;

private:
    const Site& site_;
    RayCaster caster_;
    Grid grid_;
    const SceneOptions& options_;
    Vec3d corner_;  // corner of the site, relative to the grid's offset
};

ScannedPoint Scanner::point(std::uint64_t number) const
{
    // Station after station, as in files of real scans; all stations have the same share.
    const std::uint64_t stations = site_.stations.size();
    const std::uint64_t whole = options_.points / stations, longer = options_.points % stations;
    const std::uint64_t station =
        number < longer * (whole + 1) ? number / (whole + 1) : longer + (number - longer * (whole + 1)) / whole;
    Random random(hash(options_.seed, number));
    Ray ray;
    ray.origin = site_.stations[station];
    Hit hit;
    do {  // rays into the sky are drawn again; rays downwards always hit
        double sin_azimuth, cos_azimuth, sin_elevation, cos_elevation;
        sine_cosine(random.unit(), sin_azimuth, cos_azimuth);
        sine_cosine(random.between(lowest_elevation, highest_elevation), sin_elevation, cos_elevation);
        ray.direction = {cos_elevation * cos_azimuth, cos_elevation * sin_azimuth, sin_elevation};
        ray.key = random.bits();
    } while (!caster_.cast(ray, nearest_range, farthest_range, hit));

    const Vec3d exact = ray.origin + hit.distance * ray.direction;
    const Shape* shape = hit.shape < 0 ? nullptr : &site_.shapes[static_cast<std::size_t>(hit.shape)];
    const Look look = look_at(site_, shape, exact, hit.normal, random);
    const Vec3d measured = corner_ + exact + (options_.noise * random.normal()) * ray.direction;

    ScannedPoint point;
    std::int32_t* const to[] = {&point.x, &point.y, &point.z};
    for (std::size_t a = 0; a < 3; ++a)
        *to[a] = static_cast<std::int32_t>(std::floor(measured[a] / grid_.scale[a] + 0.5));
    const double incidence = std::max(0.1, -dot(hit.normal, ray.direction));
    const double fading = 400 / (400 + hit.distance * hit.distance);  // half at 20 m
    const double intensity = 60000 * look.reflectivity * incidence * fading * random.between(0.92, 1.0);
    point.intensity = static_cast<std::uint16_t>(std::clamp(intensity, 1.0, 65535.0));
    point.classification = look.classification;
    point.source_id = shape ? shape->id : std::uint16_t{0};
    const auto channel = [](double value) { return static_cast<std::uint16_t>(static_cast<int>(value) * 256); };
    point.red = channel(look.colour[0]);
    point.green = channel(look.colour[1]);
    point.blue = channel(look.colour[2]);
    return point;
}

// Makes batches with the fields of LAS point format 2 from blocks of points.
class BatchMaker {
public:
    explicit BatchMaker(const Grid& grid)
    {
        info_.position_type = ScalarType::i32;
        info_.grid = grid;
        intensity_ = add("intensity", ScalarType::u16);
        for (const char* constant :
             {"return_number", "number_of_returns", "scan_direction_flag", "edge_of_flight_line"})
            add(constant, ScalarType::u8);
        classification_ = add("classification", ScalarType::u8);
        for (const char* constant : {"synthetic", "key_point", "withheld"}) add(constant, ScalarType::u8);
        add("scan_angle_rank", ScalarType::i8);
        add("user_data", ScalarType::u8);
        source_id_ = add("point_source_id", ScalarType::u16);
        colour_ = add("rgb", ScalarType::u16, 3);
        batch_.reset(info_.schema, true, block_points);
        for (const char* one : {"return_number", "number_of_returns"}) {
            Column& column = batch_.attributes[*info_.schema.find(one)];
            std::fill_n(column.as<std::uint8_t>(), column.size(), std::uint8_t{1});
        }
    }

    const FileInfo& info() const { return info_; }
    const PointBatch& batch_of(const std::vector<ScannedPoint>& block)
    {
        batch_.resize(block.size());  // the last one is shorter
        auto* const intensity = batch_.attributes[intensity_].as<std::uint16_t>();
        auto* const classification = batch_.attributes[classification_].as<std::uint8_t>();
        auto* const source_id = batch_.attributes[source_id_].as<std::uint16_t>();
        auto* const colour = batch_.attributes[colour_].as<std::uint16_t>();
        for (std::size_t i = 0; i < block.size(); ++i) {
            const ScannedPoint& point = block[i];
            batch_.grid_xyz[0][i] = point.x;
            batch_.grid_xyz[1][i] = point.y;
            batch_.grid_xyz[2][i] = point.z;
            intensity[i] = point.intensity;
            classification[i] = point.classification;
            source_id[i] = point.source_id;
            colour[3 * i] = point.red;
            colour[3 * i + 1] = point.green;
            colour[3 * i + 2] = point.blue;
        }
        return batch_;
    }

private:
    std::size_t add(const char* name, ScalarType type, std::uint32_t components = 1)
    {
        info_.schema.add({name, type, components, 1, 0, {}});
        return info_.schema.size() - 1;
    }

    FileInfo info_;
    PointBatch batch_;
    std::size_t intensity_ = 0, classification_ = 0, source_id_ = 0, colour_ = 0;
};

// 17 significant digits restore every double; printf would follow the locale.
std::string digits(double value)
{
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 17).ptr;
    return std::string(text, end);
}

std::string triple(const Vec3d& v) { return "[" + digits(v[0]) + ", " + digits(v[1]) + ", " + digits(v[2]) + "]"; }

std::string truth_json(const SceneOptions& options, double side, const std::vector<ScenePrimitive>& primitives)
{
    static constexpr const char* kinds[] = {"plane", "cylinder", "sphere"};
    std::string text = "{\n\"points\": " + std::to_string(options.points) + ",\n\"origin\": " + triple(options.origin) +
                       ",\n\"extent\": " + digits(side) + ",\n\"noise\": " + digits(options.noise) +
                       ",\n\"primitives\": [";
    for (const ScenePrimitive& p : primitives) {
        text += p.id == 1 ? "\n" : ",\n";
        text += "{\"kind\": \"" + std::string(kinds[static_cast<int>(p.kind)]) + "\", \"id\": " + std::to_string(p.id) +
                ", \"point\": " + triple(p.point) + ", \"direction\": " + triple(p.direction) +
                ", \"radius\": " + digits(p.radius) + ", \"points\": " + std::to_string(p.points) + "}";
    }
    return text + "\n]\n}\n";
}

double side_of(const SceneOptions& options)
{
    if (options.extent != 0) return options.extent;
    const double side = std::sqrt(static_cast<double>(options.points) / points_per_square_metre);
    return std::clamp(side, 60.0, 4000.0);
}

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, {}, "scene: " + what); }

Grid checked_grid(const SceneOptions& options, double side)
{
    if (!(side >= 20 && side <= 20000)) refuse("the extent is " + digits(side) + " m; 20 to 20000 can be generated");
    if (!(options.noise >= 0 && options.noise <= 1))
        refuse("the noise is " + digits(options.noise) + " m; 0 to 1 can be generated");
    if (!(options.scale > 0 && options.scale <= 1))
        refuse("the scale is " + digits(options.scale) + " m; more than 0 and at most 1 was expected");
    constexpr double headroom = 100;  // metres: ground relief, the tallest stack, range noise
    if (!((side + headroom) / options.scale < std::numeric_limits<std::int32_t>::max()))
        refuse("an extent of " + digits(side) + " m does not fit 32-bit integers of " + digits(options.scale) + " m");
    Grid grid;
    for (std::size_t a = 0; a < 3; ++a) {
        if (!(std::abs(options.origin[a]) <= 1e12))
            refuse("the origin " + digits(options.origin[a]) +
                   " is out of range: coordinates up to 1e12 can be generated");
        grid.scale[a] = options.scale;
        grid.offset[a] = std::floor(options.origin[a]);
    }
    return grid;
}

}  // namespace

SceneReport generate_scene(const std::filesystem::path& file, const SceneOptions& options, bool write_truth)
{
    Watch watch(options.progress);
    const double side = side_of(options);
    const Grid grid = checked_grid(options, side);
    const std::filesystem::path truth = std::filesystem::path(file).replace_extension(".truth.json");
    check_output(file, options.overwrite);
    if (write_truth) check_output(truth, options.overwrite);
    BatchMaker batches(grid);
    WriteOptions writing;
    writing.threads = options.threads;
    FileInfo info = batches.info();
    info.points = options.points;
    const auto writer = create_writer(file, info, writing);  // first, so that an unwritable folder is reported at once
    watch.report(stage, 0, true);
    Site site = make_site(side, options.seed);
    const Scanner scanner(site, grid, options);
    std::vector<std::uint64_t> counts(site.primitives.size() + 1);
    const auto cast = [&](std::size_t index) {
        const std::uint64_t first = index * block_points;
        std::vector<ScannedPoint> block(static_cast<std::size_t>(std::min(block_points, options.points - first)));
        for (std::size_t i = 0; i < block.size(); ++i) block[i] = scanner.point(first + i);
        return block;
    };
    const auto write = [&](std::size_t, const std::vector<ScannedPoint>& block) {
        writer->write(batches.batch_of(block));
        for (const ScannedPoint& point : block) ++counts[point.source_id];
    };
    const auto blocks = static_cast<std::size_t>((options.points + block_points - 1) / block_points);
    in_turn(blocks, thread_count(options.threads), cast, write, [&](std::size_t done) {
        watch.report(stage, 0.999 * static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(1, blocks)));
    });
    SceneReport report;
    OutputGroup group;  // the file and its truth
    writer->finish();
    report.notes = writer->notes();
    report.primitives = std::move(site.primitives);
    for (ScenePrimitive& primitive : report.primitives) {
        primitive.point = options.origin + primitive.point;
        primitive.points = counts[primitive.id];
    }
    if (write_truth) {
        OutputFile out(truth);
        out.append(truth_json(options, side, report.primitives));
        out.finish();
    }
    run_last_step(report.outcome, [&] { group.put_in_place(); });
    watch.finish(stage);
    report.outcome.points_in = report.outcome.points_out = options.points;
    report.outcome.seconds = watch.seconds();
    report.outcome.error = options.noise;
    report.outcome.error_meaning = "standard deviation of the range, metres";
    return report;
}

}  // namespace pcm
