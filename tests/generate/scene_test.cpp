#include "pcm/generate/scene.h"

#include "pcm/cloud/vector.h"
#include "pcm/generate/determinism.h"
#include "pcm/generate/site.h"
#include "pcm/io/reader.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <sstream>
#include <thread>

namespace pcm::test {
namespace {

std::string read_bytes(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

struct Point {
    Vec3d position;
    std::uint16_t id;
    std::uint16_t intensity;
    std::uint8_t classification;
    std::array<std::uint16_t, 3> rgb;
};

std::vector<Point> points_of(const std::filesystem::path& las)
{
    const auto reader = open_reader(las);
    const Schema& schema = reader->info().schema;
    const std::size_t id = *schema.find("point_source_id"), rgb = *schema.find("rgb"),
                      intensity = *schema.find("intensity"), classification = *schema.find("classification");
    std::vector<Point> points;
    PointBatch batch;
    while (reader->read(batch, default_batch_points))
        for (std::size_t i = 0; i < batch.size; ++i) {
            const auto* colour = batch.attributes[rgb].as<std::uint16_t>() + 3 * i;
            points.push_back({reader->info().grid->to_source(
                                  Vec3i{batch.grid_xyz[0][i], batch.grid_xyz[1][i], batch.grid_xyz[2][i]}),
                              batch.attributes[id].as<std::uint16_t>()[i],
                              batch.attributes[intensity].as<std::uint16_t>()[i],
                              batch.attributes[classification].as<std::uint8_t>()[i],
                              {colour[0], colour[1], colour[2]}});
        }
    return points;
}

double distance_to(const ScenePrimitive& p, const Vec3d& q)
{
    const Vec3d d = q - p.point;
    const double along = dot(d, p.direction), distance = length(d);
    switch (p.kind) {
        case ScenePrimitive::Kind::plane:
            return std::abs(along);
        case ScenePrimitive::Kind::cylinder:
            return std::abs(std::sqrt(std::max(0.0, distance * distance - along * along)) - p.radius);
        case ScenePrimitive::Kind::sphere:
            return std::abs(distance - p.radius);
    }
    return 0;
}

SceneOptions small_scene(std::uint64_t points, double extent = 90)
{
    SceneOptions options;
    options.points = points;
    options.extent = extent;
    options.overwrite = true;
    return options;
}

TEST(Scene, HasExactlyTheRequestedNumberOfPoints)
{
    TemporaryFolder folder;
    for (const std::uint64_t count : {0, 1, 2, 8191, 8192, 8193, 100000}) {
        const SceneReport report = generate_scene(folder / "a.las", small_scene(count));
        EXPECT_EQ(open_reader(folder / "a.las")->info().points, count);
        EXPECT_EQ(report.outcome.points_out, count);
        EXPECT_EQ(points_of(folder / "a.las").size(), count);
    }
}

TEST(Scene, ExistingFilesAreReplacedOnlyOnRequest)
{
    TemporaryFolder folder;
    SceneOptions options = small_scene(100);
    options.overwrite = false;
    for (const char* name : {"a.las", "a.truth.json"}) {
        std::filesystem::remove(folder / "a.las");
        std::filesystem::remove(folder / "a.truth.json");
        std::ofstream(folder / name) << "mine";
        try {
            generate_scene(folder / "a.las", options);
            ADD_FAILURE() << name << " was replaced";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::exists);
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
        EXPECT_EQ(read_bytes(folder / name), "mine");
    }
    generate_scene(folder / "a.las", options, false);  // the truth is not to be written
    EXPECT_EQ(read_bytes(folder / "a.truth.json"), "mine");
    options.overwrite = true;
    generate_scene(folder / "a.las", options);
    EXPECT_NE(read_bytes(folder / "a.truth.json"), "mine");
}

TEST(Scene, TheExtensionChoosesTheFormat)
{
    TemporaryFolder folder;
    generate_scene(folder / "a.las", small_scene(3000));
    const auto expected = points_of(folder / "a.las");
    for (const char* name : {"a.ply", "a.bpc", "a.laz"}) {
        try {
            generate_scene(folder / name, small_scene(3000));
        } catch (const Error& error) {  // a build without LAZ
            EXPECT_NE(std::string(error.what()).find("without"), std::string::npos) << error.what();
            continue;
        }
        const auto reader = open_reader(folder / name);
        EXPECT_EQ(reader->info().points, 3000u) << name;
        EXPECT_EQ(read_bytes(folder / name).substr(0, 3), name == std::string("a.ply")   ? "ply"
                                                          : name == std::string("a.bpc") ? "BPC"
                                                                                         : "LAS");
        PointBatch batch;
        reader->read(batch, 3000);
        const auto* id = batch.attributes[*reader->info().schema.find("point_source_id")].as<std::uint16_t>();
        for (std::size_t i = 0; i < 3000; ++i) ASSERT_EQ(id[i], expected[i].id) << name;
    }
    for (const char* name : {"a", "a.pct", "a.stl", "a.copc.laz"}) {
        EXPECT_THROW(generate_scene(folder / name, small_scene(100)), Error) << name;
        EXPECT_FALSE(std::filesystem::exists(folder / name));
    }
}

TEST(Scene, TheSameBytesForAnyNumberOfThreads)
{
    TemporaryFolder folder;
    SceneOptions options = small_scene(200000);
    options.threads = 1;
    generate_scene(folder / "a.las", options);
    const std::string las = read_bytes(folder / "a.las"), truth = read_bytes(folder / "a.truth.json");
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
        options.threads = threads;
        generate_scene(folder / "b.las", options);
        EXPECT_TRUE(read_bytes(folder / "b.las") == las) << threads;
        EXPECT_TRUE(read_bytes(folder / "b.truth.json") == truth) << threads;
    }
    options.seed = 2;
    generate_scene(folder / "b.las", options);
    EXPECT_FALSE(read_bytes(folder / "b.las") == las) << "another seed is another scene";
}

// Frozen (FNV-1a of the file): g++ and clang++, with and without optimisation and AVX-512, agree on it.
TEST(Scene, TheSameBytesOnEveryMachine)
{
    TemporaryFolder folder;
    const auto fingerprint_of = [&](std::uint64_t points, double side) {
        const auto file = folder / (std::to_string(points) + ".las");
        generate_scene(file, small_scene(points, side));
        std::uint64_t fingerprint = 0xCBF29CE484222325u;
        for (const char c : read_bytes(file))
            fingerprint = (fingerprint ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
        return fingerprint;
    };
    EXPECT_EQ(fingerprint_of(50000, 200), 8007447486992788620u);  // all kinds of blocks
    EXPECT_EQ(fingerprint_of(20000, 70), 16399488292077050425u);  // four blocks: a sphere between pipes
    EXPECT_EQ(fingerprint_of(10000, 20), 7490691283203148535u);   // one block
}

TEST(Scene, PointsLieOnTheirPrimitives)
{
    TemporaryFolder folder;
    for (const double noise : {0.0, 0.003, 0.02}) {
        SceneOptions options = small_scene(400000, 120);
        options.noise = noise;
        const SceneReport report = generate_scene(folder / "a.las", options);
        std::vector<std::uint64_t> counts(report.primitives.size() + 1);
        std::vector<double> squares(counts.size());
        // Range noise is along the ray, so a point is at most that far from its surface; the grid rounds each
        // coordinate by half a step. The last term is the rounding of map coordinates in double.
        const double limit = 6 * noise + 0.5 * std::sqrt(3.0) * options.scale + 1e-8;
        for (const Point& point : points_of(folder / "a.las")) {
            ASSERT_LE(point.id, report.primitives.size());
            ++counts[point.id];
            if (point.id == 0) continue;
            const double distance = distance_to(report.primitives[point.id - 1u], point.position);
            ASSERT_LE(distance, limit) << "primitive " << point.id;
            squares[point.id] += distance * distance;
        }
        std::map<ScenePrimitive::Kind, int> seen;
        for (std::size_t i = 0; i < report.primitives.size(); ++i) {
            const ScenePrimitive& p = report.primitives[i];
            EXPECT_EQ(p.id, i + 1);
            EXPECT_EQ(p.points, counts[i + 1]);
            if (p.points > 500) ++seen[p.kind];
            EXPECT_NEAR(length(p.direction), p.kind == ScenePrimitive::Kind::sphere ? 0 : 1, 1e-12);
            EXPECT_EQ(p.radius > 0, p.kind != ScenePrimitive::Kind::plane);
            // The noise is present: grazing incidence can reduce it, but not to nothing.
            if (noise > 0.01 && p.points > 2000) {
                EXPECT_GT(std::sqrt(squares[i + 1] / static_cast<double>(p.points)), 0.1 * noise);
            }
        }
        EXPECT_GE(seen[ScenePrimitive::Kind::plane], 20);
        EXPECT_GE(seen[ScenePrimitive::Kind::cylinder], 20);
        EXPECT_GE(seen[ScenePrimitive::Kind::sphere], 2);
    }
}

TEST(Scene, TheTruthFileAgreesWithTheReport)
{
    TemporaryFolder folder;
    SceneOptions options = small_scene(30000);
    options.origin = {123.456, -7.25, 0.1};
    const SceneReport report = generate_scene(folder / "site.las", options);
    const std::string json = read_bytes(folder / "site.truth.json");
    const auto header = [&](const std::string& key) {
        const std::string label = "\"" + key + "\": ";
        const std::size_t start = json.find(label);
        if (start == std::string::npos) return std::string("missing");
        return json.substr(start + label.size(), json.find(",\n", start) - start - label.size());
    };
    EXPECT_EQ(header("points"), "30000");
    EXPECT_EQ(std::stod(header("extent")), 90);
    EXPECT_EQ(std::stod(header("noise")), options.noise);
    double x = 0, y = 0, z = 0;
    ASSERT_EQ(std::sscanf(header("origin").c_str(), "[%lf, %lf, %lf]", &x, &y, &z), 3);
    EXPECT_EQ((Vec3d{x, y, z}), options.origin);

    std::istringstream lines(json.substr(json.find("\"primitives\"")));
    std::string line;
    std::getline(lines, line);
    std::uint64_t total = 0;
    for (const ScenePrimitive& p : report.primitives) {
        ASSERT_TRUE(std::getline(lines, line));
        char kind[16];
        int id = 0;
        Vec3d at{}, direction{};
        double radius = 0;
        unsigned long long points = 0;
        ASSERT_EQ(std::sscanf(line.c_str(),
                              "{\"kind\": \"%15[a-z]\", \"id\": %d, \"point\": [%lf, %lf, %lf], \"direction\": [%lf, "
                              "%lf, %lf], \"radius\": %lf, \"points\": %llu}",
                              kind, &id, &at[0], &at[1], &at[2], &direction[0], &direction[1], &direction[2], &radius,
                              &points),
                  10)
            << line;
        static const std::string kinds[] = {"plane", "cylinder", "sphere"};
        EXPECT_EQ(kind, kinds[static_cast<int>(p.kind)]);
        EXPECT_EQ(id, p.id);
        EXPECT_EQ(at, p.point) << "bit for bit";
        EXPECT_EQ(direction, p.direction);
        EXPECT_EQ(radius, p.radius);
        EXPECT_EQ(points, p.points);
        total += points;
    }
    EXPECT_LT(total, 30000u) << "the ground has points too";
    generate_scene(folder / "plain.las", options, false);
    EXPECT_FALSE(std::filesystem::exists(folder / "plain.truth.json"));
}

TEST(Scene, TheOriginIsKept)
{
    TemporaryFolder folder;
    SceneOptions options = small_scene(50000, 60);
    generate_scene(folder / "near.las", options, false);
    for (const Vec3d& origin : {Vec3d{5e6, 5e6, 5e6}, Vec3d{-5e6 + 0.625, 5e6 - 0.25, -100.75}, Vec3d{0, 0, 0}}) {
        options.origin = origin;
        generate_scene(folder / "far.las", options, false);
        const auto reader = open_reader(folder / "far.las");
        EXPECT_EQ(reader->info().grid->offset,
                  (Vec3d{std::floor(origin[0]), std::floor(origin[1]), std::floor(origin[2])}));
        EXPECT_EQ(reader->info().grid->scale, (Vec3d{options.scale, options.scale, options.scale}));
        const auto near = points_of(folder / "near.las"), far = points_of(folder / "far.las");
        for (std::size_t i = 0; i < near.size(); ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                const double local = near[i].position[a] - SceneOptions{}.origin[a];
                ASSERT_NEAR(far[i].position[a] - origin[a], local, options.scale + 1e-8) << "the same scene elsewhere";
            }
    }
}

TEST(Scene, StaysInItsSquare)
{
    TemporaryFolder folder;
    const SceneOptions options = small_scene(200000, 75);
    generate_scene(folder / "a.las", options, false);
    Box3d box;
    for (const Point& p : points_of(folder / "a.las")) box.extend(p.position);
    const double margin = 6 * options.noise + options.scale;
    for (std::size_t a = 0; a < 2; ++a) {
        EXPECT_GE(box.min[a], options.origin[a] - margin);
        EXPECT_LE(box.max[a], options.origin[a] + 75 + margin);
        EXPECT_LT(box.min[a], options.origin[a] + 1) << "and fills it";
        EXPECT_GT(box.max[a], options.origin[a] + 74);
    }
    EXPECT_GT(box.extent(2), 8);
    EXPECT_LT(box.extent(2), 60);
    EXPECT_EQ(*open_reader(folder / "a.las")->info().promised_box, box);
}

// Around a station on the open street the density of ground points decreases at least with the square of the distance
// (rays also hit at a lower angle).
TEST(Scene, DensityDecreasesWithTheDistance)
{
    TemporaryFolder folder;
    const SceneOptions options = small_scene(1500000, 60);
    generate_scene(folder / "a.las", options, false);
    const auto site = scene::make_site(60, options.seed);
    // All stations have the same number of points, one station after the other.
    const auto points = points_of(folder / "a.las");
    const std::size_t share = points.size() / site.stations.size();
    const std::size_t middle = [&] {
        std::size_t best = 0;
        const auto off = [&](std::size_t i) { return std::hypot(site.stations[i][0] - 30, site.stations[i][1] - 30); };
        for (std::size_t i = 1; i < site.stations.size(); ++i)
            if (off(i) < off(best)) best = i;
        return best;
    }();
    const Vec3d station = site.stations[middle];
    std::array<double, 3> count{};  // in rings 2..4, 4..8, 8..16 m
    const std::size_t slack = site.stations.size();
    for (std::size_t i = middle * share + slack; i < (middle + 1) * share - slack; ++i) {
        const double r = std::hypot(points[i].position[0] - options.origin[0] - station[0],
                                    points[i].position[1] - options.origin[1] - station[1]);
        if (points[i].classification != 2) continue;
        for (std::size_t ring = 0; ring < 3; ++ring)
            if (r >= 2 * (1 << ring) && r < 4 * (1 << ring)) ++count[ring];
    }
    // Twice the radius is four times the area: a density that decreases with the square has equal counts per ring.
    EXPECT_GT(count[0], count[1]);
    EXPECT_GT(count[1], count[2]);
    EXPECT_GT(count[2], 100);
}

TEST(Scene, LooksLikeASite)
{
    TemporaryFolder folder;
    SceneOptions options = small_scene(600000, 150);
    generate_scene(folder / "a.las", options, false);
    std::map<int, std::size_t> classes;
    std::map<int, std::array<double, 3>> colours;
    double near_intensity = 0, far_intensity = 0;
    for (const Point& p : points_of(folder / "a.las")) {
        ++classes[p.classification];
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(p.rgb[c] % 256, 0);
            colours[p.classification][c] += p.rgb[c] / 256.0;
        }
        near_intensity = std::max(near_intensity, static_cast<double>(p.intensity));
        far_intensity += p.intensity;
    }
    for (const int known : {2, 5, 6, 19}) EXPECT_GT(classes[known], 600000u / 200) << "class " << known;
    const auto mean = [&](int known, std::size_t c) { return colours[known][c] / static_cast<double>(classes[known]); };
    EXPECT_GT(mean(5, 1), mean(5, 0) * 1.1) << "trees are green";
    EXPECT_GT(mean(5, 1), mean(5, 2) * 1.3);
    EXPECT_GT(mean(6, 0), mean(6, 2)) << "buildings are not blue";
    EXPECT_GT(near_intensity, 4 * far_intensity / 600000) << "intensity depends on distance and incidence";
}

// The hall is closed: a ray that ends inside would have passed through a wall.
TEST(Scene, NothingIsSeenThroughWalls)
{
    TemporaryFolder folder;
    const SceneOptions options = small_scene(600000, 60);
    generate_scene(folder / "a.las", options, false);
    const auto site = scene::make_site(60, options.seed);
    const scene::Shape* roof = nullptr;
    for (const scene::Shape& shape : site.shapes)
        if (shape.material == scene::Material::flat_roof) roof = &shape;
    ASSERT_TRUE(roof);
    using namespace scene;
    std::size_t on_the_walls = 0;
    const double skin = 6 * options.noise + 2 * options.scale;
    for (const Point& p : points_of(folder / "a.las")) {
        const Vec3d d = p.position - options.origin - roof->centre;
        const double inside =
            std::min({roof->half_u - std::abs(dot(d, roof->u)), roof->half_v - std::abs(dot(d, roof->v)), -d[2]});
        ASSERT_LE(inside, skin);
        on_the_walls += inside > -skin;
    }
    EXPECT_GT(on_the_walls, 10000u);
}

TEST(Scene, LargeSitesKeepTheirIds)
{
    for (const double side : {20.0, 60.0, 1000.0, 4000.0, 20000.0}) {
        const auto site = scene::make_site(side, 3);
        EXPECT_LE(site.primitives.size(), 60000u);
        EXPECT_GE(site.stations.size(), 4u);
        for (std::size_t i = 0; i < site.primitives.size(); ++i) ASSERT_EQ(site.primitives[i].id, i + 1);
        for (const scene::Shape& shape : site.shapes) {
            ASSERT_LE(shape.id, site.primitives.size());
            const Box3d box = shape.box();
            for (std::size_t a = 0; a < 2; ++a) {
                ASSERT_GE(box.min[a], 0);
                ASSERT_LE(box.max[a], side);
            }
        }
    }
}

TEST(Scene, ProgressIsReportedAndCancelLeavesNothing)
{
    TemporaryFolder folder;
    SceneOptions options = small_scene(3000000);
    const auto thread = std::this_thread::get_id();
    double last = 0;
    int calls = 0;
    options.progress = [&](const ProgressUpdate& update) {
        EXPECT_EQ(std::this_thread::get_id(), thread);
        EXPECT_GE(update.fraction, last);
        EXPECT_LE(update.fraction, 1);
        EXPECT_FALSE(update.stage.empty());
        last = update.fraction;
        return ++calls < 4;
    };
    try {
        generate_scene(folder / "a.las", options);
        FAIL() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
    EXPECT_EQ(calls, 4);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));

    options.points = 20000;
    options.progress = [&](const ProgressUpdate& update) { return last = update.fraction, true; };
    generate_scene(folder / "a.las", options);
    EXPECT_EQ(last, 1);
}

TEST(Scene, RefusesOptionsOutOfRange)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::function<void(SceneOptions&)>> mistakes = {
        [](SceneOptions& o) { o.extent = 5; },    [](SceneOptions& o) { o.extent = -1; },
        [=](SceneOptions& o) { o.extent = nan; }, [](SceneOptions& o) { o.noise = -0.1; },
        [=](SceneOptions& o) { o.noise = nan; },  [](SceneOptions& o) { o.scale = 0; },
        [=](SceneOptions& o) { o.scale = nan; },  [=](SceneOptions& o) { o.origin[1] = nan; },
        [](SceneOptions& o) { o.scale = 1e-8; },
    };
    TemporaryFolder folder;
    for (std::size_t i = 0; i < mistakes.size(); ++i) {
        SceneOptions options = small_scene(1000);
        mistakes[i](options);
        try {
            generate_scene(folder / "a.las", options);
            ADD_FAILURE() << "mistake " << i << " went through";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << error.what();
        }
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    EXPECT_THROW(generate_scene(folder / "nowhere" / "a.las", small_scene(1000)), Error);
}

// The elementary functions against those of the C library, which are accurate to about one ulp.
TEST(SceneDeterminism, ElementaryFunctions)
{
    scene::Random random(1);
    double sum = 0, squares = 0;
    for (int i = 0; i < 200000; ++i) {
        const double turns = random.between(-3, 3);
        double sine, cosine;
        scene::sine_cosine(turns, sine, cosine);
        ASSERT_NEAR(sine, std::sin(turns * 2 * pi), 1e-14);
        ASSERT_NEAR(cosine, std::cos(turns * 2 * pi), 1e-14);
        const double x = std::ldexp(1 + random.unit(), random.below(200) - 100);
        ASSERT_NEAR(scene::logarithm(x), std::log(x), 1e-13);
        const double normal = random.normal();
        ASSERT_LE(std::abs(normal), 6);
        sum += normal;
        squares += normal * normal;
    }
    // Four standard errors of mean and variance.
    EXPECT_NEAR(sum / 200000, 0, 4 / std::sqrt(200000.0));
    EXPECT_NEAR(squares / 200000, 1, 4 * std::sqrt(2.0 / 200000));
}

}  // namespace
}  // namespace pcm::test
